"""Mei & Rives 2007, the unified model with distortion: OpenCV's `omnidir`, Kalibr's `omni`."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras.brown import COEFFICIENTS, distorted, edge, undistorted
from rectbench.cameras.lens import FOCAL_PARAMETERS, Interval, Lens, register
from rectbench.cameras.sphere import distance
from rectbench.formulas.domain import LEAST_SLOPE, RAY_SLACK
from rectbench.formulas.protocol import Formulas


@register
class Unified(Lens):
    """The unit sphere seen from ξ behind its centre, then distorted.

    With ξ ≤ 1 it sees up to cos θ = -ξ, where the image is at infinity; with ξ > 1 up to
    cos θ = -1/ξ, where the line of sight touches the sphere.
    """

    name = "unified"
    parameters = (*FOCAL_PARAMETERS, "xi", "k1", "k2", "p1", "p2", "skew")
    ranges: ClassVar = {**Lens.ranges, "xi": Interval(low=-1.0, low_open=True)}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        brown = SimpleNamespace(**{name: getattr(p, name, 0.0) for name in COEFFICIENTS})
        if p.xi <= 1:
            return {**vars(brown), **edge(brown), "least_cosine": -1.0}

        def slope(radius: float) -> float:
            return math.sqrt(max(0.0, 1 - (p.xi**2 - 1) * radius**2))

        touching = math.sqrt((1 - LEAST_SLOPE**2) / (p.xi**2 - 1))
        cosine = (p.xi + LEAST_SLOPE) / (1 + touching**2) - p.xi
        return {**vars(brown), **edge(brown, touching, slope), "least_cosine": cosine}

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        length, beyond = distance(z, x * x + y * y, xp)
        depth = c.xi * beyond + (1.0 - c.xi) * z
        a, b = x / depth, y / depth
        seen = (depth > 0.0) & (z >= (c.least_cosine - RAY_SLACK) * length)
        return *distorted(c, a, b, xp), seen & (xp.hypot(a, b) <= c.max_radius)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = undistorted(c, mx, my, xp)
        q = a * a + b * b
        scale = (c.xi + xp.sqrt(1.0 + (1.0 - c.xi * c.xi) * q)) / (1.0 + q)
        return scale * a, scale * b, scale - c.xi, ok
