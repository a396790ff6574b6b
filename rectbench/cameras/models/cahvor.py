"""Yakimovsky & Cunningham 1978 and Gennery 2001, CAHVOR, with the parameters mrcal gives it.

The distortion is radial about an optical axis o that need not be the sensor's normal z:
o = (sin α cos β, sin β, cos α cos β). A ray p = ω (o + w), with w perpendicular to o, is bent to
o + (1 + r0 + r1 |w|² + r2 |w|⁴) w, and from there projected as by a pinhole.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras import brown
from rectbench.cameras.lens import FOCAL_PARAMETERS, Interval, Lens, register
from rectbench.formulas.domain import FARTHEST, PIXEL_SLACK
from rectbench.formulas.protocol import Formulas

TILT = Interval(-0.5 * math.pi, 0.5 * math.pi, low_open=True, high_open=True)


@register
class Cahvor(Lens):
    """Valid while the bent radius rises, up to 89.94° from o before and after, and then from z.

    From there to 90° the pixel loses its digits to the tilt between the two axes.
    """

    name = "cahvor"
    parameters = (*FOCAL_PARAMETERS, "alpha", "beta", "r0", "r1", "r2")
    ranges: ClassVar = {**Lens.ranges, "alpha": TILT, "beta": TILT, "r0": Interval(low=-1.0, low_open=True)}

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        sin_a, cos_a, sin_b, cos_b = math.sin(p.alpha), math.cos(p.alpha), math.sin(p.beta), math.cos(p.beta)
        scale = 1.0 + p.r0
        radial = dict.fromkeys(brown.COEFFICIENTS, 0.0) | {"k1": p.r1 / scale, "k2": p.r2 / scale}
        return {
            "right": (cos_a, 0.0, -sin_a),
            "down": (-sin_a * sin_b, cos_b, -cos_a * sin_b),
            "axis": (sin_a * cos_b, sin_b, cos_a * cos_b),
            "scale": scale,
            "radial": radial | brown.edge(SimpleNamespace(**radial), FARTHEST),
        }

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b, depth = _about_axis(c, x, y, z)
        a, b = a / depth, b / depth
        seen = (depth > 0.0) & (xp.hypot(a, b) <= c.radial.max_radius)
        a, b = brown.distorted(c.radial, a, b, xp)
        a, b = c.scale * a, c.scale * b
        x, y, z = _about_sensor(c, a, b)
        return x / z, y / z, seen & (xp.hypot(a, b) <= FARTHEST) & (xp.hypot(x, y) <= FARTHEST * z)

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b, depth = _about_axis(c, mx, my, 1.0)
        a, b = a / depth, b / depth
        far = xp.maximum(xp.hypot(mx, my), xp.hypot(a, b))
        seen = (depth > 0.0) & (far <= FARTHEST * (1.0 + PIXEL_SLACK))
        a, b, ok = brown.undistorted(c.radial, a / c.scale, b / c.scale, xp)
        x, y, z = _about_sensor(c, a, b)
        length = xp.hypot(xp.hypot(a, b), 1.0)
        return x / length, y / length, z / length, seen & ok


def _about_axis(c: Any, x: Any, y: Any, z: Any) -> tuple[Any, ...]:
    """The sensor's (x, y, z) to the right of the optical axis, below it, and along it."""
    return tuple(e[0] * x + e[1] * y + e[2] * z for e in (c.right, c.down, c.axis))


def _about_sensor(c: Any, a: Any, b: Any) -> tuple[Any, ...]:
    """The point a to the right of the optical axis, b below and 1 along it, in the sensor's axes."""
    return tuple(a * c.right[i] + b * c.down[i] + c.axis[i] for i in range(3))
