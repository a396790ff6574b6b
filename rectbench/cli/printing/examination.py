"""What the doctor found."""

from __future__ import annotations

from collections.abc import Iterable

from rich.text import Text

from rectbench.applications.doctor import Finding
from rectbench.cli.printing.screen import console, plain_table


def show_examination(findings: Iterable[Finding]) -> bool:
    """The doctor's table; returns whether nothing that is needed is missing."""
    screen, table, well = console(), plain_table("", "what", "found"), True
    for finding in findings:
        mark = {True: Text("ok", style="green"), False: Text("MISSING", style="bold red"), None: Text("-")}[
            finding.ok
        ]
        table.add_row(mark, finding.name, Text(finding.text))
        well = well and finding.ok is not False
    screen.print(table)
    screen.print("rectbench can run here" if well else "rectbench cannot run here")
    return well
