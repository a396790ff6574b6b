"""A run's main tables, what a gate found, and what two runs differ in."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Hashable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table
from rectbench.metrics.view import across_key
from rectbench.reporting.failures import told_failures
from rectbench.reporting.footnotes import with_footnotes
from rectbench.reporting.tables.findings import findings
from rectbench.reporting.tables.main_tables import INTERVAL, main_tables
from rectbench.reporting.tables.numbers import shown, signed
from rectbench.runs.run import read_run
from rectbench.runs.units import GEOMETRIC
from rectbench.scored import SHARES
from rectbench.statistics.intervals import Interval

if TYPE_CHECKING:
    from rectbench.plugins.metric import Column
    from rectbench.reporting.tables.table import Table as Summary
    from rectbench.runs.comparing import Comparison
    from rectbench.runs.gating import Gating

_HEADING_LETTERS = 11
_BETWEEN = 3
"""Letters between columns."""


def show_summary(folder: Path) -> None:
    """What each part of a run tells, its main tables, and where the page is."""
    screen, found = console(), read_run(folder)
    page_only = {column.key for column in found.catalogue.shown("page")}  # they make it too wide
    told = findings(found)
    for summary in map(with_footnotes, main_tables(found)):
        for sentence in told.pop(summary.part, ()):
            screen.print(Text(sentence, style="italic"))
            screen.print()
        screen.print(Text(summary.title, style="bold"))
        screen.print(Text(summary.caption))
        table, left_out = _as_wide_as(screen.width, summary, page_only)
        screen.print(table)
        if left_out:
            screen.print(Text(f"{left_out} more columns in a wider terminal and on the page."))
        for note in summary.notes:
            screen.print(Text(note))
        screen.print()
    for line in told_failures(found):
        screen.print(Text(line, style="yellow"))
    screen.print(f"{len(found.results)} cells; page: {folder / 'index.html'}", soft_wrap=True)


def _as_wide_as(width: int, summary: Summary, page_only: Collection[str]) -> tuple[Table, int]:
    """The columns for a terminal, as many as it has room for: headings are folded, never the numbers.

    What ranks stands first, and so is never left out; how many columns are comes second. Intervals stand on
    the page; here they would press the numbers.
    """
    columns = [
        i
        for i, heading in enumerate(summary.headings)
        if heading.key not in page_only and not heading.key.endswith(INTERVAL)
    ]
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    used: list[int] = []
    for i in columns:
        heading = summary.headings[i]
        lines = textwrap.wrap(heading.text, _HEADING_LETTERS)
        widest = max(map(len, [*lines, *(row[i].text for row in summary.rows)]))
        if sum(used) + widest + _BETWEEN > width:
            break
        used.append(widest + _BETWEEN)
        side: Literal["left", "right"] = "right" if heading.numeric else "left"
        table.add_column(Text("\n".join(lines)), justify=side, width=widest)  # Text: [px] is no markup
    for row in summary.rows:
        table.add_row(*(Text(row[i].text, style="bold" if row[i].best else "") for i in columns[: len(used)]))
    return table, len(columns) - len(used)


def show_gating(found: Gating) -> None:
    """What a gate found, worst first."""
    screen = console()
    for title, lines, style in (
        ("regression", found.regressions, "red"),
        ("incomplete", found.incomplete, "yellow"),
        ("improvement", found.improvements, "green"),
        ("new", found.new, "dim"),
    ):
        for line in lines:
            screen.print(Text(f"{title}: {line}", style=style), soft_wrap=True)
    answer = {0: "good", 1: "worse than accepted"}.get(found.exit_code, "incomplete or nothing measured")
    screen.print(f"{found.compared} cells compared: {answer}")


SHOWN_DIFFERENCES = 40


def show_comparison(comparison: Comparison, metrics: Collection[str]) -> None:
    """The paired differences, a table a part and pose: of these metrics; without any, of what moved."""
    screen, table = console(), comparison.table
    names = table["metric"]
    chosen = names.isin(metrics) if metrics else table["moved"].gt(0) & ~names.isin(OF_RIGS)
    for (part, pose), rows in table[chosen].groupby(["part", "pose"], sort=False):
        title = f"{part}: {pose} pose" if part else f"{pose} pose"
        screen.print(Text(title, style="bold"))
        shown_table = plain_table(
            *("method", "metric", "pairs", "moved", "median A", "median B"),
            *("A to B", "95 % interval over rigs"),
        )
        for row in rows.to_dict("records"):
            shown_table.add_row(*_compared(row, comparison.columns[row["metric"]]))
        screen.print(shown_table)
        screen.print()
    if not len(table[chosen]) and not comparison.unpaired:
        screen.print("no cell differs")
    for line in comparison.unpaired[:SHOWN_DIFFERENCES]:
        screen.print(Text(line, style="yellow"), soft_wrap=True)
    if len(comparison.unpaired) > SHOWN_DIFFERENCES:
        screen.print(f"... and {len(comparison.unpaired) - SHOWN_DIFFERENCES} more cells in one run alone")


OF_RIGS = frozenset(map(across_key, SHARES))
"""Angles of view say what a rig has, and nothing about methods."""


def _compared(row: Mapping[Hashable, Any], column: Column) -> Iterator[str]:
    found = Interval(row["difference"], row["low"], row["high"], int(row["rigs"]))
    is_ratio = column.average == GEOMETRIC
    scale = 100.0 if is_ratio else column.scale
    unit = "%" if is_ratio else {"%": "points"}.get(column.unit, column.unit)
    yield from (row["method"], column.full_heading, str(row["pairs"]), str(row["moved"]))
    yield from (shown(row[name], column) for name in ("median_a", "median_b"))
    yield f"{signed(scale * found.estimate)} {unit}".strip()
    yield found.why_none("rig") or f"{signed(scale * found.low)} to {signed(scale * found.high)}"
