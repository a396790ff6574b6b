"""The step that the sphere models share: a sphere seen from α/(1-α) behind its centre.

(mx, my) = (x, y) / (α d + (1-α) z), with d the distance from the sphere's centre. With α ≤ ½ the
image reaches infinity where the denominator vanishes; with α > ½ it ends at the radius
1/sqrt(2α-1), where the line of sight touches the sphere (Usenko et al. 2018, section III).
"""

from __future__ import annotations

import math
from typing import Any

from rectbench.formulas.domain import LEAST_SLOPE, PIXEL_SLACK, RAY_SLACK
from rectbench.formulas.protocol import Formulas


def edge(alpha: float) -> dict[str, float]:
    """Where the image ends: the squared radius, and the cosine z/d there."""
    if alpha <= 0.5:
        return {"max_square": math.inf, "least_cosine": -1.0}
    square = (1.0 - LEAST_SLOPE**2) / (2.0 * alpha - 1.0)
    mz = (1.0 - alpha * alpha * square) / (alpha * LEAST_SLOPE + 1.0 - alpha)
    return {"max_square": square, "least_cosine": mz / math.hypot(mz, math.sqrt(square))}


def to_sphere_plane(c: Any, x: Any, y: Any, z: Any, square: Any, xp: Formulas) -> tuple[Any, Any, Any]:
    """(mx, my) of a point whose d² is square + z², and whether it is on the near side."""
    d, beyond = distance(z, square, xp)
    depth = c.alpha * beyond + (1.0 - 2.0 * c.alpha) * z
    return x / depth, y / depth, (depth > 0.0) & (z >= (c.least_cosine - RAY_SLACK) * d)


def distance(z: Any, square: Any, xp: Formulas) -> tuple[Any, Any]:
    """d = sqrt(square + z²), and d + z without the cancellation of that sum behind the centre."""
    d = xp.sqrt(square + z * z)
    return d, xp.where(z < 0.0, square / (d - z), d + z)


def from_sphere_plane(c: Any, square: Any, xp: Formulas) -> tuple[Any, Any]:
    """The depth mz of the line of sight (mx, my, mz) of a squared radius, and whether it has one."""
    within = xp.minimum(square, c.max_square)
    root = xp.sqrt(1.0 - (2.0 * c.alpha - 1.0) * within)
    mz = (1.0 - c.alpha * c.alpha * within) / (c.alpha * root + 1.0 - c.alpha)
    return mz, square <= c.max_square * (1.0 + 2.0 * PIXEL_SLACK)
