"""Fitzgibbon 2001, the division model with one coefficient: COLMAP's `DIVISION`, carried past 90°."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from rectbench.cameras.lens import FOCAL_PARAMETERS, RadialLens, register
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas

LAST_SLOPE = 1e-4
"""Slope of θ over r, to that on the axis, at which a lens with k > 0 ends, 1e-8 rad before the fold."""
FARTHEST = 1e6
"""Focal lengths from the axis at which a lens with a k of next to nothing ends, 1e-6 rad before 90°."""
LEAST_NEGATIVE = -1e-6
"""Nearer to 0 than this the image behind the lens lies over 1000 focal lengths away."""


@register
class Division(RadialLens):
    """The ray of the point at the radius r is (r, 1 + k r²) in the plane of the axis.

    With k < 0 it goes on to the ray straight back, at infinity; k = -1/4 is `stereographic`. With
    k > 0 it ends at r = 1/sqrt(k), where θ stops rising, and with k = 0 it is the pinhole.
    """

    name = "division"
    parameters = (*FOCAL_PARAMETERS, "k")

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        if p.k < LEAST_NEGATIVE:
            return {"max_theta": math.pi, "max_radius": math.inf}
        if p.k <= 0:
            return {"max_theta": 0.5 * math.pi - 1e-9, "max_radius": math.inf}
        radius = min(math.sqrt((1.0 - LAST_SLOPE) / p.k), FARTHEST)
        return {"max_theta": float(self.angle(p, radius, NUMPY)), "max_radius": radius}

    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        sine, cosine = xp.sin(theta), xp.cos(theta)
        root = xp.sqrt(xp.maximum(cosine * cosine - 4.0 * c.k * sine * sine, 0.0))
        # Of two equal forms, the one whose sum does not cancel.
        behind = (root - cosine) / (-2.0 * c.k * sine)
        radius = xp.where(cosine < 0.0, behind, 2.0 * sine / (cosine + root))
        return xp.minimum(radius, c.max_radius)  # at that end a last digit of θ is worth many of r

    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        return xp.atan2(radius, 1.0 + c.k * (radius * radius))
