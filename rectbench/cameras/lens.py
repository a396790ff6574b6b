"""The base of the projection models: from rays to the lens plane, and from there to pixels."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

from rectbench.errors import UnknownName
from rectbench.formulas.domain import PIXEL_SLACK, RAY_SLACK
from rectbench.formulas.protocol import Formulas

FOCAL_PARAMETERS = ("fx", "fy", "cx", "cy")
AXIS_SINE = 1e-12
"""Nearer to the axis than this (sine of the angle), radius and angle keep the ratio they have here."""


@dataclass(frozen=True)
class Interval:
    """The numbers that a parameter may take; an open end is left out."""

    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False

    def __contains__(self, number: float) -> bool:
        above = self.low < number if self.low_open else self.low <= number
        below = number < self.high if self.high_open else number <= self.high
        return above and below

    def __str__(self) -> str:
        low = "(" if self.low_open or math.isinf(self.low) else "["
        high = ")" if self.high_open or math.isinf(self.high) else "]"
        return f"{low}{self.low:g}, {self.high:g}{high}"


POSITIVE = Interval(low=0.0, low_open=True)


class Lens(ABC):
    """One projection model: stateless formulas; the camera holds the numbers.

    Rays go to a point (mx, my) of the lens plane and from there to pixels by u = fx mx + skew my + cx,
    v = fy my + cy, where most models have no `skew`; a subclass states the first step and its
    inverse. `derive` computes, once a camera, what the formulas need beyond the parameters, foremost
    the edge of the valid domain.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[str, ...]]
    ranges: ClassVar[Mapping[str, Interval]] = {"fx": POSITIVE, "fy": POSITIVE}
    defaults: ClassVar[Mapping[str, float]] = {}
    vectors: ClassVar[frozenset[str]] = frozenset()

    def derive(self, p: SimpleNamespace) -> dict[str, Any]:
        """Constants computed from the parameters; raises InvalidInput where these make no lens."""
        return {}

    @abstractmethod
    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        """Lens plane point (mx, my) of a ray of any length, and whether the ray is in the domain."""

    @abstractmethod
    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """Unit ray of the lens plane point, and whether the point is in the domain."""

    def to_pixel(self, c: Any, mx: Any, my: Any) -> tuple[Any, Any]:
        """Pixel (u, v) of the lens plane point (mx, my)."""
        u = c.fx * mx + c.cx
        return (u + c.skew * my if "skew" in self.parameters else u), c.fy * my + c.cy

    def from_pixel(self, c: Any, u: Any, v: Any) -> tuple[Any, Any]:
        """Lens plane point (mx, my) of the pixel (u, v)."""
        my = (v - c.cy) / c.fy
        u = u - c.cx
        return (u - c.skew * my if "skew" in self.parameters else u) / c.fx, my

    def project(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        """Pixel (u, v) of the ray (x, y, z) of any length; whether the ray is in the domain."""
        mx, my, ok = self.to_plane(c, x, y, z, xp)
        return *self.to_pixel(c, mx, my), ok

    def unproject(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """Unit ray (x, y, z) of the pixel (u, v); whether the pixel is in the domain."""
        return self.from_plane(c, *self.from_pixel(c, u, v), xp)

    def scaled(self, params: Mapping[str, Any], sx: float, sy: float) -> dict[str, Any]:
        """The parameters of the same lens on an image sx times as wide and sy times as high."""
        return {
            **params,
            **({"skew": params["skew"] * sx} if "skew" in params else {}),
            "fx": params["fx"] * sx,
            "fy": params["fy"] * sy,
            "cx": (params["cx"] + 0.5) * sx - 0.5,
            "cy": (params["cy"] + 0.5) * sy - 0.5,
        }


class RadialLens(Lens):
    """A lens symmetric about its axis: the radius on the plane is a function of the angle θ.

    `derive` must give `max_theta` and `max_radius`, the edge up to which the radius rises with θ.
    """

    @abstractmethod
    def radius(self, c: Any, theta: Any, xp: Formulas) -> Any:
        """Radius on the lens plane of the angle theta from the axis, radians."""

    @abstractmethod
    def angle(self, c: Any, radius: Any, xp: Formulas) -> Any:
        """Angle from the axis, radians, of a radius on the lens plane up to `max_radius`."""

    def to_plane(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        # Only in front: straight back the lens has no one image, and 0/0 says so.
        off_axis = xp.maximum(xp.hypot(x, y), AXIS_SINE * z)
        theta = xp.atan2(off_axis, z)
        scale = self.radius(c, theta, xp) / off_axis
        return scale * x, scale * y, theta <= c.max_theta + RAY_SLACK

    def from_plane(self, c: Any, mx: Any, my: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        radius = xp.maximum(xp.hypot(mx, my), AXIS_SINE)
        theta = self.angle(c, xp.minimum(radius, c.max_radius), xp)
        scale = xp.sin(theta) / radius
        return scale * mx, scale * my, xp.cos(theta), radius <= c.max_radius * (1.0 + PIXEL_SLACK)


LENSES: dict[str, Lens] = {}


def register(cls: type[Lens]) -> type[Lens]:
    """Make a projection model available under its name."""
    LENSES[cls.name] = cls()
    return cls


def lens_named(name: str) -> Lens:
    """The projection model of that name."""
    if name not in LENSES:
        raise UnknownName("projection model", str(name), LENSES)
    return LENSES[name]
