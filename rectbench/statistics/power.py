"""What a design can tell apart: noncentral t, at the level of Holm's first step."""

from __future__ import annotations

import math

from scipy.optimize import brentq
from scipy.special import gammaincinv, nctdtr, stdtrit

from rectbench.statistics.intervals import ALPHA

POWER = 0.8
"""A difference is resolved if it is told in this share of benches."""


def power(difference: float, spread: float, units: int, tests: int = 1, alpha: float = ALPHA) -> float:
    """How often a paired t test over units tells a mean `difference` whose units spread by `spread` (SD).

    Told is which way it goes, too. `tests` is how many pairs of methods are compared: the test is at the
    level of Holm's first step, alpha / tests. Fewer than two units tell nothing.

    >>> round(power(1.0, 1.0, 10), 2)
    0.8
    """
    if units < 2 or not difference:
        return 0.0
    if not spread:
        return 1.0
    critical = stdtrit(units - 1, 1 - alpha / (2 * tests))
    shift = abs(difference) / spread * math.sqrt(units)
    return float(1 - nctdtr(units - 1, shift, critical))


def resolved(spread: float, units: int, tests: int = 1, wanted: float = POWER) -> float:
    """The smallest mean difference that is told with the wanted power; NaN below two units.

    >>> round(resolved(1.0, 10), 2)
    1.0
    """
    if units < 2:
        return math.nan
    if not spread:
        return 0.0
    ceiling = 1.0
    while power(ceiling, 1.0, units, tests) < wanted:
        ceiling *= 2
    root = brentq(lambda shift: power(shift, 1.0, units, tests) - wanted, 0.0, ceiling)
    return float(root) * spread


def variance_factors(units: int, level: float = 1 - ALPHA) -> tuple[float, float]:
    """The ends of the interval of a variance that is known from so many units, as factors of the estimate.

    >>> low, high = variance_factors(10)
    >>> round(low, 2), round(high, 2)
    (0.47, 3.33)
    """
    half, tail = (units - 1) / 2, (1 - level) / 2
    return float(half / gammaincinv(half, 1 - tail)), float(half / gammaincinv(half, tail))
