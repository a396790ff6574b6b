"""Where the spread of paired differences comes from: units, or what is nested in them."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median, variance

from rectbench.statistics.intervals import Interval, Label, margins_of, nested_means

Below = tuple[Hashable, ...]
"""Some of a path."""


@dataclass(frozen=True)
class Level:
    """What a level within a unit, such as its scenes, adds to the variance of the units' values.

    Parameters
    ----------
    count : how many there are under one of the level above; the median.
    added : so much of the variance would go if there were endlessly many; NaN where none has a second one.
    """

    count: int
    added: float


@dataclass(frozen=True)
class Spread:
    """How differences spread over units, and what each level within them adds.

    Parameters
    ----------
    units : how many.
    mean, variance : of the units' values, all that is nested in them included.
    levels : within a unit, from the outermost on.

    >>> found = Spread.of({("a", 0): 1.0, ("a", 1): 2.0, ("b", 0): 4.0, ("b", 1): 3.0})
    >>> found.mean, found.variance, found.levels[0].count, round(found.levels[0].added, 6)
    (2.5, 2.0, 2, 0.5)
    """

    units: int
    mean: float
    variance: float
    levels: tuple[Level, ...]

    @property
    def interval(self) -> Interval:
        """The t interval of the mean."""
        margin = margins_of(math.sqrt(self.variance), self.units)
        return Interval(self.mean, self.mean - margin, self.mean + margin, self.units)

    @classmethod
    def of(cls, labelled: Mapping[Label, float]) -> Spread:
        """Of differences by (unit, ..., seed), of any depth, the same for all; at least two units.

        The components are those of nested random effects by the method of moments, unbiased for any numbers
        of scenes and seeds (Searle, Casella and McCulloch, Variance Components, 1992, chapter 4). What a
        scene or seed does alike in all units makes no difference between these, and is taken out first.
        """
        values = list(nested_means(labelled).values())
        depth = len(next(iter(labelled)))
        levels = _levels(_own(labelled), depth)
        return cls(len(values), fmean(values), variance(values), levels)


@dataclass(frozen=True)
class _Node:
    """A mean, and what each level below adds to its variance."""

    mean: float
    added: tuple[float, ...]


def _levels(labelled: Mapping[Label, float], depth: int) -> tuple[Level, ...]:
    nodes: dict[Below, _Node] = {path: _Node(value, ()) for path, value in labelled.items()}
    counts, is_known = [], []
    for _ in range(depth - 1):
        groups: dict[Below, list[_Node]] = {}
        for path, node in nodes.items():
            groups.setdefault(path[:-1], []).append(node)
        component = _component(list(groups.values()))
        counts.append(round(median(map(len, groups.values()))))
        is_known.append(component is not None)
        nodes = {path: _joined(group, component or 0.0) for path, group in groups.items()}
    added = [fmean(column) for column in zip(*(node.added for node in nodes.values()), strict=True)]
    inside_out = [
        Level(count, value if known else math.nan)
        for count, value, known in zip(counts, reversed(added), is_known, strict=True)
    ]
    return tuple(reversed(inside_out))


def _component(groups: Sequence[Sequence[_Node]]) -> float | None:
    """The variance of a level's own effects, of its means by group; None where no group has two."""
    several = [group for group in groups if len(group) > 1]
    if not several:
        return None
    freedom = sum(len(group) - 1 for group in several)
    squares = math.fsum((len(g) - 1) * variance(node.mean for node in g) for g in several)
    below = math.fsum((len(g) - 1) * fmean(math.fsum(node.added) for node in g) for g in several)
    return max(0.0, (squares - below) / freedom)


def _joined(group: Sequence[_Node], component: float) -> _Node:
    """The mean of a group: the level's own part of its variance stands before those of the levels below."""
    count = len(group)
    below = (math.fsum(parts) / count**2 for parts in zip(*(node.added for node in group), strict=True))
    return _Node(fmean(node.mean for node in group), (component / count, *below))


def _own(labelled: Mapping[Label, float]) -> dict[Label, float]:
    """The differences less what each scene or seed does alike in all units that have it.

    What is left is scaled up by what the subtraction of a mean over so many units takes away.
    """
    means = nested_means(labelled)
    within = {path: value - means[path[0]] for path, value in labelled.items()}
    shared: dict[Below, list[float]] = {}
    for path, value in within.items():
        shared.setdefault(path[1:], []).append(value)
    own: dict[Label, float] = {}
    for path, value in within.items():
        alike = shared[path[1:]]
        units = len(alike)
        own[path] = value if units == 1 else (value - fmean(alike)) * math.sqrt(units / (units - 1))
    return own
