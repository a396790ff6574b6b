"""Splines that rise whatever their coefficients are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, PPoly

from rectbench.errors import InvalidInput
from rectbench.formulas.inversion import invert_monotone
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import ANGLE_SLACK_RAD, Profile

SLOPE_DEGREE = 2
"""Of the slope's B-splines: the profile is made of cubics and has two continuous derivatives."""


@dataclass(frozen=True)
class MonotoneSpline(Profile):
    """Ψ(θ) = value_low + ∫ Σ_i slopes[i] B_i(θ) dθ from the first of `knots` to the last, radians.

    B_i ≥ 0 are the quadratic B-splines over the knots, which add up to 1: the slope lies between the least
    and the greatest of `slopes` (pixels per radian, all above 0, one more than there are knots), so that Ψ
    rises between the knots too. Their integrals are known as I-splines (Ramsay, Monotone Regression Splines
    in Action, Statistical Science 3(4), 1988).

    >>> import rectbench as rb
    >>> profile = rb.MonotoneSpline((-1.0, 0.0, 1.0), (300.0, 250.0, 250.0, 400.0), value_low=10.0)
    >>> profile([-1.0, 0.0, 1.0]).round(2)
    array([ 10.  , 276.67, 576.67])
    """

    knots: tuple[float, ...]
    slopes: tuple[float, ...]
    value_low: float

    def __post_init__(self) -> None:
        knots, slopes = np.array(self.knots, dtype=float), np.array(self.slopes, dtype=float)
        if not (len(knots) > 1 and np.isfinite(knots).all() and (np.diff(knots) > 0).all()):
            raise InvalidInput(f"MonotoneSpline has {len(knots)} knots; expected two or more that rise")
        if len(slopes) != len(knots) + 1:
            raise InvalidInput(
                f"MonotoneSpline has {len(slopes)} slopes over {len(knots)} knots; expected one more"
            )
        if not (np.isfinite(slopes).all() and (slopes > 0).all()):
            raise InvalidInput(
                f"MonotoneSpline has a slope of {slopes.min():.3g} px/rad; expected all above 0"
            )

    @classmethod
    def of(cls, knots: ArrayLike, slopes: ArrayLike) -> Self:
        """The spline of arrays [K] and [K + 1], 0 px at the first knot."""
        at, slope = (np.asarray(numbers, dtype=float).tolist() for numbers in (knots, slopes))
        return cls(tuple(at), tuple(slope), 0.0)

    @staticmethod
    def slope_basis(knots: ArrayLike, angles: ArrayLike) -> FloatArray:
        """B_i [N, K + 1] over K knots at angles [N], which are held to the knots' range.

        The slope is `slope_basis(knots, angles) @ slopes`.

        >>> MonotoneSpline.slope_basis((0.0, 1.0), [0.0, 0.5])
        array([[1.  , 0.  , 0.  ],
               [0.25, 0.5 , 0.25]])
        """
        clamped = _clamped(knots)
        held = np.clip(np.asarray(angles, dtype=float), clamped[0], clamped[-1])
        basis: FloatArray = BSpline.design_matrix(held, clamped, SLOPE_DEGREE).toarray()
        return basis

    @property
    def low(self) -> float:  # type: ignore[override]
        return self.knots[0]

    @property
    def high(self) -> float:  # type: ignore[override]
        return self.knots[-1]

    @cached_property
    def constants(self) -> Constants:
        slope = PPoly.from_spline((_clamped(self.knots), np.array(self.slopes), SLOPE_DEGREE))
        whole = slope.antiderivative()
        pieces = slice(SLOPE_DEGREE, SLOPE_DEGREE + len(self.knots) - 1)  # beside the ends' repeated knots
        coefficients = tuple(np.ascontiguousarray(row[pieces]) for row in whole.c[::-1])
        values = whole(np.array(self.knots)) + self.value_low
        return {
            "knots": np.array(self.knots),
            "values": values,
            "c": (values[:-1].copy(), *coefficients[1:]),
            "low": self.low,
            "high": self.high,
            "value_low": float(values[0]),
            "value_high": float(values[-1]),
        }

    def framed(self, start: float, scale: float) -> MonotoneSpline:
        slopes = tuple(float(scale * slope) for slope in self.slopes)
        return MonotoneSpline(self.knots, slopes, (self.value_low - start) * scale - 0.5)

    def value(self, c: Any, angle: Any, xp: Formulas) -> Any:
        piece = xp.interval(c.knots, angle)
        return xp.polynomial([xp.take(row, piece) for row in c.c], angle - xp.take(c.knots, piece))

    def angle(self, c: Any, value: Any, xp: Formulas) -> Any:
        piece = xp.interval(c.values, value)
        start, row = xp.take(c.knots, piece), [xp.take(row, piece) for row in c.c]
        length = xp.take(c.knots, piece + 1) - start

        def cubic_and_slope(x: Any, *row: Any) -> tuple[Any, Any]:
            return xp.polynomial(row, x), row[1] + x * (2.0 * row[2] + 3.0 * x * row[3])

        rise = xp.take(c.values, piece + 1) - row[0]
        first = length * xp.minimum(xp.maximum((value - row[0]) / rise, 0.0), 1.0)
        found = start + invert_monotone(cubic_and_slope, value, 0.0 * length, length, first, xp, tuple(row))
        slack = ANGLE_SLACK_RAD * (c.value_high - c.value_low)
        inside = (value >= c.value_low - slack) & (value <= c.value_high + slack)
        return xp.where(inside, found, math.nan)


def _clamped(knots: ArrayLike) -> FloatArray:
    """The knots of B-splines that end with the range."""
    return np.pad(np.asarray(knots, dtype=float), SLOPE_DEGREE, mode="edge")
