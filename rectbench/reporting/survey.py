"""Methods against classes of lenses, by how wide these see: what a survey of the field shows."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from rectbench.metrics.analyses.floor import NONE
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Part, Result
from rectbench.reporting.curves import FLOOR, ranked_share, shares, view_key
from rectbench.reporting.tables.standings import lacking
from rectbench.reporting.tables.summaries import averaged

NAME = "survey"
"""The figure that a part asks for, and its table with it."""
BOUNDS_DEG = (60.0, 110.0, 165.0)
"""Horizontal fields of view between which one class ends and the next begins: up to the first perspective
images serve without loss, from the last on hardly any of the view fits into one."""
ROUNDING = 1e-6
"""Less distortion is none."""
EXCESS = "excess_over_floor"
"""The column of how far a method is above the least that scan lines can have."""
MIDDLE = 50
"""The lesser share (%) of the view that is looked at."""


@dataclass(frozen=True)
class LensClass:
    """Rigs that see about as wide.

    >>> LensClass(None, 60.0, ()).title, LensClass(60.0, 110.0, ()).title, LensClass(165.0, None, ()).title
    ('up to 60°', '60–110°', 'beyond 165°')
    """

    above_deg: float | None
    up_to_deg: float | None
    rigs: tuple[str, ...]

    @property
    def title(self) -> str:
        """Its fields of view."""
        if self.above_deg is None:
            return f"up to {self.up_to_deg:.0f}°"
        if self.up_to_deg is None:
            return f"beyond {self.above_deg:.0f}°"
        return f"{self.above_deg:.0f}–{self.up_to_deg:.0f}°"

    def holds(self, view_deg: float) -> bool:
        """Whether a rig of this horizontal field of view belongs to it."""
        low, high = self.above_deg or 0.0, self.up_to_deg or float("inf")
        return low < view_deg <= high


def surveyed_columns(part: Part) -> dict[int, Column]:
    """By share (%) of the view, what a survey shows: the ranking column, and the same of the middle half.

    What crops the rim of a view is not ranked, and yet a survey tells how it does in the middle.
    """
    columns, ranked = shares(part.catalogue), ranked_share(part.catalogue)
    wanted = [share for share in (ranked, MIDDLE) if share in columns]
    return {share: part.catalogue.column(columns[share]) for share in wanted}


def excess_column(part: Part) -> Column | None:
    """That of the excess over the floor; None where it was not measured."""
    return part.catalogue.column(EXCESS) if EXCESS in part.metrics else None


@dataclass(frozen=True)
class Reached:
    """What a method comes to on a class of lenses: its number on each rig, their average, or why it has none.

    `why` tells of the pairs without a number, such as "keeps 43 %"; empty where all have one.
    """

    by_rig: tuple[tuple[str, float], ...]
    average: float | None
    why: str


@dataclass(frozen=True)
class Surveyed:
    """A method on all classes, in their order; None where it was not run.

    `label` is its name without what it says of its matches, where that stands for one row alone;
    `works_from` is what it is given to rectify by: the pose, or matches.
    """

    method: str
    label: str
    works_from: str
    reached: tuple[Reached | None, ...]

    @property
    def averages(self) -> tuple[float, ...]:
        """Those that it has."""
        return tuple(r.average for r in self.reached if r is not None and r.average is not None)

    @property
    def place(self) -> tuple[int, float, str]:
        """What methods are sorted by: the more classes are served the better, then the less distorted."""
        logs = [math.log(max(average, ROUNDING)) for average in self.averages]
        return -len(logs), math.fsum(logs) / max(1, len(logs)), self.method


def lens_classes(part: Part) -> tuple[LensClass, ...]:
    """Those that any rig of the part is of, the narrowest first."""
    column = part.catalogue.column(view_key(100))
    views = {rig: averaged(column, part.select(rig=rig)).value for rig in part.rigs}
    return tuple(
        LensClass(low, high, rigs)
        for low, high in pairwise((None, *BOUNDS_DEG, None))
        if (rigs := tuple(r for r, v in views.items() if v and LensClass(low, high, ()).holds(v)))
    )


def surveyed(part: Part, classes: Sequence[LensClass], column: Column) -> tuple[Surveyed, ...]:
    """Each method's numbers of a column, under the pose that shows distortion, in the order of places."""
    exact = part.select(pose=part.geometric_pose)
    cells = {method: part.select(exact, method=method) for method in part.methods}
    cells = {method: own for method, own in cells.items() if own}
    rows = Counter(own[0].cell.method for own in cells.values())
    found = (
        Surveyed(
            method=method,
            label=own[0].cell.method if rows[own[0].cell.method] == 1 else method,
            works_from="matches" if own[0].cell.matches else "pose",
            reached=tuple(_reached(own, lenses, column) for lenses in classes),
        )
        for method, own in cells.items()
    )
    return tuple(sorted(found, key=lambda one: one.place))


def _reached(results: Sequence[Result], lenses: LensClass, column: Column) -> Reached | None:
    own = [r for r in results if r.rig in lenses.rigs]
    if column.key == EXCESS:  # of no floor nothing is a multiple
        own = [r for r in own if r.metrics.get(FLOOR, math.inf) > NONE]
    if not own:
        return None
    found, why = averaged(column, own), lacking(own, column)
    return Reached(tuple(found.by_rig.items()), None if why else found.value, why)
