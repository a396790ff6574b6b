"""The results of a run as figures and tables ask for them: one a cell, and those of a part of its report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from rectbench.plugins.catalogue import Catalogue
from rectbench.plugins.cell import Cell

EXACT_POSE = "exact"
Item = TypeVar("Item")


@dataclass(frozen=True)
class Result:
    """A method on a pair, how that ended, and what was measured.

    Parameters
    ----------
    cell : which cell it is, with the names that are not here as they are stored.
    scene : the scene, or what the photographs are called.
    motion : how the right camera stands to the left.
    pose : how well the method knew the pose.
    method : its own name, with its options where its part of the run has several variants of it.
    options : what the method was told.
    status, reason : "ok", or how the cell ended and why.
    group : the part of the report it belongs to; empty in a report without parts.
    metrics : the numbers by column, in the columns' units: only what was measured, finite or infinite.
    notes : what the method has to say of its answer.
    """

    cell: Cell
    scene: str
    rig: str
    motion: str
    pose: str
    seed: int
    method: str
    options: Mapping[str, Any]
    status: str
    reason: str
    group: str
    metrics: Mapping[str, float]
    notes: Mapping[str, Any]

    @property
    def ok(self) -> bool:
        """Whether the cell holds a measurement."""
        return self.status == "ok"

    @property
    def place(self) -> tuple[str, str, str]:
        """The pair without its seed: scene, rig, motion."""
        return self.scene, self.rig, self.motion

    @property
    def pair(self) -> tuple[str, str, str, int]:
        """The images the cell is about: scene, rig, motion, seed."""
        return *self.place, self.seed


@dataclass(frozen=True, eq=False, kw_only=True)
class Part:
    """The results of a part of a report, or of all of it; names are in the run's order, each once.

    Parameters
    ----------
    results : one a cell.
    catalogue : what is known of their columns.
    has_truth : whether anybody knows the truth about the pairs, as nobody does about photographs.
    stated_seconds : times that somebody else stated, by stage: `pose`, `fit`, `warp`.
    group : the part's name; empty of a report without parts.
    """

    results: tuple[Result, ...]
    catalogue: Catalogue
    has_truth: bool
    stated_seconds: Mapping[str, float]
    group: str = ""

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """What the methods are called, see `Result.method`."""
        return distinct(r.method for r in self.results)

    @cached_property
    def scenes(self) -> tuple[str, ...]:
        """The scenes' names."""
        return distinct(r.scene for r in self.results)

    @cached_property
    def rigs(self) -> tuple[str, ...]:
        """The rigs' names."""
        return distinct(r.rig for r in self.results)

    @cached_property
    def motions(self) -> tuple[str, ...]:
        """The motions' names."""
        return distinct(r.motion for r in self.results)

    @cached_property
    def poses(self) -> tuple[str, ...]:
        """Levels of pose error."""
        return distinct(r.pose for r in self.results)

    @cached_property
    def metrics(self) -> tuple[str, ...]:
        """The columns in which any cell has a number, in the order of display."""
        return tuple(self.catalogue.in_display_order({key for r in self.results for key in r.metrics}))

    @property
    def geometric_pose(self) -> str:
        """The pose under which distortion is shown: exact where there is one."""
        return EXACT_POSE if EXACT_POSE in self.poses else self.poses[0]

    @property
    def noisy_poses(self) -> tuple[str, ...]:
        """The poses whose row errors tell methods apart; the exact one if there is no other."""
        return tuple(pose for pose in self.poses if pose != EXACT_POSE) or self.poses

    @property
    def failures(self) -> tuple[Result, ...]:
        """The results without a measurement."""
        return self.select(ok=False)

    def select(self, results: Sequence[Result] | None = None, **wanted: Any) -> tuple[Result, ...]:
        """Of all results, or of the given ones, those whose attributes equal what is wanted.

        Such as `part.select(rig="t265", pose="exact")`.
        """
        pool = self.results if results is None else results
        return tuple(r for r in pool if all(getattr(r, name) == value for name, value in wanted.items()))


def distinct(items: Iterable[Item]) -> tuple[Item, ...]:
    """Each once, in the order of their first."""
    return tuple(dict.fromkeys(items))
