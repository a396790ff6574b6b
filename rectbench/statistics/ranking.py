"""Which method is better, as far as the units tell: ranks that are intervals."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from rectbench.statistics.intervals import LEAST_UNITS, counted, ratio
from rectbench.statistics.paired import NOISE, better, log_ratios
from rectbench.statistics.power import resolved
from rectbench.types import FloatArray

Unit = TypeVar("Unit", bound=Hashable)


LEAST_SIGNED_RANK_UNITS = 6
"""With five units the least two-sided p of a signed-rank test is 2 / 2**5 = 0.0625."""
NO_SIGNED_RANK = f"below {LEAST_SIGNED_RANK_UNITS} no signed-rank test reaches 0.05"


@dataclass(frozen=True)
class Ranking:
    """Methods in their order, and how sure it is.

    Parameters
    ----------
    order : the ranked methods, the lowest geometric mean first; behind them those without a rank, the
        more units they have a value on the nearer, then by their geometric mean on these.
    ranks : the first and the last place that each ranked method may have; empty where nothing is told.
    resolves : the ratio from which on a typical (median) pair of methods is told apart in four benches
        of five, such as 1.08; None where there are no ranks, or fewer than two methods.
    units : on how many units the ranked methods were compared.
    reason : why there are no ranks; empty where there are some.
    """

    order: tuple[str, ...]
    ranks: Mapping[str, tuple[int, int]]
    resolves: float | None
    units: int
    reason: str


def rank(values: Mapping[str, Mapping[Unit, float]], *, floor: float = NOISE, unit: str = "unit") -> Ranking:
    """Rank methods by their values on each unit, lower being better.

    Parameters
    ----------
    values : by method and unit, such as a rig, see `nested_means`. Values are compared by their ratios
        on the same unit, so no unit weighs more because all values on it are large.
    floor : smaller values count as this: below it all are as good as exact.
    unit : what a unit is called in the reason.

    Two methods are told apart by a paired t test of log ratios over the units, p corrected for all pairs
    of ranked methods (Holm); so in at most 5 % of benches any two are told apart that are alike. A
    method's rank begins behind those told to be better and ends before those told to be worse. Values
    that differ by less than 1e-9 of themselves are the same.

    A method is ranked if it has a finite value on every unit on which any method has one: a mean over
    the units on which it works, which may be the easy ones, cannot be compared with a mean over all of
    them. The others follow without a rank.

    >>> rank({"a": {1: 1.0, 2: 2.0, 3: 3.0}, "b": {1: 2.0, 2: 4.1, 3: 6.0}, "c": {1: 0.5}}).ranks
    {'a': (1, 1), 'b': (2, 2)}
    >>> rank({"a": {1: 1.0, 2: 2.0}, "b": {1: 2.0, 2: 4.0}}, unit="rig").reason
    '2 rigs: too few to tell methods apart'
    """
    finite = {
        method: {u: max(value, floor) for u, value in numbers.items() if math.isfinite(value)}
        for method, numbers in values.items()
    }
    units = list(dict.fromkeys(u for numbers in finite.values() for u in numbers))
    order = sorted(finite, key=lambda method: (-len(finite[method]), _mean_log(finite[method])))
    ranked = [method for method in order if units and len(finite[method]) == len(units)]
    if reason := _why_none(order, ranked, len(units), unit):
        return Ranking(tuple(order), {}, None, len(units), reason)
    logs = np.log([[finite[method][u] for u in units] for method in ranked])
    is_better = better(logs)
    first, last = 1 + is_better.sum(axis=0), len(ranked) - is_better.sum(axis=1)
    ranks = {method: (int(first[i]), int(last[i])) for i, method in enumerate(ranked)}
    return Ranking(tuple(order), ranks, _resolves(logs), len(units), "")


def signed_rank_caveat(units: int, unit: str = "unit") -> str:
    """What is to be said of ranks over so few units that no signed-rank test could back them; else empty.

    >>> signed_rank_caveat(5, "rig")
    '5 rigs: below 6 no signed-rank test reaches 0.05; ranks rest on t tests of log ratios, taken for normal'
    """
    if not LEAST_UNITS <= units < LEAST_SIGNED_RANK_UNITS:
        return ""
    return f"{counted(units, unit)}: {NO_SIGNED_RANK}; ranks rest on t tests of log ratios, taken for normal"


def _why_none(order: list[str], ranked: list[str], units: int, unit: str) -> str:
    if order and not ranked:
        return f"no method has a number on each {unit}"
    if units < LEAST_UNITS:
        return f"{counted(units, unit)}: too few to tell methods apart"
    return ""


def _resolves(logs: FloatArray) -> float | None:
    first, second = np.triu_indices(len(logs), 1)
    if not len(first):
        return None
    spreads = np.std(log_ratios(logs)[first, second], axis=-1, ddof=1)
    return ratio(resolved(float(np.median(spreads)), logs.shape[-1], tests=len(first)))


def _mean_log(numbers: Mapping[Unit, float]) -> float:
    return math.fsum(map(math.log, numbers.values())) / len(numbers) if numbers else math.inf
