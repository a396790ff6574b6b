"""The part of a lens's view that is left out of account: two cones about one line through its centre."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.types import Constants, FloatArray

UNIT_TOLERANCE = 1e-12
"""A direction whose length is this near to 1 is kept to the last bit."""
RINGS, RING_RAYS = 8, 128
"""Rays by which it is told whether a view reaches into the cones: rings about the axis, each of so many."""


@dataclass(frozen=True)
class Cones:
    """All directions nearer than an angle to a line: to its direction, or to the opposite one.

    Parameters
    ----------
    axis : direction of the line in the camera's frame, of any length but 0; held as a unit vector.
    within_deg : the cones' half angle, degrees.

    Raises InvalidInput for a direction that is none, and for an angle outside (0, 90).

    >>> Cones(axis=(2.0, 0.0, 0.0), within_deg=7.0)
    Cones(axis=(1.0, 0.0, 0.0), within_deg=7.0)
    """

    axis: tuple[float, float, float]
    within_deg: float

    def __post_init__(self) -> None:
        try:
            axis = np.array(self.axis, dtype=np.float64)
        except (TypeError, ValueError):
            axis = np.full(3, math.nan)
        length = float(np.linalg.norm(axis)) if axis.shape == (3,) else math.nan
        if not 0 < length < math.inf:
            raise InvalidInput(f"the axis of the cones is {self.axis!r}; expected three numbers, not all 0")
        if abs(length - 1) > UNIT_TOLERANCE:
            axis = axis / length
        within = self.within_deg
        if isinstance(within, bool) or not isinstance(within, int | float | np.number) or not 0 < within < 90:
            raise InvalidInput(f"the cones' within_deg is {within!r}; expected degrees between 0 and 90")
        object.__setattr__(self, "axis", tuple(axis.tolist()))
        object.__setattr__(self, "within_deg", float(within))

    @property
    def constants(self) -> Constants:
        """The numbers of `holds`: the axis, and the squared cosine of the angle."""
        return {"axis": self.axis, "square": math.cos(math.radians(self.within_deg)) ** 2}

    def directions(self, off_rad: FloatArray, turn_rad: FloatArray) -> FloatArray:
        """Unit rays [..., 3] at angles from the axis, and so far about it, radians."""
        x = np.array(self.axis)
        y = np.cross(x, np.eye(3)[np.abs(x).argmin()])
        y /= np.linalg.norm(y)
        off, turn = off_rad[..., None], turn_rad[..., None]
        about = np.cos(turn) * y + np.sin(turn) * np.cross(x, y)
        rays: FloatArray = np.cos(off) * x + np.sin(off) * about
        return rays

    def rim(self, turn_rad: FloatArray) -> FloatArray:
        """Unit rays [..., 3] where the cone about the axis ends, so far about it, radians."""
        return self.directions(np.array(math.radians(self.within_deg)), turn_rad)

    def rays(self) -> FloatArray:
        """Unit rays [N, 3] all over both cones, their axis and their rims among them."""
        off = np.linspace(0.0, math.radians(self.within_deg), RINGS + 1)
        turn = 2 * np.pi * np.arange(RING_RAYS) / RING_RAYS
        rays = self.directions(off[:, None], turn).reshape(-1, 3)
        return np.concatenate([rays, -rays])

    def hold(self, rays: FloatArray) -> Any:
        """Mask [...] of the unit rays [..., 3] that lie in the cones."""
        return np.abs(rays @ np.array(self.axis)) > math.cos(math.radians(self.within_deg))


def outside(c: Any, x: Any, y: Any, z: Any, slack: float) -> Any:
    """Whether the ray (x, y, z) of any length lies outside the cones of these constants, for formulas."""
    a, b, d = c.axis
    along = a * x + b * y + d * z
    return along * along <= (c.square + slack) * (x * x + y * y + z * z)
