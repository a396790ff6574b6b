"""Scaramuzza, Martinelli & Siegwart 2006, the omnidirectional model of OCamCalib and MATLAB."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, ClassVar

from numpy.polynomial import Polynomial

from rectbench.cameras.lens import register
from rectbench.cameras.models.in_pixels.stretched import AFFINE_PARAMETERS, StretchedLens
from rectbench.errors import InvalidInput
from rectbench.formulas.domain import LEAST_SLOPE, first_root
from rectbench.formulas.inversion import inverse
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas

FARTHEST_RADIUS = 1e3
"""Where a lens that never folds ends, in units of a0: within a fraction of a degree of straight back."""
ANGLE = RADIUS = Polynomial([0.0, 1.0])
LARGEST_HOLE = 0.01
"""The most, in radians, by which `inverse_poly` may miss the centre of the image."""


@register
class OCam(StretchedLens):
    """The ray of a point (x', y') at the radius ρ on the sensor is (x', y', z) with |z| = a0 + a1 ρ + ...

    The sensor's own stretch and skew follow: u = x' + e y' + cx, v = d x' + c y' + cy, pixels.
    These are OCamCalib's letters; its centre is (row, column) = (cy, cx) and its axes are
    (x, y, z) = (y', x', -z). A `c` that is left out is 1. The sign of a0 only says which way the
    source's z points: OCamCalib's is negative, MATLAB's positive.

    `poly` [a0, a1, ...] is the model, and projecting inverts it exactly. Where `inverse_poly`
    alone is given it is the model: ρ = b0 + b1 t + b2 t² + ... with t = θ - π/2. Such a fit misses
    ρ = 0 on the axis by a fraction of a pixel, which is faded out within some 0.01° of the axis.
    """

    name = "ocam"
    parameters: ClassVar = (*AFFINE_PARAMETERS, "poly", "inverse_poly")
    vectors = frozenset({"poly", "inverse_poly"})

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        determinant = self.determinant(p)
        if p.poly:
            return {"determinant": determinant, **_from_polynomial(p.poly)}
        if p.inverse_poly:
            return {"determinant": determinant, **_from_inverse_polynomial(p.inverse_poly)}
        raise InvalidInput("ocam lacks poly and inverse_poly; expected the coefficients of one of them")

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        if c.depth:
            return inverse(self.angle, c, theta, c.max_radius, c.max_theta, theta * c.depth[0], xp)
        near = xp.minimum(theta * c.fading, 1.0)
        return theta * horner(c.slopes, theta) + c.hole * near * (2.0 - near)

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        if c.depth:
            return xp.atan2(radius, horner(c.depth, radius))
        start = radius * (c.max_theta / c.max_radius)
        return inverse(self.radius, c, radius, c.max_theta, c.max_radius, start, xp)

    def scaled(self, params: Mapping[str, Any], sx: float, sy: float) -> dict[str, Any]:
        return {
            **super().scaled(params, sx, sy),
            "poly": tuple(a * sx ** (1 - i) for i, a in enumerate(params["poly"])),
            "inverse_poly": tuple(b * sx for b in params["inverse_poly"]),
        }


def horner(coefficients: Sequence[Any], x: Any) -> Any:
    """The polynomial with these coefficients, the constant term first, at x."""
    total = 0.0 * x + coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        total = total * x + coefficient
    return total


def _from_polynomial(poly: tuple[float, ...]) -> dict[str, Any]:
    """z as a polynomial in ρ, up to where θ = atan2(ρ, z) stops rising: z - ρ z' = 0."""
    if poly[0] == 0:
        raise InvalidInput("ocam has a0 = 0 in poly; expected the depth of the image centre, not 0")
    depth = Polynomial(poly) * math.copysign(1.0, poly[0])
    slope = depth - RADIUS * depth.deriv()
    max_radius = min(first_root(slope - LEAST_SLOPE * depth(0.0)), FARTHEST_RADIUS * depth(0.0))
    return {
        "depth": tuple(map(float, depth.coef)),
        "max_theta": math.atan2(max_radius, depth(max_radius)),
        "max_radius": float(max_radius),
    }


def _from_inverse_polynomial(inverse_poly: tuple[float, ...]) -> dict[str, Any]:
    """ρ as a polynomial in θ, developed about the axis so that it keeps its digits there."""
    radius = Polynomial(inverse_poly)(ANGLE - 0.5 * math.pi)
    hole, slope = float(radius(0.0)), float(radius.deriv()(0.0))
    if not slope > 0 or abs(hole) > LARGEST_HOLE * slope:
        raise InvalidInput(
            f"ocam has an inverse_poly of {hole:g} px at the axis, rising by {slope:g} px/rad; "
            "expected about 0 px, rising"
        )
    max_theta = min(math.pi, first_root(radius.deriv() - LEAST_SLOPE * slope))
    constants = {
        "depth": (),
        "slopes": tuple(map(float, radius.coef[1:])),
        "hole": hole,
        "fading": 0.05 * slope / abs(hole) if hole else 0.0,
        "max_theta": max_theta,
    }
    return {**constants, "max_radius": OCam().radius(SimpleNamespace(**constants), max_theta, NUMPY)}
