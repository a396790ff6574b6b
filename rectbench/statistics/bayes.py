"""How probable it is that a method is better than another, or as good for all that matters in practice.

A Bayesian signed-rank test on log ratios over units (Benavoli, Mangili, Corani, Zaffalon and Ruggeri, A
Bayesian Wilcoxon signed-rank test based on the Dirichlet process, ICML 2014), as baycomp computes it
(Benavoli, Corani, Demšar and Zaffalon, Time for a Change, JMLR 18, 2017).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rectbench.statistics.intervals import counted
from rectbench.statistics.paired import FLOOR
from rectbench.statistics.ranking import LEAST_SIGNED_RANK_UNITS, NO_SIGNED_RANK, Unit

EQUIVALENT = 0.02
"""Methods whose values differ by less than this share are the same in practice."""
SAMPLES = 2500
"""Of the posterior: a probability is then known to 0.01."""
BEYOND = 1e6
"""Stands for the logarithm of infinity, where only order counts."""


@dataclass(frozen=True)
class Belief:
    """What the units two methods share say of a pair of methods; three probabilities that sum to 1.

    >>> belief, = signed_rank({"a": dict.fromkeys(range(12), 1.0), "b": dict.fromkeys(range(12), 1.1)})
    >>> belief.a_better > 0.99
    True
    """

    a: str
    b: str
    units: int
    a_better: float
    """That a is typically lower than b by more than the region of equivalence; NaN where nothing is told."""
    equivalent: float
    b_better: float
    reason: str = ""
    """Why there are no probabilities; empty where there are."""


def signed_rank(
    values: Mapping[str, Mapping[Unit, float]],
    *,
    equivalent: float = EQUIVALENT,
    floor: float = FLOOR,
    unit: str = "unit",
    seed: int = 0,
) -> tuple[Belief, ...]:
    """What is to be believed of each pair of methods, over the units on which both have a value.

    Parameters
    ----------
    values : by method and unit, lower being better; infinite is worse than any number, and on a unit where
        both are nothing is to be told.
    equivalent : the region of practical equivalence: values that differ by less than this share.
    floor : smaller values count as this.
    unit : what a unit is called in a reason.
    seed : of the samples of the posterior.
    """
    return tuple(
        _belief(a, b, list(_logs(values[a], values[b], floor)), math.log1p(equivalent), unit, seed)
        for a, b in combinations(values, 2)
    )


def _logs(a: Mapping[Unit, float], b: Mapping[Unit, float], floor: float) -> Iterator[tuple[float, float]]:
    for unit, value in a.items():
        other = b.get(unit, math.nan)
        if not (math.isnan(value) or math.isnan(other) or value == other == math.inf):
            yield min(math.log(max(value, floor)), BEYOND), min(math.log(max(other, floor)), BEYOND)


def _belief(a: str, b: str, logs: list[tuple[float, float]], region: float, unit: str, seed: int) -> Belief:
    units = len(logs)
    if units < LEAST_SIGNED_RANK_UNITS:
        reason = f"{counted(units, unit)}: {NO_SIGNED_RANK}"
        return Belief(a, b, units, math.nan, math.nan, math.nan, reason)
    from baycomp import SignedRankTest  # its import takes a second

    first, second = np.transpose(logs)
    told = SignedRankTest.probs(first, second, rope=region, nsamples=SAMPLES, random_state=seed)
    b_better, equivalent, a_better = map(float, told)  # baycomp's first has the higher values on its left
    return Belief(a, b, units, a_better, equivalent, b_better)
