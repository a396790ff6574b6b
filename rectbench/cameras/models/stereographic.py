"""Stereographic lens: r = 2 tan(θ/2), which keeps small shapes."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.protocol import Formulas


@register
class Stereographic(RadialLens):
    """r(θ) = 2 tan(θ/2); the ray straight back is at infinity."""

    name = "stereographic"
    parameters = FOCAL_PARAMETERS

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return {"max_theta": math.pi, "max_radius": math.inf}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return 2.0 * xp.sin(0.5 * theta) / xp.cos(0.5 * theta)

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return 2.0 * xp.atan2(radius, 0.0 * radius + 2.0)
