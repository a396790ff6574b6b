"""NVIDIA's f-theta lens whose reference is the angle as a polynomial in the distance from the centre.

DriveWorks' `bw-poly`, Isaac Sim's `fthetaPolyA` and so on, NuRec's and NCore's `PIXELDIST_TO_ANGLE`, and
instant-ngp's `ftheta_p0` and so on. The other way about, the distance as a polynomial in the angle, is `ocam`
by its `inverse_poly`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

from numpy.polynomial import Polynomial

from rectbench.cameras.lens import register
from rectbench.cameras.models.in_pixels.ocam import horner
from rectbench.cameras.models.in_pixels.stretched import AFFINE_PARAMETERS, StretchedLens
from rectbench.errors import InvalidInput
from rectbench.formulas.domain import first_root
from rectbench.formulas.inversion import inverse
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas

LAST_SLOPE = 1e-4
"""Slope of θ over ρ, to that on the axis, at which a lens ends whose angle turns back: 1e-8 rad before."""


@register
class FTheta(StretchedLens):
    """θ = a1 ρ + a2 ρ² + ..., ρ in pixels on the sensor (x', y'), `angle_poly` being [a1, a2, ...].

    The sensor's stretch follows, as in `ocam`: u = x' + e y' + cx, v = d x' + c y' + cy. The lens ends where
    θ stops rising, or at 180°. Projecting inverts the polynomial exactly.
    """

    name = "f-theta"
    parameters: ClassVar = (*AFFINE_PARAMETERS, "angle_poly")
    vectors = frozenset({"angle_poly"})

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        if not (p.angle_poly and p.angle_poly[0] > 0):
            first = f"a1 = {p.angle_poly[0]:g}" if p.angle_poly else "no angle_poly"
            raise InvalidInput(f"f-theta has {first}; expected its coefficients a1 > 0, a2, ...")
        angle = Polynomial([0.0, *p.angle_poly])
        radii = (first_root(angle.deriv() - LAST_SLOPE * p.angle_poly[0]), first_root(angle - math.pi))
        max_radius = min(radii)
        return {
            "determinant": self.determinant(p),
            "max_theta": min(math.pi, float(self.angle(p, max_radius, NUMPY))),
            "max_radius": float(max_radius),
        }

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return radius * horner(c.angle_poly, radius)

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        start = theta / c.angle_poly[0]
        return inverse(self.angle, c, theta, c.max_radius, c.max_theta, start, xp)

    def scaled(self, params: Mapping[str, Any], sx: float, sy: float) -> dict[str, Any]:
        shrunk = tuple(a / sx**power for power, a in enumerate(params["angle_poly"], 1))
        return {**super().scaled(params, sx, sy), "angle_poly": shrunk}
