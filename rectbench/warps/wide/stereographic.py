"""The sphere seen from the point opposite to the image's middle: circles stay circles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.targets import Target

LEAST_REACH = 1e-6
"""1 + cos θ of the last ray that is shown, 0.08° from straight back."""


@dataclass(frozen=True)
class Stereographic(Target):
    """û = cx + 2 f x / (1 + z), v̂ = cy + 2 f y / (1 + z) of unit rays: conformal, about the z axis.

    >>> import rectbench as rb
    >>> rb.Stereographic(100.0, 0.0, 0.0).project([1.0, 0.0, 0.0])[0]
    array([200.,   0.])
    """

    focal_px: float
    cx: float
    cy: float

    @property
    def constants(self) -> Constants:
        return {"focal": self.focal_px, "cx": self.cx, "cy": self.cy}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        length = xp.sqrt(x * x + y * y + z * z)
        scale = 2.0 * c.focal / (length + z)
        return c.cx + scale * x, c.cy + scale * y, length + z > LEAST_REACH * length

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        a, b = (u - c.cx) / (2.0 * c.focal), (v - c.cy) / (2.0 * c.focal)
        reach = 2.0 / (1.0 + a * a + b * b)  # 1 + z
        return reach * a, reach * b, reach - 1.0, reach > LEAST_REACH


@dataclass(frozen=True)
class EpipolarCircles(Stereographic):
    """A stereographic image that is searched along its epipolar curves, circles through two points, not rows.

    Both images of a pair have the same circles where they share this target (Heller and Pajdla 2009).

    >>> import rectbench as rb
    >>> circles = rb.EpipolarCircles(100.0, 0.0, 0.0, (1.0, 0.0, 0.0))
    >>> circles.curve_normals([[0.0, 50.0], [40.0, 0.0], [-40.0, 50.0]]).round(2) + 0.0
    array([[ 0. ,  1. ],
           [ 0. ,  1. ],
           [-0.1,  1. ]])
    """

    baseline: tuple[float, float, float]
    """The baseline's direction in the frame that the image is made in."""

    def __post_init__(self) -> None:
        if len(self.baseline) != 3 or not any(self.baseline):
            raise InvalidInput(f"baseline is {self.baseline!r}; expected a direction, three numbers")

    def curve_normals(self, px: FloatArray) -> FloatArray:
        """Unit normals [..., 2] of the circles through pixels [..., 2], towards rising β."""
        rays, _ = self.unproject(px)
        planes = np.cross(rays, self.baseline)
        normals = np.einsum("...i,...ij->...j", planes, self.unproject_jacobian(px))
        with np.errstate(invalid="ignore"):
            unit: FloatArray = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
        return unit
