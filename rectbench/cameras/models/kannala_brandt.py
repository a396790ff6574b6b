"""Kannala & Brandt 2006, the symmetric part with four coefficients: OpenCV's `fisheye`, Kalibr's `equi`."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from numpy.polynomial import Polynomial

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.domain import LEAST_SLOPE, first_root
from rectbench.formulas.inversion import inverse
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas


@register
class KannalaBrandt(RadialLens):
    """r(θ) = θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹, valid while r rises."""

    name = "kannala-brandt"
    parameters = (*FOCAL_PARAMETERS, "k1", "k2", "k3", "k4", "skew")

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        stretch = Polynomial([1.0, p.k1, p.k2, p.k3, p.k4])  # r/θ as a polynomial in θ²
        slope = stretch + 2.0 * Polynomial([0.0, 1.0]) * stretch.deriv()
        max_theta = min(math.pi, math.sqrt(first_root(slope - LEAST_SLOPE * stretch)))
        return {"max_theta": max_theta, "max_radius": self.radius(p, max_theta, NUMPY)}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        q = theta * theta
        return theta * (1.0 + q * (c.k1 + q * (c.k2 + q * (c.k3 + q * c.k4))))

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        start = radius * (c.max_theta / c.max_radius)
        return inverse(self.radius, c, radius, c.max_theta, c.max_radius, start, xp)
