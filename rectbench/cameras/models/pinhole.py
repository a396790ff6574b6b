"""Pinhole with the distortion of Brown and Conrady: OpenCV's `calib3d`, without the tilted sensor."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from rectbench.cameras.brown import COEFFICIENTS, distorted, edge, undistorted
from rectbench.cameras.lens import FOCAL_PARAMETERS, Lens, register
from rectbench.formulas.protocol import Formulas


@register
class Pinhole(Lens):
    """(x, y)/z, distorted; valid in front of the camera, while the distortion is monotone."""

    name = "pinhole"
    parameters = (*FOCAL_PARAMETERS, *COEFFICIENTS)

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        return dict(edge(p))

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b = x / z, y / z
        return *distorted(c, a, b, xp), (z > 0.0) & (xp.hypot(a, b) <= c.max_radius)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, ok = undistorted(c, mx, my, xp)
        scale = 1.0 / xp.hypot(xp.hypot(a, b), 1.0)
        return scale * a, scale * b, scale, ok
