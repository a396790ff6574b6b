"""Which method is better, as far as the units tell: ranks that are intervals."""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypeVar

import numpy as np

from rectbench.statistics.intervals import ALPHA, LEAST_UNITS, counted, ratio
from rectbench.statistics.paired import FLOOR, better, log_ratios
from rectbench.statistics.power import resolved
from rectbench.types import FloatArray

Unit = TypeVar("Unit", bound=Hashable)


LEAST_SIGNED_RANK_UNITS = 6
"""With five units the least two-sided p of a signed-rank test is 2 / 2**5 = 0.0625."""
NO_SIGNED_RANK = f"below {LEAST_SIGNED_RANK_UNITS} no signed-rank test reaches {ALPHA:g}"


@dataclass(frozen=True)
class Ranking:
    """Methods in their order, and how sure it is.

    Parameters
    ----------
    order : the compared methods, the lowest geometric mean over the same units first; then those `behind`.
    behind : those that lack a number on one of the units that are compared, and so have no rank; the more
        units they have a number on the nearer, then by their geometric mean on these.
    ranks : the first and the last place that each compared method may have; empty where nothing is told.
    resolves : the ratio from which on a typical (median) pair of methods is told apart in four benches
        of five, such as 1.08; None where there are no ranks.
    units : on how many units methods were compared.
    of : how many units any method has a number on.
    reason : why there are no ranks; empty where there are some.
    """

    order: tuple[str, ...]
    behind: tuple[str, ...]
    ranks: Mapping[str, tuple[int, int]]
    resolves: float | None
    units: int
    of: int
    reason: str


def rank(values: Mapping[str, Mapping[Unit, float]], *, floor: float = FLOOR, unit: str = "unit") -> Ranking:
    """Rank methods by their values on each unit, lower being better.

    Parameters
    ----------
    values : by method and unit, such as a rig, see `nested_means`. Values are compared by their ratios
        on the same unit, so no unit weighs more because all values on it are large.
    floor : smaller values count as this: below it all are as good as exact.
    unit : what a unit is called in the reason.

    Two methods are told apart by a paired t test of log ratios over the units, p corrected for all pairs
    of compared methods (Holm); so in at most 5 % of benches any two are told apart that are alike. A
    method's rank begins behind those told to be better and ends before those told to be worse. Values
    that differ by less than a millionth of themselves are the same.

    Compared are the methods with a finite value on each of the same units: all units but those beyond the
    most that any two methods have in common, which fewer than half of the methods that serve most units
    serve. So a unit that one method alone serves decides nothing; and a method that fails where others do
    not has no rank: a mean over the units on which it works, which may be the easy ones, is not that of the
    others. Nor does a method win by failing on a unit that is left out: none is told to be better than one
    that has a value on a unit where it has none itself.

    >>> rank({"a": {1: 1.0, 2: 2.0, 3: 3.0}, "b": {1: 2.0, 2: 4.1, 3: 6.0}, "c": {1: 0.5}}).ranks
    {'a': (1, 1), 'b': (2, 2)}
    >>> rank({"a": {1: 1.0, 2: 2.0}, "b": {1: 2.0, 2: 4.0}}, unit="rig").reason
    '2 rigs: too few to tell methods apart'
    """
    finite = {
        method: {u: max(value, floor) for u, value in numbers.items() if math.isfinite(value)}
        for method, numbers in values.items()
    }
    every = list(dict.fromkeys(u for numbers in finite.values() for u in numbers))
    units = _counting(finite, every)
    compared = [method for method, numbers in finite.items() if units and numbers.keys() >= set(units)]
    behind = [method for method in finite if method not in compared]
    compared.sort(key=lambda method: _mean_log(finite[method], units))
    behind.sort(key=lambda method: (-len(finite[method]), _mean_log(finite[method], finite[method])))
    order = (*compared, *behind)
    if reason := _why_none(compared, behind, len(units), unit):
        return Ranking(order, tuple(behind), {}, None, len(units), len(every), reason)
    logs = np.log([[finite[method][u] for u in units] for method in compared])
    has_all_of = [[finite[a].keys() >= finite[b].keys() for b in compared] for a in compared]
    is_better = better(logs) & np.array(has_all_of)
    first, last = 1 + is_better.sum(axis=0), len(compared) - is_better.sum(axis=1)
    ranks = {method: (int(first[i]), int(last[i])) for i, method in enumerate(compared)}
    return Ranking(order, tuple(behind), ranks, _resolves(logs), len(units), len(every), "")


def _counting(finite: Mapping[str, Mapping[Unit, float]], every: Sequence[Unit]) -> list[Unit]:
    """The units on which methods are compared, see `rank`.

    Where several two have as many in common, what all of these have: none of them is favoured. All units
    where that is no more than half of them: then the methods fail, not the units.
    """
    common = [finite[a].keys() & finite[b].keys() for a, b in combinations(finite, 2)]
    most = max(map(len, common), default=0)
    shared = set(every).intersection(*(units for units in common if len(units) == most))
    if 2 * len(shared) <= len(every):
        return list(every)
    serving = [numbers for numbers in finite.values() if 2 * len(numbers) > len(every)]
    return [u for u in every if u in shared or 2 * sum(u in numbers for numbers in serving) >= len(serving)]


def signed_rank_caveat(units: int, unit: str = "unit") -> str:
    """What is to be said of ranks over so few units that no signed-rank test could back them; else empty.

    >>> signed_rank_caveat(5, "rig")
    '5 rigs: below 6 no signed-rank test reaches 0.05; ranks rest on t tests of log ratios, taken for normal'
    """
    if not LEAST_UNITS <= units < LEAST_SIGNED_RANK_UNITS:
        return ""
    return f"{counted(units, unit)}: {NO_SIGNED_RANK}; ranks rest on t tests of log ratios, taken for normal"


def _why_none(compared: Sequence[str], behind: Sequence[str], units: int, unit: str) -> str:
    if behind and not compared:
        return f"no method has a number on each {unit}"
    if units < LEAST_UNITS:
        return f"{counted(units, unit)}: too few to tell methods apart"
    if len(compared) == 1:
        return f"only {compared[0]} has a number on each {unit}: none to compare it with"
    return ""


def _resolves(logs: FloatArray) -> float:
    first, second = np.triu_indices(len(logs), 1)
    spreads = np.std(log_ratios(logs)[first, second], axis=-1, ddof=1)
    return ratio(resolved(float(np.median(spreads)), logs.shape[-1], tests=len(first)))


def _mean_log(numbers: Mapping[Unit, float], units: Collection[Unit]) -> float:
    return math.fsum(math.log(numbers[u]) for u in units) / len(units) if units else math.inf
