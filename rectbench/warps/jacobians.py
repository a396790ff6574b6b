"""The derivatives that distortion is made of, for both images of a rectification."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.types import BoolArray, FloatArray
from rectbench.warps import Rectification, evaluation_pixels


@dataclass(frozen=True, eq=False)
class Jacobians:
    """d(rectified)/d(source) at places of both images; NaN where a method keeps no pixel."""

    left: FloatArray
    """[N, 2, 2], columns w1 = d/du and w2 = d/dv."""
    right: FloatArray
    """[M, 2, 2]"""
    left_weights: FloatArray | None = None
    """[N], of the places; all count alike where it is left out."""
    right_weights: FloatArray | None = None
    """[M]"""

    @classmethod
    def at(cls, rect: Rectification, pixels: ArrayLike | None = None) -> Jacobians:
        """At `pixels` [N, 2] of both images; None means each image's evaluation pixels."""
        chosen = None if pixels is None else np.asarray(pixels, dtype=np.float64)
        left, right = (
            warp.jacobian(evaluation_pixels(warp.source) if chosen is None else chosen)
            for warp in (rect.left, rect.right)
        )
        return cls(left.reshape(-1, 2, 2), right.reshape(-1, 2, 2))

    @cached_property
    def exist(self) -> BoolArray:
        """Which of the left ones, then of the right ones, exist: [N + M]."""
        exists: BoolArray = np.isfinite(np.concatenate([self.left, self.right])).all(axis=(1, 2))
        return exists

    @cached_property
    def both(self) -> FloatArray:
        """Left then right, those that exist: [K, 2, 2]."""
        mapped: FloatArray = np.concatenate([self.left, self.right])[self.exist]
        return mapped

    @cached_property
    def weights(self) -> FloatArray:
        """Those of `both` [K]; their mean is 1."""
        sides = (self.left, self.left_weights), (self.right, self.right_weights)
        stacked = np.concatenate([np.ones(len(J)) if w is None else w for J, w in sides])[self.exist]
        return stacked / stacked.mean() if stacked.size else stacked

    @property
    def valid_share(self) -> float:
        """Share of the places that the rectification maps at all."""
        return len(self.both) / max(1, len(self.left) + len(self.right))


def losses(a: Any, b: Any, c: Any, d: Any, xp: Any) -> tuple[Any, Any, Any]:
    """S - 1, |w1| - |w2| and w1·w2 of the Jacobian ((a, b), (c, d)), on arrays of any namespace.

    The paper's L_area, L_ratio and L_skew (section III-D) are their squares.
    """
    return xp.abs(a * d - b * c) - 1.0, xp.hypot(a, c) - xp.hypot(b, d), a * b + c * d


def singular_values(a: Any, b: Any, c: Any, d: Any, xp: Any) -> tuple[Any, Any]:
    """σ1 ≥ σ2 of the Jacobian ((a, b), (c, d)), in closed form, on arrays of any namespace.

    From the conformal and anti-conformal parts of the matrix: σ1, σ2 = |p ± q|, which loses no
    digits where the two are nearly equal.
    """
    p = 0.5 * xp.hypot(a + d, c - b)
    q = 0.5 * xp.hypot(a - d, c + b)
    return p + q, xp.abs(p - q)


@dataclass(frozen=True, eq=False)
class LogStretches:
    """Logarithms of the singular values σ1 ≥ σ2 of Jacobians: their mean, and half of their difference."""

    size: FloatArray
    """[N], (log σ1 + log σ2) / 2."""
    squeeze: FloatArray
    """[N], (log σ1 - log σ2) / 2."""

    @classmethod
    def of(cls, J: FloatArray) -> LogStretches:
        """Those of Jacobians [N, 2, 2]; infinite where one is singular."""
        large, small = singular_values(*entries(J), np)
        with np.errstate(divide="ignore"):
            large, small = np.log(large), np.log(small)
        return cls((large + small) / 2, (large - small) / 2)

    def distortion(self, weights: FloatArray | None = None) -> tuple[float, float, float]:
        """RMS of log σ1 and log σ2 about their common mean; its parts area and anisotropy.

        The square of the first is the sum of the squares of the others: what changes in size from place to
        place, and what is squeezed. Places of weight 0 do not count. NaN without any, and where a Jacobian
        is singular.
        """
        size, squeeze = self.size, self.squeeze
        weights = np.ones(len(size)) if weights is None else weights
        if not np.isfinite(size).all():
            counts = weights > 0
            size, squeeze, weights = size[counts], squeeze[counts], weights[counts]
        total = weights.sum()
        if not (total > 0 and np.isfinite(size).all()):
            return math.nan, math.nan, math.nan
        area = math.sqrt(weights @ np.square(size - weights @ size / total) / total)
        anisotropy = math.sqrt(weights @ np.square(squeeze) / total)
        return math.hypot(area, anisotropy), area, anisotropy


def entries(J: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """a, b, c, d [...] of Jacobians ((a, b), (c, d)) [..., 2, 2]."""
    return J[..., 0, 0], J[..., 0, 1], J[..., 1, 0], J[..., 1, 1]


def finite(values: FloatArray) -> FloatArray:
    """The values that are numbers, flat."""
    return values[np.isfinite(values)]
