"""Devernay & Faugeras 2001, the field-of-view (arctangent) model, carried past 90°."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras.lens import FOCAL_PARAMETERS, Interval, Lens, RadialLens, register
from rectbench.formulas.protocol import Formulas

LEAST_OMEGA = 1e-12
"""Stands for ω = 0, the pinhole: the two differ by 1e-24 tan²θ."""
LEAST_WIDE_OMEGA = 1e-4
"""Below this the image behind the lens lies π/ω away, too far for the digits of a pixel coordinate."""


@register
class FieldOfView(RadialLens):
    """r(θ) = atan(2 tan(ω/2) tan θ) / ω; by atan2 it goes on to 180°."""

    name = "field-of-view"
    parameters = (*FOCAL_PARAMETERS, "omega")
    ranges: ClassVar = {**Lens.ranges, "omega": Interval(0.0, math.pi, high_open=True)}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        view = max(p.omega, LEAST_OMEGA)
        constants = {"view": view, "chord": 2.0 * math.tan(0.5 * view)}
        if view < LEAST_WIDE_OMEGA:
            return {**constants, "max_theta": 0.5 * math.pi - 1e-9, "max_radius": 0.5 * math.pi / view}
        return {**constants, "max_theta": math.pi, "max_radius": math.pi / view}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        return xp.atan2(c.chord * xp.sin(theta), xp.cos(theta)) / c.view

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        seen = radius * c.view
        return xp.atan2(xp.sin(seen), c.chord * xp.cos(seen))
