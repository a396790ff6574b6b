"""The distortion of Brown and Conrady with OpenCV's rational and thin-prism terms, and its inverse.

The coefficients are k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, in OpenCV's order and meaning
(https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from numpy.polynomial import Polynomial

from rectbench.formulas.domain import FARTHEST, LEAST_SLOPE, first_root
from rectbench.formulas.inversion import invert_in_disk
from rectbench.formulas.monotone import edge_of_disk, monotone_radius
from rectbench.formulas.protocol import Formulas

COEFFICIENTS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
STEEPEST = 1e5
"""Slope at which a rational distortion ends on its way to a pole, hundreds of focal lengths out."""
RADIAL = ("k1", "k2", "k3", "k4", "k5", "k6")


def distorted(c: Any, a: Any, b: Any, xp: Formulas) -> tuple[Any, Any]:
    """Where the lens puts the point (a, b) of the ideal plane."""
    q = a * a + b * b
    radial = (1.0 + q * (c.k1 + q * (c.k2 + q * c.k3))) / (1.0 + q * (c.k4 + q * (c.k5 + q * c.k6)))
    ab = 2.0 * a * b
    return (
        a * radial + c.p1 * ab + c.p2 * (q + 2.0 * a * a) + q * (c.s1 + q * c.s2),
        b * radial + c.p1 * (q + 2.0 * b * b) + c.p2 * ab + q * (c.s3 + q * c.s4),
    )


def undistorted(c: Any, a: Any, b: Any, xp: Formulas) -> tuple[Any, Any, Any]:
    """The ideal point of the distorted (a, b), and whether there is one; `c` holds the `edge`."""
    return invert_in_disk(distorted, c, a, b, c.max_radius, c.reach, xp)


def edge(
    p: SimpleNamespace, radius: float = math.inf, slope_before: Callable[[float], float] = lambda _: 1.0
) -> dict[str, float]:
    """The greatest radius, up to the given one, on which the distortion is monotone, and its image's.

    Monotone: the symmetric part of its Jacobian keeps its eigenvalues above `LEAST_SLOPE` on the
    disk of that radius, so no two of its points land on one. For radial terms alone that is where
    the distorted radius stops rising; without distortion there is no such radius. `slope_before` is
    the slope, at a radius, of a step before this one: the two together keep above `LEAST_SLOPE`.
    """
    radius = min(radius, _monotone_radius(*(getattr(p, name) for name in COEFFICIENTS)))
    if math.isinf(radius):
        return {"max_radius": radius, "reach": radius}
    return edge_of_disk(distorted, p, radius, slope_before)


@lru_cache
def _monotone_radius(*coefficients: float) -> float:
    if not any(coefficients):
        return math.inf
    c = SimpleNamespace(**dict(zip(COEFFICIENTS, coefficients, strict=True)))
    radius = min(FARTHEST, _radial_fold(c))
    if all(getattr(c, name) == 0 for name in COEFFICIENTS if name not in RADIAL):
        return radius
    return monotone_radius(distorted, c, radius)


def _radial_fold(c: SimpleNamespace) -> float:
    """Where the slope d/dr of r N(r²)/M(r²) has come down to `LEAST_SLOPE`, or a pole, M = 0, is near."""
    q = Polynomial([0.0, 1.0])
    over, under = Polynomial([1.0, c.k1, c.k2, c.k3]), Polynomial([1.0, c.k4, c.k5, c.k6])
    slope = over * under + 2.0 * q * (over.deriv() * under - over * under.deriv())
    squares = [first_root(slope - LEAST_SLOPE * under**2)]
    if first_root(under) < math.inf:
        squares.append(first_root(slope - STEEPEST * under**2))
    return math.sqrt(min(squares))
