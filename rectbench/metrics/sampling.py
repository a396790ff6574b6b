"""What happens at every pixel, not at the 500 alone: distortion, pixels lost and pixels invented."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from rectbench.cameras.arrays import FloatArray, evaluate_points
from rectbench.metrics.distortion import WEIGHTS
from rectbench.metrics.jacobians import losses, singular_values
from rectbench.warps import Rectification, Warp

UNIT_TOLERANCE = 1e-9
"""A singular value this near to 1 is an unchanged length, not a lost or invented pixel."""


def every_pixel(rect: Rectification) -> dict[str, float]:
    """Over all mapped pixels of both images: the mean native L, and shares of pixels by sampling.

    `sampling_lost` is the share of the source area where some direction shrinks (σ2 < 1: pixels are
    lost), `sampling_invented` where some direction grows (σ1 > 1: pixels are invented).
    """
    sides = [per_pixel(warp, warp.source.pixel_grid()) for warp in (rect.left, rect.right)]
    values = np.concatenate([side.reshape(-1, 3) for side in sides])
    mapped = values[np.isfinite(values[:, 0])]
    means = mapped.mean(axis=0) if len(mapped) else np.full(3, math.nan)
    names = ("distortion_native_all_pixels", "sampling_lost", "sampling_invented")
    return dict(zip(names, map(float, means), strict=True))


def per_pixel(warp: Warp, pixels: FloatArray) -> FloatArray:
    """Native L, and whether a pixel is lost and one invented (0 or 1), of pixels [..., 2]: [..., 3]."""
    return evaluate_points(_formula(warp), warp.constants, pixels)[0]


def _formula(warp: Warp) -> Callable[..., tuple[Any, ...]]:
    weights = [float(weight) ** 2 for weight in WEIGHTS]

    def formula(c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, ...]:
        p, q, r, s, ok = warp.jacobian_formula(c, u, v, xp)
        area, ratio, skew = losses(p, q, r, s, xp)
        loss = weights[0] * area * area + weights[1] * ratio * ratio + weights[2] * skew * skew
        large, small = singular_values(p, q, r, s, xp)
        lost = xp.where(small < 1.0 - UNIT_TOLERANCE, 1.0, 0.0 * small)
        invented = xp.where(large > 1.0 + UNIT_TOLERANCE, 1.0, 0.0 * large)
        return loss, lost, invented, ok

    return formula
