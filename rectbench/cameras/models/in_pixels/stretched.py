"""A radial lens in pixels from its centre, on a sensor whose pixels are no squares: OCamCalib's, NVIDIA's."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.cameras.lens import RadialLens
from rectbench.errors import InvalidInput

AFFINE_PARAMETERS = ("cx", "cy", "c", "d", "e")


class StretchedLens(RadialLens):
    """The plane is the sensor: u = x' + e y' + cx, v = d x' + c y' + cy, pixels. A `c` left out is 1."""

    ranges: ClassVar = {}
    defaults: ClassVar = {"c": 1.0}

    def determinant(self, p: SimpleNamespace) -> float:
        """Of the stretch [1 e; d c]; raises InvalidInput where it turns the image over."""
        determinant = p.c - p.d * p.e
        if not determinant > 0:
            raise InvalidInput(f"{self.name} has c - d e = {determinant:g}; expected a number in (0, inf)")
        return float(determinant)

    def to_pixel(self, c: Any, mx: Any, my: Any) -> tuple[Any, Any]:
        return mx + c.e * my + c.cx, c.d * mx + c.c * my + c.cy

    def from_pixel(self, c: Any, u: Any, v: Any) -> tuple[Any, Any]:
        u, v = u - c.cx, v - c.cy
        return (c.c * u - c.e * v) / c.determinant, (v - c.d * u) / c.determinant

    def scaled(self, params: Mapping[str, Any], sx: float, sy: float) -> dict[str, Any]:
        """The parameters on an image sx times as wide and sy times as high, but for those of the radius."""
        return {
            **params,
            "cx": (params["cx"] + 0.5) * sx - 0.5,
            "cy": (params["cy"] + 0.5) * sy - 0.5,
            "c": params["c"] * sy / sx,
            "d": params["d"] * sy / sx,
        }
