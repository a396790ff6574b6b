"""A report run, and its tables, figures and page written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rectbench.applications.requests.running import RunRequest
from rectbench.experiments.execution.running import workers_for
from rectbench.experiments.planning import find_report
from rectbench.experiments.selecting import Selection
from rectbench.progress import progress_for
from rectbench.reporting.report import write_report
from rectbench.runs import making

if TYPE_CHECKING:
    import pandas as pd


def run_report(request: RunRequest, progress: bool | None = None) -> pd.DataFrame:
    """The rows of the run, see `runs.making.run`."""
    chosen = Selection(
        request.methods,
        request.scenes,
        request.rigs,
        request.seeds,
        request.options,
        request.margin_deg,
    )
    with workers_for(find_report(request.report), request.jobs) as workers:  # for cells, then for figures
        table = making.run(
            request.report,
            request.out,
            chosen,
            data=request.data,
            dask=request.dask,
            fresh=request.fresh,
            progress=progress,
            workers=workers,
        )
        folder = making.run_folder(request.report, request.out)
        write_report(folder, progress=progress_for(progress), workers=workers)
    return table
