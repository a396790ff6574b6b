"""95 % intervals over units: of means, of geometric means, of counts.

A unit is what was drawn independently, such as a rig; motions, scenes and seeds of one unit are nested
in it, and count as one value of the unit. So no spread within a unit can make an interval narrower than
the units allow.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from scipy.special import betaincinv, stdtrit

from rectbench.errors import InvalidInput
from rectbench.types import FloatArray

ALPHA = 0.05
"""So often may chance alone have its way: in every test, of every count, and beyond the ends of intervals."""
LEAST_UNITS = 3
"""Fewer units carry no interval: with two it would be 9 times as wide as their distance."""
LARGEST_LOG = math.log(sys.float_info.max)
Label = TypeVar("Label", bound=tuple[Hashable, ...])
"""From a unit down to what is nested in it."""
T = TypeVar("T", float, FloatArray)


@dataclass(frozen=True)
class Interval:
    """An estimate and the ends of its interval.

    `low` and `high` are NaN where the units are too few for an interval, or one of them is infinite.

    >>> mean_interval([1.0, 2.0]).why_none("rig")
    '2 rigs: too few for an interval'
    """

    estimate: float
    low: float
    high: float
    units: int

    def why_none(self, unit: str = "unit") -> str:
        """What stands in the place of the interval where there is none; empty where there is one."""
        if self.units < LEAST_UNITS:
            return f"{counted(self.units, unit)}: too few for an interval"
        return "unbounded" if math.isnan(self.low) else ""


def mean_interval(values: Iterable[float], level: float = 1 - ALPHA) -> Interval:
    """Student's t interval of the mean over units; values that are NaN are left out.

    >>> found = mean_interval([1.0, 2.0, 3.0])
    >>> round(found.low, 3), found.estimate, round(found.high, 3)
    (-0.484, 2.0, 4.484)
    """
    numbers = np.array([value for value in values if not math.isnan(value)])
    if not len(numbers):
        return Interval(math.nan, math.nan, math.nan, 0)
    estimate, margin = float(np.mean(numbers)), float(margins(numbers, level))
    return Interval(estimate, estimate - margin, estimate + margin, len(numbers))


def geometric_interval(values: Iterable[float], level: float = 1 - ALPHA) -> Interval:
    """The t interval of logarithms: of the geometric mean of values above zero, or of ratios.

    Values that are NaN are left out. Raises InvalidInput for one that is not above zero.

    >>> round(geometric_interval([1.0, 2.0, 4.0]).estimate, 6)
    2.0
    """
    numbers = [value for value in values if not math.isnan(value)]
    if wrong := [value for value in numbers if not value > 0]:
        raise InvalidInput(f"a value is {wrong[0]:g}; expected numbers above 0 for a geometric mean")
    logs = mean_interval(map(math.log, numbers), level)
    return Interval(ratio(logs.estimate), ratio(logs.low), ratio(logs.high), logs.units)


def count_interval(successes: int, trials: int, level: float = 1 - ALPHA) -> Interval:
    """The exact interval of a share (Clopper and Pearson, Biometrika 26, 1934), from 0 to 1.

    Raises InvalidInput where the successes are not among the trials.

    >>> found = count_interval(4, 4)
    >>> found.estimate, round(found.low, 3), found.high
    (1.0, 0.398, 1.0)
    """
    if not 0 <= successes <= trials:
        raise InvalidInput(f"successes are {successes} of {trials}; expected a number from 0 to {trials}")
    if not trials:
        return Interval(math.nan, math.nan, math.nan, 0)
    tail = (1 - level) / 2
    low = betaincinv(successes, trials - successes + 1, tail) if successes else 0.0
    high = betaincinv(successes + 1, trials - successes, 1 - tail) if successes < trials else 1.0
    return Interval(successes / trials, float(low), float(high), trials)


def nested_means(labelled: Mapping[Label, float]) -> dict[Hashable, float]:
    """The value of each unit: the mean over its motions of the mean over scenes of the mean over seeds.

    Keys are (unit, motion, scene, seed), of any depth, the same for all; values that are NaN are left
    out. So a scene with ten seeds weighs as much as one with two.

    >>> street = {("t265", "street", 0): 1.0, ("t265", "street", 1): 3.0}
    >>> nested_means({**street, ("t265", "room", 0): 6.0, ("tumvi", "room", 0): 5.0})
    {'t265': 4.0, 'tumvi': 5.0}
    """
    means: dict[tuple[Hashable, ...], float] = {
        key: value for key, value in labelled.items() if not math.isnan(value)
    }
    while means and len(next(iter(means))) > 1:
        groups: dict[tuple[Hashable, ...], list[float]] = {}
        for key, value in means.items():
            groups.setdefault(key[:-1], []).append(value)
        means = {key: math.fsum(group) / len(group) for key, group in groups.items()}
    return {key[0]: value for key, value in means.items()}


def margins(values: FloatArray, level: float = 1 - ALPHA) -> FloatArray:
    """Half the width of the t intervals of the means of [..., units]; NaN for fewer than `LEAST_UNITS`."""
    units = values.shape[-1]
    if units < LEAST_UNITS:
        return np.full(values.shape[:-1], math.nan)
    with np.errstate(
        invalid="ignore", over="ignore"
    ):  # infinite values have no spread, huge ones an infinite one
        spread = np.std(values, axis=-1, ddof=1)
    return margins_of(spread, units, level)


def margins_of(spread: T, units: int, level: float = 1 - ALPHA) -> T:
    """The same by the standard deviation of the units' values, a number or an array; two units at least."""
    return float(stdtrit(units - 1, (1 + level) / 2)) / math.sqrt(units) * spread


def ratio(log: float) -> float:
    """The number of which this is the logarithm; infinite where it is too large for a float."""
    return math.inf if log > LARGEST_LOG else math.exp(log)


def counted(units: int, unit: str = "unit") -> str:
    """How many units there are, in words.

    >>> counted(1), counted(2, "rig")
    ('1 unit', '2 rigs')
    """
    return f"{units} {unit}{'' if units == 1 else 's'}"
