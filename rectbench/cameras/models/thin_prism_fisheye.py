"""Weng, Cohen & Herniou 1992 on the equidistant plane: COLMAP's `THIN_PRISM_FISHEYE`."""

from __future__ import annotations

import math
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from numpy.polynomial import Polynomial

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.domain import LEAST_SLOPE, first_root
from rectbench.formulas.inversion import invert_in_disk
from rectbench.formulas.monotone import edge_of_disk, monotone_radius
from rectbench.formulas.protocol import Formulas

COEFFICIENTS = ("k1", "k2", "p1", "p2", "k3", "k4", "sx1", "sy1")


@register
class ThinPrismFisheye(RadialLens):
    """The point at the radius θ, moved by radial, tangential and thin-prism terms of that plane.

    With k1 k2 k3 k4 alone it is `kannala-brandt`. The domain is a cone about the axis, which ends in
    the direction that folds first; the terms go on past 90°, where COLMAP stops.
    """

    name = "thin-prism-fisheye"
    parameters = (*FOCAL_PARAMETERS, *COEFFICIENTS)

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        radius = _monotone_radius(*(getattr(p, name) for name in COEFFICIENTS))
        edge = edge_of_disk(distorted, p, radius)
        return {**edge, "max_theta": edge["max_radius"]}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return theta

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return radius

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b, ok = super().to_plane(c, x, y, z, xp)
        return *distorted(c, a, b, xp), ok

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = invert_in_disk(distorted, c, mx, my, c.max_radius, c.reach, xp)
        x, y, z, _ = super().from_plane(c, a, b, xp)
        return x, y, z, ok


def distorted(c: Any, a: Any, b: Any, xp: Formulas) -> tuple[Any, Any]:
    """Where the lens puts the point (a, b) of the equidistant plane."""
    q = a * a + b * b
    radial = 1.0 + q * (c.k1 + q * (c.k2 + q * (c.k3 + q * c.k4)))
    ab = 2.0 * a * b
    return (
        a * radial + c.p1 * ab + c.p2 * (q + 2.0 * a * a) + c.sx1 * q,
        b * radial + c.p1 * (q + 2.0 * b * b) + c.p2 * ab + c.sy1 * q,
    )


@lru_cache
def _monotone_radius(*coefficients: float) -> float:
    c = SimpleNamespace(**dict(zip(COEFFICIENTS, coefficients, strict=True)))
    stretch = Polynomial([1.0, c.k1, c.k2, c.k3, c.k4])  # r/θ as a polynomial in θ²
    slope = stretch + 2.0 * Polynomial([0.0, 1.0]) * stretch.deriv()
    radius = min(math.pi, math.sqrt(first_root(slope - LEAST_SLOPE)))
    if not any((c.p1, c.p2, c.sx1, c.sy1)):
        return radius
    return monotone_radius(distorted, c, radius)
