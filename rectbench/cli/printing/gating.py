"""What a gate found."""

from __future__ import annotations

from rich.text import Text

from rectbench.cli.printing.screen import console
from rectbench.runs.gating import Gating


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
