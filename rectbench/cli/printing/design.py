"""What a run's design tells, and what would tell more, as tables with their words."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import pandas as pd
from rich.text import Text

from rectbench.cli.printing.screen import console, plain_table
from rectbench.runs.designing import NESTED
from rectbench.statistics.intervals import counted
from rectbench.statistics.paired import TIE
from rectbench.statistics.power import variance_factors

if TYPE_CHECKING:
    from rectbench.runs.designing import Design

SMALL_SHARE = 0.05
"""A level that makes less of the variance between rigs is not worth more of it."""
RIGS_ONLY = "rigs only"
_LEAST, _MOST = 0.5, 2.0
"""Ratios between them are told in percent."""
_ONE_DECIMAL, _WHOLE_PERCENT = 0.05, 0.01
"""The least change (percent) and share that are shown with as many digits as others."""


def show_design(found: Design) -> None:
    """A table a part of the report and pose, and below it what more rigs, scenes and seeds would do."""
    screen = console()
    for (part, pose), rows in found.table.groupby(["part", "pose"], sort=False):
        name = f"{part}: " if part else ""
        screen.print(Text(f"{name}{found.column.full_heading}, {pose} pose", style="bold"), soft_wrap=True)
        planned = rows[rows["reason"] == ""]
        levels = [level for level in NESTED if (planned[f"{level}s"] > 1).any()]
        headings = [f"or {level}s" for level in levels]
        table = plain_table(
            *(
                "A",
                "B",
                "rigs",
                "A / B",
                "95 % interval",
                "told from",
                f"rigs for {_wanted(found.detect)}",
                *headings,
            )
        )
        for row in rows.to_dict("records"):
            table.add_row(row["a"], row["b"], str(row["rigs"]), *_entries(row, levels))
        screen.print(table)
        if not planned.empty:
            for line in _remarks(planned, len(rows), found.detect, levels):
                screen.print(Text(line), soft_wrap=True)
        screen.print()


def _wanted(detect: float) -> str:
    return f"{100 * detect:.3g} %"


def percents(*ratios: float) -> tuple[str, ...]:
    """How far ratios are from 1; the ratios themselves where one of them is far.

    >>> percents(0.9, 1.021), percents(0.9996), percents(1.0 - 1e-9)
    (('-10.0 %', '+2.1 %'), ('-0.04 %',), ('0.0 %',))
    >>> percents(0.9, 123.4)
    ('× 0.9', '× 123')
    """
    if not all(_LEAST <= ratio <= _MOST for ratio in ratios):
        return tuple(f"× {ratio:.3g}" for ratio in ratios)
    return tuple(map(_percent, ratios))


def _percent(ratio: float) -> str:
    change = 100 * (ratio - 1)
    if abs(change) <= 100 * TIE:
        return "0.0 %"
    return f"{change:+.1f} %" if abs(change) >= _ONE_DECIMAL else f"{change:+.1g} %"


def _entries(row: Mapping[Hashable, Any], levels: list[str]) -> Iterator[str]:
    """The numbers of a pair of methods, or why there are none."""
    if row["reason"]:
        yield row["reason"]
        return
    ratio, low, high = percents(row["ratio"], row["low"], row["high"])
    yield ratio
    yield f"{low} to {high}"
    yield percents(row["resolves"])[0].lstrip("+")
    yield "over a million" if pd.isna(row["rigs_needed"]) else _about(row["rigs_needed"])
    for level in levels:
        needed, count = row[f"{level}s_needed"], row[f"{level}s"]
        yield _about(needed) if not pd.isna(needed) else RIGS_ONLY if count else ""


def _about(needed: float) -> str:
    """A number of things to two digits, upwards: how rigs differ is not known better.

    >>> _about(17), _about(5976)
    ('17', '6000')
    """
    unit = 10 ** max(0, len(str(int(needed))) - 2)
    return str(-(-int(needed) // unit) * unit)


def _remarks(planned: pd.DataFrame, tests: int, detect: float, levels: Sequence[str]) -> Iterator[str]:
    """What the numbers are, how sure they are, and what each level within a rig is worth."""
    wanted = _wanted(detect)
    yield (
        "Told from: with 80 % power, by paired t tests of log ratios over rigs, "
        f"at 5 % for {counted(tests, 'pair')} of methods together (Holm)."
    )
    rigs = int(planned["rigs"].min())
    low, high = variance_factors(rigs)
    yield (
        f"How rigs differ is known from {rigs} of them: in truth {low:.2g} to {high:.2g} times as many rigs "
        "may be needed."
    )
    if not planned["scenes"].any():
        yield "No scene is in these pairs: what is compared is a property of rig and motion."
    open_still = planned[planned["resolves"] > 1 + detect]
    if open_still.empty:
        yield f"This run tells {wanted} between any two of them already."
    if levels and open_still[[f"{level}s_needed" for level in levels]].isna().any(axis=None):
        more = " or ".join(f"{level}s" for level in levels)
        yield f"{RIGS_ONLY.capitalize()}: on as many rigs as these no number of {more} tells {wanted}."
    for level in NESTED:
        yield from _worth(level, open_still[open_still[f"{level}s"] > 0])


def _worth(level: str, rows: pd.DataFrame) -> Iterator[str]:
    """What more scenes or seeds would do for differences that are not told yet; of motions, likewise."""
    share = rows[f"{level}s_share"].max()
    if rows.empty:
        return
    if pd.isna(share):
        if level != "motion":  # reports state their motions, and are about these
            yield f"One {level} each: what more {level}s would do is unknown."
        return
    part = f"{100 * share:.0f} %" if share >= _WHOLE_PERCENT else "less than 1 %"
    if share < SMALL_SHARE:
        yield f"More {level}s would hardly help: they make {part} of the variance between rigs."
        return
    alone = "" if rows[f"{level}s_needed"].notna().any() else ", but only more rigs tell so little"
    yield f"{level.capitalize()}s make up to {part} of the variance between rigs: more would help{alone}."
