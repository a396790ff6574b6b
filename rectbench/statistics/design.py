"""How large a design has to be to tell a difference: units, or what is nested in them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rectbench.errors import InvalidInput
from rectbench.statistics.components import Spread
from rectbench.statistics.intervals import LEAST_UNITS
from rectbench.statistics.power import POWER, power, resolved

MOST_UNITS = 1_000_000
"""More would never be measured: there is no answer then."""


@dataclass(frozen=True)
class Needs:
    """What tells a difference in four benches of five; each number with all others as they are.

    >>> spread = Spread.of({("a", 0): 1.0, ("a", 1): 2.0, ("b", 0): 4.0, ("b", 1): 3.0})
    >>> Needs.of(spread, difference=1.0)
    Needs(units=18, levels=(None,))
    """

    units: int | None
    """None beyond a million."""
    levels: tuple[int | None, ...]
    """How many of each level within a unit; None where no number is enough on so few units."""

    @classmethod
    def of(cls, spread: Spread, difference: float, tests: int = 1) -> Needs:
        """For a mean `difference` between methods of which so many pairs are tested.

        Raises InvalidInput for a difference that is not above zero.
        """
        if not difference > 0:
            raise InvalidInput(f"difference is {difference:g}; expected a number above 0")
        levels = range(len(spread.levels))
        units = units_needed(difference, math.sqrt(spread.variance), tests)
        return cls(units, tuple(_level_needed(spread, level, difference, tests) for level in levels))


def units_needed(difference: float, spread: float, tests: int = 1) -> int | None:
    """The least number of units that tell the difference with the wanted power; None beyond a million.

    >>> units_needed(1.0, 1.0)
    10
    """
    enough = LEAST_UNITS
    while power(difference, spread, enough, tests) < POWER:
        enough *= 2
        if enough > MOST_UNITS:
            return None
    too_few = max(enough // 2, LEAST_UNITS - 1)
    while enough - too_few > 1:
        middle = (enough + too_few) // 2
        if power(difference, spread, middle, tests) < POWER:
            too_few = middle
        else:
            enough = middle
    return enough


def _level_needed(spread: Spread, level: int, difference: float, tests: int) -> int | None:
    """Of how many a level has to be: what it and the levels below add to the variance shrinks by as much."""
    count = spread.levels[level].count
    allowed = (difference / resolved(1.0, spread.units, tests)) ** 2
    if spread.variance <= allowed:
        return count
    added = [below.added for below in spread.levels[level:]]
    shrinks = min(math.fsum(0.0 if math.isnan(part) else part for part in added), spread.variance)
    fixed = spread.variance - shrinks
    return None if fixed >= allowed else math.ceil(count * shrinks / (allowed - fixed))
