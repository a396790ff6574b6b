"""A report run, and its tables, figures and page written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rectbench.applications.requests.running import RunRequest
from rectbench.progress import progress_for
from rectbench.reporting.report import write_report
from rectbench.runs import making

if TYPE_CHECKING:
    import pandas as pd


def run_report(request: RunRequest, progress: bool | None = None) -> pd.DataFrame:
    """The rows of the run, see `runs.making.run`."""
    choices = {name: getattr(request, name) for name in RunRequest.model_fields if name != "config"}
    table = making.run(**choices, progress=progress)
    write_report(making.run_folder(request.report, request.out), progress=progress_for(progress))
    return table
