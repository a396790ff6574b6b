"""Equisolid lens: r = 2 sin(θ/2), equal areas for equal solid angles."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.domain import LEAST_SLOPE
from rectbench.formulas.protocol import Formulas


@register
class Equisolid(RadialLens):
    """r(θ) = 2 sin(θ/2), up to the ray straight back, where the slope vanishes."""

    name = "equisolid"
    parameters = FOCAL_PARAMETERS

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        max_theta = math.pi - 2.0 * LEAST_SLOPE
        return {"max_theta": max_theta, "max_radius": 2.0 * math.sin(0.5 * max_theta)}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return 2.0 * xp.sin(0.5 * theta)

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return 2.0 * xp.atan2(radius, xp.sqrt((2.0 - radius) * (2.0 + radius)))
