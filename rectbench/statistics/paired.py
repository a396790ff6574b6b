"""Paired comparisons of methods on the same units, on arrays of logarithms."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import stdtr

from rectbench.statistics.intervals import ALPHA
from rectbench.types import BoolArray, FloatArray

TIE = 1e-6
"""Logarithms of values as near as this to each other are the same. What methods share in theory, such as the
row error in source pixels under one pose, comes out 1e-9 to 1e-6 of itself apart, through iterated inverses
and slopes over finite steps; and no millionth is a reason to prefer a method."""
FLOOR = 1e-9
"""Smaller values, in whatever unit they are stored, are zero with rounding: as good as each other."""


def log_ratios(logs: FloatArray) -> FloatArray:
    """[..., methods, methods, units]: differences of logarithms [..., methods, units], without rounding."""
    ratios = logs[..., :, None, :] - logs[..., None, :, :]
    settled: FloatArray = np.where(np.abs(ratios) <= TIE, 0.0, ratios)
    return settled


def p_values(ratios: FloatArray) -> FloatArray:
    """Two-sided p of t tests that the mean of [..., units] is zero; 1 where every difference is zero."""
    units = ratios.shape[-1]
    if units < 2:
        return np.ones(ratios.shape[:-1])
    means = np.mean(ratios, axis=-1)
    errors = np.maximum(np.std(ratios, axis=-1, ddof=1), TIE) / math.sqrt(units)
    p: FloatArray = np.minimum(2 * stdtr(units - 1, -np.abs(means) / errors), 1.0)
    return p


def holm(p: FloatArray) -> FloatArray:
    """p values [..., tests] corrected for their number (Holm, Scandinavian Journal of Statistics 6, 1979)."""
    tests = p.shape[-1]
    order = np.argsort(p, axis=-1, kind="stable")
    counts = np.arange(tests, 0, -1.0)
    steps = np.maximum.accumulate(np.take_along_axis(p, order, axis=-1) * counts, axis=-1)
    corrected = np.empty_like(p)
    np.put_along_axis(corrected, order, np.minimum(steps, 1.0), axis=-1)
    return corrected


def better(logs: FloatArray, alpha: float = ALPHA) -> BoolArray:
    """[..., methods, methods]: whether the first is told to be below the second, of [..., methods, units].

    At most a share `alpha` of all benches says so of any pair of methods of which it is false.
    """
    methods = logs.shape[-2]
    first, second = np.triu_indices(methods, 1)
    ratios = log_ratios(logs)[..., first, second, :]
    told = holm(p_values(ratios)) <= alpha
    is_below = np.mean(ratios, axis=-1) < 0
    found = np.zeros((*logs.shape[:-1], methods), dtype=np.bool_)
    found[..., first, second] = told & is_below
    found[..., second, first] = told & ~is_below
    return found
