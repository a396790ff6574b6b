"""The verbs of a report and its runs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rectbench.cli.app import INCOMPLETE, OptionTexts, RunFolder, split_names
from rectbench.cli.number_texts import whole_numbers
from rectbench.errors import UnknownName

if TYPE_CHECKING:
    import pandas as pd


def run(
    report: Annotated[
        str, typer.Argument(metavar="REPORT", help="A report's name, or the path of its file.")
    ],
    out: Annotated[Path | None, typer.Option(help="The run's folder; runs/REPORT by default.")] = None,
    methods: Annotated[
        list[str] | None,
        typer.Option(metavar="NAMES", help="Run these in the place of the report's own, +NAME beside them."),
    ] = None,
    scenes: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Likewise.")] = None,
    rigs: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Likewise.")] = None,
    seeds: Annotated[
        list[str] | None, typer.Option(metavar="NUMBERS", help="Likewise, such as 0,1,2.")
    ] = None,
    data: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Photographs, for a report that takes them.")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="Worker processes; one a core by default.")] = None,
    dask: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Run on this dask scheduler's cluster.")
    ] = None,
    fresh: Annotated[
        bool | None, typer.Option("--fresh", help="Make again what the store has of this run.")
    ] = None,
    config: Annotated[
        Path | None, typer.Option(help="TOML with [run] and [methods.NAME]; the command line wins.")
    ] = None,
    option: OptionTexts = None,
) -> None:
    """Run a report: render, rectify, measure, and write tables, figures and a page.

    Names are separated by commas, and may be paths of files. A run that was cut off goes on where it
    was; what is in the store is not done again.
    """
    from rectbench import api
    from rectbench.cli import printing as terminal
    from rectbench.cli.configuring import overlaid, read_config, read_options
    from rectbench.experiments.execution.running import Interrupted
    from rectbench.runs.making import run_folder
    from rectbench.runs.record import unreadable_images

    settings, options = read_config(config) if config else ({}, {})
    said = {
        "out": out,
        "methods": split_names(methods),
        "scenes": split_names(scenes),
        "rigs": split_names(rigs),
        "seeds": whole_numbers("seeds", seeds),
        "data": data,
        "jobs": jobs,
        "dask": dask,
        "fresh": fresh,
    }
    settings |= {name: value for name, value in said.items() if value is not None}
    options = overlaid(options, read_options(option or []))
    try:
        table = api.run(report, options=options, **settings)
    except Interrupted as interruption:
        print(f"rectbench: {interruption}", file=sys.stderr)
        raise typer.Exit(INCOMPLETE) from None
    folder = run_folder(report, settings.get("out"))
    terminal.show_summary(folder)
    if not (table["status"] == "ok").any():
        print(f"rectbench: nothing was measured; {_first_reason(table)}", file=sys.stderr)
        raise typer.Exit(INCOMPLETE)
    if unreadable := unreadable_images(folder):
        print(f"rectbench: left out, since OpenCV cannot read it: {', '.join(unreadable)}", file=sys.stderr)
        raise typer.Exit(INCOMPLETE)


def report(folder: RunFolder) -> None:
    """Write the tables, figures and page of a run again."""
    from rectbench.cli import printing as terminal
    from rectbench.progress import progress_for
    from rectbench.reporting import write_report

    write_report(folder, progress=progress_for(None))
    terminal.show_summary(folder)


def gate(
    folder: RunFolder,
    accepted: Annotated[
        Path | None, typer.Option(help="The accepted numbers; beside the report's file by default.")
    ] = None,
    accept: Annotated[
        bool, typer.Option("--accept", help="Make the run's numbers the accepted ones.")
    ] = False,
) -> None:
    """Compare a run with the numbers accepted for its report.

    Exit code 0 where it is as good, 1 where it got worse, 3 where it is incomplete or measured nothing.
    """
    from rectbench.cli import printing as terminal
    from rectbench.runs import gating

    path = accepted or gating.accepted_path(folder)
    if accept:
        print(f"{gating.accept(folder, path)} cells accepted in {path}")
        return
    found = gating.gate(folder, path)
    terminal.show_gating(found)
    raise typer.Exit(found.exit_code)


def compare(
    a: Annotated[Path, typer.Argument(metavar="A", help="A run's folder.")],
    b: Annotated[Path, typer.Argument(metavar="B", help="Another.")],
    metrics: Annotated[list[str] | None, typer.Option(metavar="NAMES", help="Only these columns.")] = None,
) -> None:
    """Compare two runs cell by cell: the median change B - A of every metric, with its 95 % interval."""
    from rectbench.cli import printing as terminal
    from rectbench.runs import comparing

    comparison = comparing.compare(a, b)
    if comparison.table.empty:
        print("rectbench: no cell was measured in both runs", file=sys.stderr)
    chosen = split_names(metrics)
    known = set(comparison.table["metric"])
    for name in chosen or []:
        if name not in known:
            raise UnknownName("metric", name, known)
    terminal.show_comparison(comparison, chosen)
    raise typer.Exit(INCOMPLETE if comparison.table.empty else 0)


def _first_reason(table: pd.DataFrame) -> Any:
    row = table.iloc[0]
    return f"the first cell says {row['status']}: {row['reason']}"
