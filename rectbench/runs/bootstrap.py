"""Percentile bootstrap intervals, with what belongs together drawn together."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from rectbench.types import FloatArray

QUANTILES = (0.025, 0.975)

Statistic = Callable[[FloatArray], FloatArray]
"""From numbers [..., clusters, draws, columns], NaN where a cluster has fewer draws, to one number [...]."""


def stacked(clusters: Sequence[FloatArray]) -> FloatArray:
    """[clusters, draws, columns] from one array [draws, columns] a cluster, NaN below the shorter ones."""
    most = max(map(len, clusters))
    missing = [((0, most - len(numbers)), (0, 0)) for numbers in clusters]
    padded = [np.pad(n, space, constant_values=math.nan) for n, space in zip(clusters, missing, strict=True)]
    return np.stack(padded)


def interval(clusters: Sequence[FloatArray], statistic: Statistic, resamples: int) -> tuple[float, float]:
    """The 95 % interval of a statistic of clustered numbers, by a two-stage bootstrap.

    Clusters are drawn, then as many draws from each as it has: the seeds of one pair are no independent
    pairs, and to draw from all cells alike would make intervals narrower than they are (Davison and
    Hinkley, Bootstrap Methods and their Application, 1997, section 3.8).
    """
    rng, numbers = np.random.default_rng(0), stacked(clusters)
    counts = np.array([len(cluster) for cluster in clusters])
    chosen = rng.integers(len(clusters), size=(resamples, len(clusters), 1))
    draws = rng.random((resamples, *numbers.shape[:2])) * counts[chosen]
    low, high = np.quantile(statistic(numbers[chosen, draws.astype(np.intp)]), QUANTILES)
    return float(low), float(high)
