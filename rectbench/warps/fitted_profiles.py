"""Profiles made of others: one of the value of another, and one that is fitted to another's inverse."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.formulas.inversion import inverse
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants
from rectbench.warps.profiles import ANGLE_SLACK_RAD, Profile

FITTED_AT = 1001
"""Angles, evenly over the range, that an inverse is fitted at and its error taken over."""


@dataclass(frozen=True)
class Composed(Profile):
    """Ψ(f(θ)) over [low, high], radians: `outer` of what `inner` makes of the angle.

    >>> import rectbench as rb
    >>> cubic = rb.Cubic(10.0, 300.0, 0.0, -10.0, low=-1.0, high=1.0)
    >>> rb.Composed(cubic, rb.Radial("stereographic", 1.0, 0.0), -0.9, 0.9)([0.0, 0.5]).round(2)
    array([ 10.  , 161.87])
    """

    outer: Profile
    inner: Profile
    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.inner.low <= self.low < self.high <= self.inner.high:
            raise InvalidInput(
                f"Composed has the range [{self.low}, {self.high}]; expected one within "
                f"[{self.inner.low:.4f}, {self.inner.high:.4f}]"
            )

    @property
    def constants(self) -> Constants:
        parts = {"outer": self.outer.constants, "inner": self.inner.constants}
        return {**parts, "low": self.low, "high": self.high}

    def framed(self, start: float, scale: float) -> Composed:
        return replace(self, outer=self.outer.framed(start, scale))

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        return self.outer.value(c.outer, self.inner.value(c.inner, angle, xp), xp)

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        return self.inner.angle(c.inner, self.outer.angle(c.outer, value, xp), xp)


@dataclass(frozen=True)
class PolynomialInverse(Profile):
    """A profile whose inverse is a polynomial: θ = q₀ + q₁ x + q₂ x² + ..., x from -1 to 1 over its pixels.

    The polynomial is what tables are made of, so it is the map that a user gets; the way from angles to
    pixels inverts it. Raises InvalidInput where it does not rise.

    >>> import rectbench as rb
    >>> profile = rb.PolynomialInverse((0.0, 0.8, 0.0, 0.2), value_low=-200.0, value_high=200.0)
    >>> profile([-1.0, 0.0, 0.425]).round(9)
    array([-200.,    0.,  100.])
    """

    coefficients: tuple[float, ...]
    value_low: float
    value_high: float

    def __post_init__(self) -> None:
        if not (len(self.coefficients) > 1 and self.value_low < self.value_high):
            raise InvalidInput(
                f"PolynomialInverse has {len(self.coefficients)} coefficients from {self.value_low} to "
                f"{self.value_high} px; expected two or more, and a range"
            )
        slope = np.polynomial.Polynomial(self.coefficients).deriv()
        turns = [root.real for root in slope.deriv().roots() if abs(root.imag) < 1e-9 and abs(root.real) < 1]
        if not (least := float(min(slope(np.array([-1.0, 1.0, *turns]))))) > 0:
            raise InvalidInput(f"PolynomialInverse falls within its range (slope {least:.3g} rad)")

    @classmethod
    def of(cls, profile: Profile, degree: int) -> Self:
        """The least-squares polynomial of that degree, two or more, with both ends of the profile kept."""
        angles = np.linspace(profile.low, profile.high, FITTED_AT)
        values = profile(angles)
        x = 2 * (values - values[0]) / (values[-1] - values[0]) - 1
        middle, half = (profile.low + profile.high) / 2, (profile.high - profile.low) / 2
        bump = 1 - x * x  # nothing at the ends
        basis = bump[:, None] * np.polynomial.polynomial.polyvander(x, degree - 2)
        fitted = np.linalg.lstsq(basis, angles - middle - half * x)[0]
        ends_kept = np.polynomial.Polynomial([middle, half])
        whole = ends_kept + np.polynomial.Polynomial([1.0, 0.0, -1.0]) * np.polynomial.Polynomial(fitted)
        return cls(tuple(map(float, whole.coef)), float(values[0]), float(values[-1]))

    def error_px(self, profile: Profile) -> float:
        """The largest distance between this map and the profile that it stands for, pixels."""
        angles = np.linspace(self.low, self.high, FITTED_AT)
        return float(np.abs(self(angles) - profile(angles)).max())

    @property
    def low(self) -> float:  # type: ignore[override]
        return float(np.polynomial.Polynomial(self.coefficients)(-1.0))

    @property
    def high(self) -> float:  # type: ignore[override]
        return float(np.polynomial.Polynomial(self.coefficients)(1.0))

    @property
    def constants(self) -> Constants:
        pixels = {"value_low": self.value_low, "value_high": self.value_high}
        return {"q": self.coefficients, **pixels, "low": self.low, "high": self.high}

    def framed(self, start: float, scale: float) -> PolynomialInverse:
        ends = ((value - start) * scale - 0.5 for value in (self.value_low, self.value_high))
        return PolynomialInverse(self.coefficients, *ends)

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        most = c.high - c.low
        above = inverse(_rise, c, angle - c.low, 2.0, most, 2.0 * (angle - c.low) / most, xp)
        return c.value_low + above * ((c.value_high - c.value_low) / 2)

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        share = (value - c.value_low) / (c.value_high - c.value_low)
        inside = (share >= -ANGLE_SLACK_RAD) & (share <= 1.0 + ANGLE_SLACK_RAD)
        return xp.where(inside, _polynomial(c, 2.0 * share - 1.0), math.nan)


def _polynomial(c: Any, x: Any) -> Any:
    total = c.q[-1]
    for coefficient in reversed(c.q[:-1]):
        total = total * x + coefficient
    return total


def _rise(c: Any, above: Any, xp: Formulas) -> Any:
    """The angle above the least, of x above -1."""
    return _polynomial(c, above - 1.0) - c.low
