"""A run's main tables, and where its page is."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from rectbench.cli.printing.screen import console
from rectbench.reporting.tables.tabulation import main_tables
from rectbench.runs.run import read_run


def show_summary(folder: Path) -> None:
    """The main tables of a run, and where its page is."""
    screen, found = console(), read_run(folder)
    page_only = {column.key for column in found.catalogue.shown("page")}  # they make it too wide
    for summary in main_tables(found):
        caption = " ".join([summary.caption, *summary.notes])
        table = Table(title=summary.title, caption=caption, box=SIMPLE_HEAD, pad_edge=False)
        shown = [i for i, heading in enumerate(summary.headings) if heading.key not in page_only]
        for i in shown:
            heading = summary.headings[i]
            # On a narrow screen the headings are folded, never the numbers.
            widest = max(len(row[i].text) for row in summary.rows)
            side: Literal["left", "right"] = "right" if heading.numeric else "left"
            table.add_column(Text(heading.text), justify=side, min_width=widest)  # [px] is no markup
        for row in summary.rows:
            table.add_row(*(Text(row[i].text, style="bold" if row[i].best else "") for i in shown))
        screen.print(table)
    for failure in found.failures:
        cell = f"{failure.method} on {failure.scene}/{failure.rig}/{failure.motion}/{failure.pose}"
        screen.print(Text(f"{failure.status}: {cell}: {failure.reason}", style="yellow"))
    screen.print(f"{len(found.results)} cells; page: {folder / 'index.html'}", soft_wrap=True)
