"""What happens at every pixel, not at the 500 alone: distortion, pixels lost and pixels invented."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rectbench.formulas.evaluation import evaluate_points
from rectbench.metrics.distortion import PROTOCOLS, WEIGHTS
from rectbench.types import FloatArray
from rectbench.warps import Rectification, Warp, evaluation_pixels
from rectbench.warps.jacobians import Jacobians, losses, singular_values

UNIT_TOLERANCE = 1e-9
"""A singular value this near to 1 is an unchanged length, not a lost or invented pixel."""

ROWS_AT_ONCE = 400
"""Rows of an image looked at in one go: what many megapixels need at once would be gigabytes."""

SCALING_PIXELS = 10_000
"""Pixels an image on which the best scales are found: L is flat about its minimum."""


def every_pixel(rect: Rectification) -> dict[str, float]:
    """Over all mapped pixels of both images: mean L under each protocol, and shares of pixels by sampling.

    `sampling_lost` is the share of the source area where some direction shrinks (σ2 < 1: pixels are
    lost), `sampling_invented` where some direction grows (σ1 > 1: pixels are invented).
    """
    left, right = (
        warp.jacobian(evaluation_pixels(warp.source, SCALING_PIXELS)) for warp in (rect.left, rect.right)
    )
    both = Jacobians(left, right).both
    scales = [find(both) for find in PROTOCOLS.values()]
    sums, count = np.zeros(len(scales) + 2), 0
    for warp in (rect.left, rect.right):
        for rows in np.array_split(warp.source.pixel_grid(), math.ceil(warp.source.height / ROWS_AT_ONCE)):
            values = per_pixel(warp, rows, scales).reshape(-1, len(sums))
            mapped = np.isfinite(values[:, 0])
            sums += values.sum(axis=0, where=mapped[:, None])
            count += int(mapped.sum())
    names = (*(f"distortion_{name}_all_pixels" for name in PROTOCOLS), "sampling_lost", "sampling_invented")
    return dict(zip(names, map(float, sums / count if count else np.full(len(sums), math.nan)), strict=True))


def per_pixel(
    warp: Warp, pixels: FloatArray, scales: Sequence[tuple[float, float]] = ((1.0, 1.0),)
) -> FloatArray:
    """L at each of the K scales (s_u, s_v), and whether a pixel is lost and one invented (0 or 1).

    At source pixels [..., 2]: [..., K + 2].
    """
    constants = {"warp": warp.constants, "scales": tuple(scales)}
    return evaluate_points(_formula(warp), constants, pixels)[0]


def _formula(warp: Warp) -> Callable[..., tuple[Any, ...]]:
    weights = [float(weight) ** 2 for weight in WEIGHTS]

    def formula(c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, ...]:
        p, q, r, s, ok = warp.jacobian_formula(c.warp, u, v, xp)

        def loss(s_u: Any, s_v: Any) -> Any:
            area, ratio, skew = losses(s_u * p, s_u * q, s_v * r, s_v * s, xp)
            return weights[0] * area * area + weights[1] * ratio * ratio + weights[2] * skew * skew

        large, small = singular_values(p, q, r, s, xp)
        lost = xp.where(small < 1.0 - UNIT_TOLERANCE, 1.0, 0.0 * small)
        invented = xp.where(large > 1.0 + UNIT_TOLERANCE, 1.0, 0.0 * large)
        return *(loss(s_u, s_v) for s_u, s_v in c.scales), lost, invented, ok

    return formula
