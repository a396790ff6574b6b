"""What changed between two runs."""

from __future__ import annotations

from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table
from rectbench.runs.comparing import Comparison

SHOWN_DIFFERENCES = 40


def show_comparison(comparison: Comparison, metrics: list[str] | None) -> None:
    """The paired differences, a row a method and metric."""
    screen, table = console(), plain_table("method", "metric", "pairs", "A", "B", "B - A", "95 % interval")
    for row in comparison.table.to_dict("records"):
        if metrics is not None and row["metric"] not in metrics:
            continue
        interval = "" if row["low"] != row["low"] else f"{row['low']:.3g} to {row['high']:.3g}"
        numbers = (f"{row[name]:.5g}" for name in ("median_a", "median_b"))
        table.add_row(
            row["method"], row["metric"], str(row["pairs"]), *numbers, f"{row['difference']:+.3g}", interval
        )
    screen.print(table)
    for line in comparison.unpaired[:SHOWN_DIFFERENCES]:
        screen.print(Text(line, style="yellow"), soft_wrap=True)
    if len(comparison.unpaired) > SHOWN_DIFFERENCES:
        screen.print(f"... and {len(comparison.unpaired) - SHOWN_DIFFERENCES} more cells in one run alone")
