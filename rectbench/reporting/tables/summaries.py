"""Averages over cells as each column says: over rigs, of each rig's own average."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rectbench.plugins.metric import Average, Column
from rectbench.plugins.result import Result
from rectbench.runs.units import floor_of
from rectbench.statistics.intervals import Interval, mean_interval, nested_means

_LARGEST = 1e150
"""Of numbers whose squares a float can hold; beyond, infinities among them, there is no interval."""
_LARGEST_LOG = 709.0
"""Of numbers that a float can hold."""


_FEW_RIGS, _WIDEST = 6, 4.0
"""With fewer rigs, an interval whose ends are a larger factor apart tells nothing worth printing."""


def is_too_wide(interval: Interval) -> bool:
    """Whether an interval over few rigs is so wide that only their number is worth telling.

    >>> is_too_wide(Interval(0.2, 0.04, 1.2, 3)), is_too_wide(Interval(0.2, 0.04, 1.2, 12))
    (True, False)
    """
    return interval.units < _FEW_RIGS and interval.high > _WIDEST * max(interval.low, 0.0)


_Label = tuple[str, str, str, str, int]
"""Of a cell: rig, motion, scene, pose, seed."""


@dataclass(frozen=True)
class Averaged:
    """A column over some cells, of which `count` have a value.

    Parameters
    ----------
    value : the average over rigs; None where no cell has a value.
    by_rig : each rig's own: over its motions the average over scenes of that over seeds.
    interval : how sure the average is; None of a maximum or minimum, and where a value is infinite.
    """

    value: float | None
    count: int
    by_rig: Mapping[str, float] = field(default_factory=dict)
    interval: Interval | None = None


@dataclass(frozen=True)
class Summary:
    """A method over `cells` cells, of which `ok` were measured; averages are over those alone."""

    method: str
    cells: int
    ok: int
    averages: Mapping[str, Averaged]

    @property
    def failed(self) -> int:
        """How many cells hold no measurement."""
        return self.cells - self.ok

    @property
    def complete(self) -> bool:
        """Whether every cell was measured, so that averages compare with those of other methods."""
        return self.failed == 0


def summarise(method: str, results: Sequence[Result], columns: Iterable[Column]) -> Summary:
    """Average the `columns` over the ok cells of `results`, each as it says."""
    return Summary(
        method, len(results), sum(r.ok for r in results), {c.key: averaged(c, results) for c in columns}
    )


def averaged(column: Column, results: Iterable[Result]) -> Averaged:
    """The column's average over those of the cells that have a value."""
    labelled = {
        (r.rig, r.motion, r.scene, r.pose, r.seed): r.metrics[column.key]
        for r in results
        if r.ok and column.key in r.metrics
    }
    if not labelled:
        return Averaged(None, 0)
    if column.average in _EXTREMES:
        return _extreme(_EXTREMES[column.average], labelled)
    onto, back = _SCALES[column.average]
    least = floor_of(column) if column.average == "geometric" else -math.inf
    units = nested_means({label: onto(max(value, least)) for label, value in labelled.items()})
    by_rig = {str(rig): back(value) for rig, value in units.items()}
    if max(map(abs, units.values())) > _LARGEST:
        return Averaged(back(math.fsum(units.values()) / len(units)), len(labelled), by_rig)
    found = mean_interval(units.values())
    interval = Interval(back(found.estimate), back(found.low), back(found.high), found.units)
    return Averaged(interval.estimate, len(labelled), by_rig, interval)


def _extreme(of: Callable[[Iterable[float]], float], labelled: Mapping[_Label, float]) -> Averaged:
    rigs = dict.fromkeys(str(rig) for rig, *_ in labelled)
    by_rig = {rig: of(value for label, value in labelled.items() if label[0] == rig) for rig in rigs}
    return Averaged(of(by_rig.values()), len(labelled), by_rig)


def _same(value: float) -> float:
    return value


def _exp(value: float) -> float:
    return math.inf if value > _LARGEST_LOG else math.exp(value)


def _square(value: float) -> float:
    return value * value


def _root(value: float) -> float:
    """The lower end of an interval of squares may lie below zero."""
    return 0.0 if value < 0 else math.sqrt(value)


_SCALES: Mapping[Average, tuple[Callable[[float], float], Callable[[float], float]]] = {
    "mean": (_same, _same),
    "geometric": (math.log, _exp),
    "rms": (_square, _root),
}
"""By the rule of a column: onto the scale on which it is averaged, and back."""
_EXTREMES: Mapping[Average, Callable[[Iterable[float]], float]] = {"max": max, "min": min}
