"""What a run's design tells, and what would tell more, as tables with their words."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import pandas as pd
from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table
from rectbench.runs.designing import NESTED
from rectbench.statistics.intervals import counted
from rectbench.statistics.power import variance_factors

if TYPE_CHECKING:
    from rectbench.runs.designing import Design

SMALL_SHARE = 0.05
"""A level that makes less of the variance between rigs is not worth more of it."""


def show_design(found: Design) -> None:
    """A table a part of the report and pose, and below it what more rigs, scenes and seeds would do."""
    screen = console()
    for (part, pose), rows in found.table.groupby(["part", "pose"], sort=False):
        name = f"{part}: " if part else ""
        screen.print(Text(f"{name}{found.column.full_heading}, {pose} pose", style="bold"), soft_wrap=True)
        told = rows[rows["reason"] == ""]
        levels = [level for level in NESTED if (told[f"{level}s"] > 1).any()]
        headings = [f"or {level}s" for level in levels]
        table = plain_table(
            "A",
            "B",
            "rigs",
            "A / B",
            "95 % interval",
            "told from",
            f"rigs for {100 * found.detect:.3g} %",
            *headings,
        )
        for row in rows.to_dict("records"):
            table.add_row(row["a"], row["b"], str(row["rigs"]), *_entries(row, levels))
        screen.print(table)
        for line in _remarks(told, len(rows)):
            screen.print(Text(line), soft_wrap=True)
        screen.print()


def percent(ratio: float) -> str:
    """How far a ratio is from 1; the ratio itself where it is far.

    >>> percent(0.9), percent(1.021), percent(123.4)
    ('-10.0 %', '+2.1 %', '× 123')
    """
    return f"{100 * (ratio - 1):+.1f} %" if 0.5 <= ratio <= 2 else f"× {ratio:.3g}"


def _entries(row: Mapping[Hashable, Any], levels: list[str]) -> Iterator[str]:
    """The numbers of a pair of methods, or why there are none."""
    if row["reason"]:
        yield row["reason"]
        return
    yield percent(row["ratio"])
    yield f"{percent(row['low'])} to {percent(row['high'])}"
    yield percent(row["resolves"]).lstrip("+")
    yield _number(row["rigs_needed"], "over a million")
    for level in levels:
        yield _number(row[f"{level}s_needed"], "no number")


def _number(count: Any, otherwise: str) -> str:
    return otherwise if pd.isna(count) else str(count)


def _remarks(told: pd.DataFrame, tests: int) -> Iterator[str]:
    """What the numbers are, how sure they are, and what each level within a rig is worth."""
    if told.empty:
        return
    yield (
        "Told: in four benches of five, by paired t tests of log ratios over rigs, at 5 % for "
        f"{counted(tests, 'pair')} of methods together (Holm)."
    )
    rigs = int(told["rigs"].min())
    low, high = variance_factors(rigs)
    yield f"How rigs differ is known from {rigs} of them: it may take {low:.2g} to {high:.2g} times as many."
    for level in NESTED:
        if level == "scene" and not told["scenes"].any():
            yield "No scene is in these pairs: what is compared is a property of rig and motion."
            continue
        count, share = int(told[f"{level}s"].median()), told[f"{level}s_share"].max()
        part = f"{_part(share)} of the variance between rigs"
        if pd.isna(share):
            if level != "motion":  # reports state their motions, and are about these
                yield f"One {level} each: what more {level}s would do is unknown."
        elif share < SMALL_SHARE:
            yield f"More {level}s than {count} would hardly help: they make {part}."
        else:
            yield f"The {count} {level}s make up to {part}: more would help."


def _part(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "less than 1 %"
