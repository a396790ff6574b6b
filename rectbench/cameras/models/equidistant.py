"""Equidistant lens: r = θ, the same number of pixels for each degree from the axis."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.protocol import Formulas


@register
class Equidistant(RadialLens):
    """r(θ) = θ up to the ray straight back."""

    name = "equidistant"
    parameters = FOCAL_PARAMETERS

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return {"max_theta": math.pi, "max_radius": math.pi}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return theta

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return radius
