"""The derivatives that distortion is made of, for both images of a rectification."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.types import FloatArray
from rectbench.warps import Rectification, evaluation_pixels
from rectbench.warps.rectification import in_frame


@dataclass(frozen=True, eq=False)
class Jacobians:
    """d(rectified)/d(source) at pixels of both images; NaN where a method keeps no pixel."""

    left: FloatArray
    """[N, 2, 2], columns w1 = d/du and w2 = d/dv."""
    right: FloatArray
    """[M, 2, 2]"""

    @classmethod
    def at(cls, rect: Rectification, pixels: ArrayLike | None = None) -> Jacobians:
        """At `pixels` [N, 2] of both images; None means each image's evaluation pixels."""
        chosen = None if pixels is None else np.asarray(pixels, dtype=np.float64)
        left, right = (
            warp.jacobian(evaluation_pixels(warp.source) if chosen is None else chosen)
            for warp in (rect.left, rect.right)
        )
        return cls(left.reshape(-1, 2, 2), right.reshape(-1, 2, 2))

    @classmethod
    def kept(cls, rect: Rectification, count: int = 2000) -> Jacobians:
        """At those of about `count` pixels of each image that stay in the frame."""
        sides = []
        for warp in (rect.left, rect.right):
            pixels = evaluation_pixels(warp.source, count)
            sides.append(warp.jacobian(pixels[in_frame(warp.forward(pixels), rect.size)]))
        return cls(*sides)

    @property
    def both(self) -> FloatArray:
        """Left then right, those that exist: [K, 2, 2]."""
        stacked = np.concatenate([self.left, self.right])
        mapped: FloatArray = stacked[np.isfinite(stacked).all(axis=(1, 2))]
        return mapped

    @property
    def valid_share(self) -> float:
        """Share of the pixels that the rectification maps at all."""
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


def entries(J: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """a, b, c, d [...] of Jacobians ((a, b), (c, d)) [..., 2, 2]."""
    return J[..., 0, 0], J[..., 0, 1], J[..., 1, 0], J[..., 1, 1]


def finite(values: FloatArray) -> FloatArray:
    """The values that are numbers, flat."""
    return values[np.isfinite(values)]
