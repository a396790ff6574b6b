"""A report run, and its tables, figures and page written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rectbench.applications.requests.running import RunRequest
from rectbench.experiments.execution.running import workers_for
from rectbench.experiments.planning import find_report
from rectbench.progress import progress_for
from rectbench.reporting.report import write_report
from rectbench.runs import making

if TYPE_CHECKING:
    import pandas as pd


def run_report(request: RunRequest, progress: bool | None = None) -> pd.DataFrame:
    """The rows of the run, see `runs.making.run`."""
    choices = {name: getattr(request, name) for name in RunRequest.model_fields if name != "config"}
    with workers_for(find_report(request.report), request.jobs) as workers:  # for cells, then for figures
        table = making.run(**choices, progress=progress, workers=workers)
        folder = making.run_folder(request.report, request.out)
        write_report(folder, progress=progress_for(progress), workers=workers)
    return table
