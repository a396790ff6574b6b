"""Meta's Fisheye624 of Project Aria: COLMAP's `RAD_TAN_THIN_PRISM_FISHEYE`.

https://facebookresearch.github.io/projectaria_tools/docs/tech_insights/camera_intrinsic_models
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from numpy.polynomial import Polynomial

from rectbench.cameras import brown
from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.domain import LEAST_SLOPE, first_root
from rectbench.formulas.inversion import inverse
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas

RADIAL = ("k0", "k1", "k2", "k3", "k4", "k5")
PRISM = {"p1": "p1", "p2": "p0", "s1": "s0", "s2": "s1", "s3": "s2", "s4": "s3"}
"""Brown's tangential and thin-prism coefficients by their names here."""


@register
class Fisheye624(RadialLens):
    """r(θ) = θ + k0 θ³ + ... + k5 θ¹³, then tangential and thin-prism terms of the point at that radius.

    Unlike `thin-prism-fisheye`, whose terms all see the undistorted point, the second step sees the
    first one's: each is inverted by itself. With k0 ... k3 alone it is `kannala-brandt`. The terms
    go on past 90°, where COLMAP stops.
    """

    name = "fisheye624"
    parameters = (*FOCAL_PARAMETERS, *RADIAL, "p0", "p1", "s0", "s1", "s2", "s3")

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        stretch = Polynomial([1.0, *(getattr(p, name) for name in RADIAL)])  # r/θ as a polynomial in θ²
        slope = stretch + 2.0 * Polynomial([0.0, 1.0]) * stretch.deriv()
        max_theta = min(math.pi, math.sqrt(first_root(slope - LEAST_SLOPE)))
        max_radius = self.radius(p, max_theta, NUMPY)
        c = SimpleNamespace(**vars(p), max_theta=max_theta, max_radius=max_radius)

        def slope_before(radius: float) -> float:
            return float(slope(float(self.angle(c, radius, NUMPY)) ** 2))

        own = dict.fromkeys(brown.COEFFICIENTS, 0.0) | {name: getattr(p, PRISM[name]) for name in PRISM}
        prism = own | brown.edge(SimpleNamespace(**own), max_radius, slope_before)
        if prism["max_radius"] < max_radius:
            max_radius = prism["max_radius"]
            max_theta = float(self.angle(c, max_radius, NUMPY))
        return {"prism": prism, "max_theta": max_theta, "max_radius": max_radius}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        q = theta * theta
        return theta * (1.0 + q * (c.k0 + q * (c.k1 + q * (c.k2 + q * (c.k3 + q * (c.k4 + q * c.k5))))))

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        start = radius * (c.max_theta / c.max_radius)
        return inverse(self.radius, c, radius, c.max_theta, c.max_radius, start, xp)

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b, ok = super().to_plane(c, x, y, z, xp)
        return *brown.distorted(c.prism, a, b, xp), ok

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = brown.undistorted(c.prism, mx, my, xp)
        x, y, z, _ = super().from_plane(c, a, b, xp)
        return x, y, z, ok
