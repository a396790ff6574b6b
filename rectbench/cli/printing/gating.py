"""What a gate found."""

from __future__ import annotations

from rich.text import Text

from rectbench.cli.printing.screen import console
from rectbench.runs.gating import Verdict


def show_gating(verdict: Verdict) -> None:
    """What a gate found, worst first."""
    screen = console()
    for title, lines, style in (
        ("regression", verdict.regressions, "red"),
        ("incomplete", verdict.incomplete, "yellow"),
        ("improvement", verdict.improvements, "green"),
        ("new", verdict.new, "dim"),
    ):
        for line in lines:
            screen.print(Text(f"{title}: {line}", style=style), soft_wrap=True)
    answer = {0: "good", 1: "worse than accepted"}.get(verdict.exit_code, "incomplete or nothing measured")
    screen.print(f"{verdict.compared} cells compared: {answer}")
