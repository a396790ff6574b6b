"""From a report to a run's folder."""

from __future__ import annotations

import time
from contextlib import nullcontext
from pathlib import Path

import pandas as pd

from rectbench.experiments.execution.pool import Workers
from rectbench.experiments.execution.running import checked_jobs, execute, workers_for
from rectbench.experiments.planning import find_report, make_plan
from rectbench.experiments.selecting import Selection
from rectbench.experiments.spec import Report
from rectbench.progress import progress_for
from rectbench.registry import is_path
from rectbench.runs.record import RunRecord, table_of, write_run
from rectbench.writing import check_writable

RUNS = Path("runs")
"""Where run folders go unless the user says otherwise."""


def run(
    report: Report | str | Path,
    out: str | Path | None = None,
    selection: Selection | None = None,
    *,
    data: str | Path | None = None,
    jobs: int | None = None,
    dask: str | None = None,
    fresh: bool = False,
    progress: bool | None = None,
    workers: Workers | None = None,
) -> pd.DataFrame:
    """Run a report and write its run.json, results.parquet and results.csv.

    Parameters
    ----------
    report, out, data, jobs, dask, fresh, progress : as those of `rectbench.run`.
    selection : what to run of the report; all of it by default.
    workers : those to run it, in the place of `jobs` of its own.

    Returns one row a cell, in the report's order. Raises InvalidInput before anything runs where the
    report, a name, a file or an option cannot be used; Interrupted on Ctrl-C.
    """
    begin = time.monotonic()
    plan = make_plan(find_report(report), selection, data)
    checked_jobs(jobs)
    folder = run_folder(plan.report, out)
    check_writable(folder)
    with workers_for(plan.report, jobs) if workers is None else nullcontext(workers) as crew:
        execution = execute(plan, crew, dask=dask, fresh=fresh, progress=progress_for(progress))
    table = table_of(plan, execution.outcomes)
    write_run(folder, table, RunRecord.of(execution, time.monotonic() - begin, _file_of(report)))
    return table


def run_folder(report: Report | str | Path, out: str | Path | None = None) -> Path:
    """Where a run of the report goes."""
    return Path(out) if out is not None else RUNS / find_report(report).name


def _file_of(report: Report | str | Path) -> str | None:
    return None if isinstance(report, Report) or not is_path(report) else str(Path(report).resolve())
