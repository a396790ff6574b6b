"""Orthographic lens: r = sin θ, the hemisphere pressed flat."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.domain import LEAST_SLOPE
from rectbench.formulas.protocol import Formulas


@register
class Orthographic(RadialLens):
    """r(θ) = sin θ, up to 90°, where the slope vanishes."""

    name = "orthographic"
    parameters = FOCAL_PARAMETERS

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        max_theta = 0.5 * math.pi - LEAST_SLOPE
        return {"max_theta": max_theta, "max_radius": math.sin(max_theta)}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return xp.sin(theta)

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return xp.atan2(radius, xp.sqrt((1.0 - radius) * (1.0 + radius)))
