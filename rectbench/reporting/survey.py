"""Methods against classes of lenses, by how wide these see: what a survey of the field shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Part, Result
from rectbench.reporting.curves import view_key
from rectbench.reporting.tables.standings import lacking, standing
from rectbench.reporting.tables.summaries import averaged, summarise

NAME = "survey"
"""The figure that a part asks for, and its table with it."""
BOUNDS_DEG = (60.0, 110.0, 165.0)
"""Horizontal fields of view between which one class ends and the next begins: up to the first perspective
images serve without loss, from the last on hardly any of the view fits into one."""


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
    """A method on all classes, in their order; None where it was not run."""

    method: str
    works_from: str
    """What it is given to rectify by: the pose, or matches."""
    reached: tuple[Reached | None, ...]


def lens_classes(part: Part) -> tuple[LensClass, ...]:
    """Those that any rig of the part is of, the narrowest first."""
    column = part.catalogue.column(view_key(100))
    views = {rig: averaged(column, part.select(rig=rig)).value for rig in part.rigs}
    return tuple(
        LensClass(low, high, rigs)
        for low, high in pairwise((None, *BOUNDS_DEG, None))
        if (rigs := tuple(r for r, v in views.items() if v and LensClass(low, high, ()).holds(v)))
    )


def surveyed(part: Part, column: Column, pose: str) -> tuple[Surveyed, ...]:
    """Each method's numbers of a column under a pose, those first that rank first."""
    results = part.select(pose=pose)
    mine = {m: part.select(results, method=m) for m in part.methods}
    ranking = part.catalogue.ranking
    found = standing(
        [summarise(m, own, [ranking]) for m, own in mine.items() if own], results, part.catalogue
    )
    classes = lens_classes(part)
    return tuple(
        Surveyed(
            s.method, works_from(mine[s.method]), tuple(_reached(mine[s.method], c, column) for c in classes)
        )
        for s in found.summaries
    )


def _reached(results: Sequence[Result], lenses: LensClass, column: Column) -> Reached | None:
    own = [r for r in results if r.rig in lenses.rigs]
    if not own:
        return None
    found, why = averaged(column, own), lacking(own, column)
    return Reached(tuple(found.by_rig.items()), None if why else found.value, why)


def works_from(results: Sequence[Result]) -> str:
    """What a method is given to rectify by."""
    return "matches" if any(r.cell.matches for r in results) else "pose"
