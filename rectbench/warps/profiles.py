"""Profiles: rising functions from an angle of the rectified frame to a column or row."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.inversion import invert_monotone
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray

ANGLE_SLACK_RAD = 1e-9
"""Rays this little beyond a profile's range still count as in it (rounding at the image's corner)."""


class Profile(ABC):
    """A rising function from an angle to a pixel coordinate, on a stated range of angles.

    A subclass states two formulas in the language of `rb.Formulas`, and the numbers in them:

    >>> import rectbench as rb
    >>> class Mercator(rb.Profile):
    ...     low, high = -1.5, 1.5
    ...     constants = {"focal": 300.0, "low": -1.5, "high": 1.5}
    ...     def value(self, c, angle, xp):
    ...         return c.focal * xp.asinh(xp.tan(angle))
    ...     def angle(self, c, value, xp):
    ...         return xp.atan(xp.sinh(value / c.focal))
    >>> Mercator()([0.0, 0.5]).round(2)
    array([  0.  , 156.67])
    """

    low: float
    """Least angle, radians."""
    high: float
    """Greatest angle, radians."""

    @property
    @abstractmethod
    def constants(self) -> Constants:
        """The numbers in the formulas, `low` and `high` among them."""

    @abstractmethod
    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        """Pixel coordinate of the angle (radians)."""

    @abstractmethod
    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        """Angle (radians) of the pixel coordinate; anything for one out of range."""

    def framed(self, start: float, scale: float) -> Profile:
        """The same in an image that begins at `start` and is `scale` times as large; see `FramedProfile`."""
        return FramedProfile(self, start, scale)

    def __call__(self, angle: ArrayLike) -> FloatArray:
        """Pixel coordinates of angles in radians, of any shape."""
        return np.asarray(self.value(namespaced(self.constants), np.asarray(angle, dtype=float), NUMPY))


@dataclass(frozen=True)
class FramedProfile(Profile):
    """(Ψ(θ) - start) scale - 0.5: any profile seen through a window of its image."""

    profile: Profile
    start: float
    scale: float

    @property
    def low(self) -> float:  # type: ignore[override]
        return self.profile.low

    @property
    def high(self) -> float:  # type: ignore[override]
        return self.profile.high

    @property
    def constants(self) -> Constants:
        window = {"start": self.start, "scale": self.scale, "low": self.low, "high": self.high}
        return {**window, "profile": self.profile.constants}

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        return (self.profile.value(c.profile, angle, xp) - c.start) * c.scale - 0.5

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        return self.profile.angle(c.profile, (value + 0.5) / c.scale + c.start, xp)


@dataclass(frozen=True)
class Cubic(Profile):
    """Ψ(θ) = c0 + c1 θ + c2 θ² + c3 θ³, rising over [low, high] (the paper's rectification model).

    >>> import rectbench as rb
    >>> rb.Cubic(10.0, 300.0, 0.0, -10.0, low=-1.0, high=1.0)([0.0, 0.5])
    array([ 10.  , 158.75])
    """

    c0: float
    c1: float
    c2: float
    c3: float
    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise InvalidInput(f"Cubic has the range [{self.low}, {self.high}]; expected low < high")
        least = least_slope(np.array([self.c1, self.c2, self.c3]), self.low, self.high)
        if not least > 0:
            raise InvalidInput(
                f"Cubic falls within [{self.low:.4f}, {self.high:.4f}] rad (slope {least:.3g})"
            )

    @property
    def constants(self) -> Constants:
        values = {name: getattr(self, name) for name in ("c0", "c1", "c2", "c3", "low", "high")}
        return {**values, "v_low": float(self._cubic(self.low)), "v_high": float(self._cubic(self.high))}

    def framed(self, start: float, scale: float) -> Cubic:
        c0 = (self.c0 - start) * scale - 0.5
        return Cubic(c0, scale * self.c1, scale * self.c2, scale * self.c3, self.low, self.high)

    def _cubic(self, angle: float) -> float:
        return self.c0 + angle * (self.c1 + angle * (self.c2 + angle * self.c3))

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        return c.c0 + angle * (c.c1 + angle * (c.c2 + angle * c.c3))

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        def cubic_and_slope(angle: Any) -> tuple[Any, Any]:
            slope = c.c1 + angle * (2.0 * c.c2 + 3.0 * c.c3 * angle)
            return self.value(c, angle, xp), slope

        share = (value - c.v_low) / (c.v_high - c.v_low)
        low, high = 0.0 * value + c.low, 0.0 * value + c.high
        start = xp.minimum(xp.maximum(c.low + share * (c.high - c.low), low), high)
        found = invert_monotone(cubic_and_slope, value, low, high, start, xp)
        span = 1.0 + ANGLE_SLACK_RAD
        inside = (share >= 1.0 - span) & (share <= span)
        return xp.where(inside, found, math.nan)


def least_slope(coefficients: FloatArray, low: float, high: float) -> float:
    """Least of c1 + 2 c2 θ + 3 c3 θ² over [low, high], exactly: at an end or at the vertex."""
    c1, c2, c3 = coefficients
    places = [low, high]
    if abs(c2) < 3 * abs(c3) * max(abs(low), abs(high)):
        places.append(min(max(-c2 / (3 * c3), low), high))
    return float(min(c1 + t * (2 * c2 + 3 * c3 * t) for t in places))


RADIAL_LIMIT_RAD = {
    "equidistant": math.pi,
    "stereographic": math.pi * (1 - 1e-6),
    "equisolid": math.pi * (1 - 1e-6),
    "orthographic": math.pi / 2 * (1 - 1e-6),
    "cylindrical": math.pi / 2 * (1 - 1e-6),
    "mercator": math.pi / 2 * (1 - 1e-6),
}


@dataclass(frozen=True)
class Radial(Profile):
    """centre + focal r(θ) with r one of the classical lens laws (Abraham and Förstner 2005), or Mercator's.

    The last, r = artanh(sin θ), is the one that is conformal beside equidistant rows.

    >>> import rectbench as rb
    >>> rb.Radial("equidistant", 300.0, 10.0)([0.0, 0.5])
    array([ 10., 160.])
    """

    law: str
    focal_px: float
    centre_px: float

    def __post_init__(self) -> None:
        if self.law not in RADIAL_LIMIT_RAD:
            raise InvalidInput(
                f"unknown lens law '{self.law}'; expected one of {', '.join(RADIAL_LIMIT_RAD)}"
            )
        if not 0 < self.focal_px < math.inf:
            raise InvalidInput(f"Radial has the focal length {self.focal_px} px; expected one above 0")

    def framed(self, start: float, scale: float) -> Radial:
        return Radial(self.law, scale * self.focal_px, (self.centre_px - start) * scale - 0.5)

    @property
    def low(self) -> float:  # type: ignore[override]
        return -RADIAL_LIMIT_RAD[self.law]

    @property
    def high(self) -> float:  # type: ignore[override]
        return RADIAL_LIMIT_RAD[self.law]

    @property
    def constants(self) -> Constants:
        return {"focal": self.focal_px, "centre": self.centre_px, "low": self.low, "high": self.high}

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        laws = {
            "equidistant": lambda t: t,
            "stereographic": lambda t: 2.0 * xp.tan(0.5 * t),
            "equisolid": lambda t: 2.0 * xp.sin(0.5 * t),
            "orthographic": lambda t: xp.sin(t),
            "cylindrical": lambda t: xp.tan(t),
            "mercator": lambda t: xp.asinh(xp.tan(t)),
        }
        return c.centre + c.focal * laws[self.law](angle)

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        inverses = {
            "equidistant": lambda r: r,
            "stereographic": lambda r: 2.0 * xp.atan2(r, 2.0 + 0.0 * r),
            "equisolid": lambda r: 2.0 * xp.asin(0.5 * r),
            "orthographic": lambda r: xp.asin(r),
            "cylindrical": lambda r: xp.atan2(r, 1.0 + 0.0 * r),
            "mercator": lambda r: xp.atan(xp.sinh(r)),
        }
        return inverses[self.law]((value - c.centre) / c.focal)
