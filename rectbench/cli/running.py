"""The verbs of a report and its runs."""

from __future__ import annotations

import sys

from rectbench.applications.requests.running import CompareRequest, GateRequest, ReportRequest, RunRequest
from rectbench.cli.app import GOOD, INCOMPLETE, verb
from rectbench.errors import UnknownName


@verb(RunRequest)
def run(request: RunRequest) -> int:
    """Run a report: render, rectify, measure, and write tables, figures and a page.

    Names are separated by commas, and may be paths of files. A run that was cut off goes on where it
    was; what is in the store is not done again.
    """
    from rectbench.applications.run_report import run_report
    from rectbench.cli.printing.run_summary import show_summary
    from rectbench.experiments.execution.running import Interrupted
    from rectbench.runs.making import run_folder
    from rectbench.runs.record import unreadable_images

    try:
        table = run_report(request)
    except Interrupted as interruption:
        return _incomplete(interruption)
    folder = run_folder(request.report, request.out)
    show_summary(folder)
    if not (table["status"] == "ok").any():
        row = table.iloc[0]
        first = f"the first cell says {row['status']}: {row['reason']}"
        return _incomplete(f"nothing was measured; {first}")
    if unreadable := unreadable_images(folder):
        return _incomplete(f"left out, since OpenCV cannot read it: {', '.join(unreadable)}")
    return GOOD


@verb(ReportRequest)
def report(request: ReportRequest) -> int:
    """Write the tables, figures and page of a run again."""
    from rectbench.cli.printing.run_summary import show_summary
    from rectbench.progress import progress_for
    from rectbench.reporting.report import write_report

    write_report(request.folder, progress=progress_for(None))
    show_summary(request.folder)
    return GOOD


@verb(GateRequest)
def gate(request: GateRequest) -> int:
    """Compare a run with the numbers accepted for its report.

    Exit code 0 where it is as good, 1 where it got worse, 3 where it is incomplete or measured nothing.
    """
    from rectbench.cli.printing.gating import show_gating
    from rectbench.runs import gating

    path = request.accepted or gating.accepted_path(request.folder)
    if request.accept:
        print(f"{gating.accept(request.folder, path)} cells accepted in {path}")
        return GOOD
    verdict = gating.gate(request.folder, path)
    show_gating(verdict)
    return verdict.exit_code


@verb(CompareRequest)
def compare(request: CompareRequest) -> int:
    """Compare two runs cell by cell: the median change B - A of every metric, with its 95 % interval."""
    from rectbench.cli.printing.comparison import show_comparison
    from rectbench.runs import comparing

    comparison = comparing.compare(request.a, request.b)
    if comparison.table.empty:
        print("rectbench: no cell was measured in both runs", file=sys.stderr)
    known = set(comparison.table["metric"])
    for name in request.metrics or []:
        if name not in known:
            raise UnknownName("metric", name, known)
    show_comparison(comparison, request.metrics)
    return INCOMPLETE if comparison.table.empty else GOOD


def _incomplete(reason: object) -> int:
    print(f"rectbench: {reason}", file=sys.stderr)
    return INCOMPLETE
