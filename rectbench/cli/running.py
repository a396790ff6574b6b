"""The verbs of a report and its runs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from rectbench.applications.requests.running import PlanRequest, RunRequest
from rectbench.cli.app import GOOD, INCOMPLETE, parts, verb
from rectbench.errors import UnknownName

RunFolder = Annotated[Path, Argument(metavar="RUN", help="A run's folder.")]


@verb(RunRequest)
def run(request: RunRequest) -> int:
    """Run a report: render, rectify, measure, and write tables, figures and a page.

    Names are separated by commas, and may be paths of files. A run that was cut off goes on where it
    was; what is in the store is not done again.
    """
    from rectbench.applications.run_report import run_report
    from rectbench.cli.printing.running import show_summary
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
        row, is_one = table.iloc[0], len(table[["status", "reason"]].drop_duplicates()) == 1
        whose = "every cell" if is_one and len(table) > 1 else "the first cell"
        return _incomplete(f"nothing was measured; {whose} says {row['status']}: {row['reason']}")
    if unreadable := unreadable_images(folder):
        return _incomplete(f"left out, since OpenCV cannot read it: {', '.join(unreadable)}")
    return GOOD


def report(folder: RunFolder) -> int:
    """Write the tables, figures and page of a run again."""
    from rectbench.cli.printing.running import show_summary
    from rectbench.progress import progress_for
    from rectbench.reporting.report import write_report

    write_report(folder, progress=progress_for(None))
    show_summary(folder)
    return GOOD


def gate(
    folder: RunFolder,
    accepted: Annotated[
        Path | None, Option(help="The accepted numbers; beside the report's file by default.")
    ] = None,
    accept: Annotated[bool, Option("--accept", help="Make the run's numbers the accepted ones.")] = False,
) -> int:
    """Compare a run with the numbers accepted for its report.

    Exit code 0 where it is as good, 1 where it got worse, 3 where it is incomplete or measured nothing.
    """
    from rectbench.cli.printing.running import show_gating
    from rectbench.runs import gating

    path = accepted or gating.accepted_path(folder)
    if accept:
        print(f"{gating.accept(folder, path)} cells accepted in {path}")
        return GOOD
    verdict = gating.gate(folder, path)
    show_gating(verdict)
    return verdict.exit_code


def compare(
    a: Annotated[Path, Argument(metavar="A", help="A run's folder.")],
    b: Annotated[Path, Argument(metavar="B", help="Another.")],
    metrics: Annotated[
        list[str] | None, Option(metavar="NAMES", help="Only these columns; by default those that moved.")
    ] = None,
) -> int:
    """Compare two runs cell by cell: how much each metric changed, with its 95 % interval over rigs."""
    from rectbench.cli.printing.running import show_comparison
    from rectbench.runs import comparing

    comparison, wanted = comparing.compare(a, b), parts(metrics or [])
    if comparison.table.empty:
        print("rectbench: no cell was measured in both runs", file=sys.stderr)
    known = set(comparison.table["metric"])
    for name in wanted:
        if name not in known:
            raise UnknownName("metric", name, known)
    show_comparison(comparison, wanted)
    return INCOMPLETE if comparison.table.empty else GOOD


@verb(PlanRequest)
def plan(request: PlanRequest) -> int:
    """Tell how many rigs, scenes and seeds would tell methods apart, by a run that is there.

    Exit code 3 where the run has too few rigs to tell.
    """
    from rectbench.applications.plan_report import plan_report
    from rectbench.cli.printing.design import show_design

    found = plan_report(request)
    show_design(found)
    return INCOMPLETE if found.planned.empty else GOOD


def _incomplete(reason: object) -> int:
    print(f"rectbench: {reason}", file=sys.stderr)
    return INCOMPLETE
