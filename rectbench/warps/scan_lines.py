"""û = u(β, γ), v̂ = v(β): maps whose rows are epipolar planes, and whose columns differ from row to row."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline

from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.inversion import invert_monotone
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import ANGLE_SLACK_RAD, Profile
from rectbench.warps.targets import Axis, Target, in_range

DEGREE = 3
"""Of the splines along either angle: two continuous derivatives."""


@dataclass(frozen=True)
class SplineSurface:
    """Σ_ij c_ij B_i(β) N_j(γ) with cubic B-splines over even intervals, in pixels, rising along γ.

    `coefficients` [K_β + 3][K_γ + 3] rise along each row. Since B-splines are nowhere below 0, and the slope
    along γ is made of the differences along rows in the same way, the surface rises along γ everywhere, not
    at the knots alone.

    >>> import rectbench as rb
    >>> surface = rb.SplineSurface((-1.0, 1.0), (-1.0, 1.0), ((0.0, 1.0, 2.0, 4.0),) * 4)
    >>> surface(0.3, [-1.0, 0.0, 1.0])
    array([0.   , 1.625, 4.   ])
    """

    beta: tuple[float, float]
    """The least and the greatest β, radians."""
    gamma: tuple[float, float]
    """The least and the greatest γ, radians."""
    coefficients: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        for name, (low, high) in (("beta", self.beta), ("gamma", self.gamma)):
            if not -math.inf < low < high < math.inf:
                raise InvalidInput(f"SplineSurface has {name} from {low} to {high}; expected low < high")
        lengths = {len(row) for row in self.coefficients}
        if len(lengths) != 1 or min(len(self.coefficients), *lengths) <= DEGREE:
            raise InvalidInput(
                f"SplineSurface has {len(self.coefficients)} rows of {sorted(lengths)} coefficients; "
                f"expected {DEGREE + 1} or more rows and columns, all rows of one length"
            )
        rises = np.diff(np.array(self.coefficients, dtype=float), axis=1)
        if not (np.isfinite(rises).all() and (rises > 0).all()):
            raise InvalidInput(
                f"SplineSurface has coefficients that rise by {rises.min():.3g} px; expected all above 0"
            )

    @classmethod
    def of(cls, beta: ArrayLike, gamma: ArrayLike, coefficients: ArrayLike) -> SplineSurface:
        """The surface of arrays [2], [2] and [K_β + 3, K_γ + 3]."""
        (b_low, b_high), (g_low, g_high) = (np.asarray(ends, dtype=float).tolist() for ends in (beta, gamma))
        rows = np.asarray(coefficients, dtype=float).tolist()
        return cls((b_low, b_high), (g_low, g_high), tuple(map(tuple, rows)))

    @property
    def intervals(self) -> tuple[int, int]:
        """Of β and of γ."""
        return len(self.coefficients) - DEGREE, len(self.coefficients[0]) - DEGREE

    @cached_property
    def constants(self) -> Constants:
        """c[k][l] [K_β K_γ]: the factor of x^k y^l in each patch, with x along γ and y along β, 0 to 1."""
        down, across = self.intervals
        powers = np.einsum(
            "kip,ljq,qp->klji", _powers(across), _powers(down), np.array(self.coefficients), optimize=True
        )
        return {
            "c": tuple(tuple(factor.ravel() for factor in row) for row in powers),
            "down": float(down),
            "across": float(across),
            "per_beta": down / (self.beta[1] - self.beta[0]),
            "per_gamma": across / (self.gamma[1] - self.gamma[0]),
            "beta_low": self.beta[0],
            "low": self.gamma[0],
            "high": self.gamma[1],
        }

    def framed(self, start: float, scale: float) -> SplineSurface:
        """The same in an image that begins at `start` and is `scale` times as large."""
        return SplineSurface.of(self.beta, self.gamma, (np.array(self.coefficients) - start) * scale - 0.5)

    def __call__(self, beta: ArrayLike, gamma: ArrayLike) -> FloatArray:
        """Columns, pixels, at angles in radians of any shapes that go together."""
        b, g = np.broadcast_arrays(np.asarray(beta, dtype=float), np.asarray(gamma, dtype=float))
        return np.asarray(self.value(namespaced(self.constants), b, g, NUMPY))

    def value(self, c: Any, beta: Any, gamma: Any, xp: Formulas) -> Any:
        """The column of the angles, radians."""
        row, y = _piece((beta - c.beta_low) * c.per_beta, c.down, xp)
        column, x = _piece((gamma - c.low) * c.per_gamma, c.across, xp)
        return xp.polynomial(_along_line(c, row * c.across + column, y, xp), x)

    def line(self, c: Any, beta: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """What `angle` has to know of the line at β: row of patches, place in that, columns of both ends."""
        row, y = _piece((beta - c.beta_low) * c.per_beta, c.down, xp)
        return row, y, *(self.value(c, beta, end + 0.0 * beta, xp) for end in (c.low, c.high))

    def angle(self, c: Any, line: tuple[Any, Any, Any, Any], value: Any, xp: Formulas) -> Any:
        """γ (radians) of the column on that line; NaN beyond its ends."""
        row, y, first, last = line
        patch = row * c.across + self._patch_of(c, row, y, value, xp)
        cubic = tuple(_along_line(c, patch, y, xp))

        def value_and_slope(x: Any, a: Any, b: Any, d: Any, e: Any) -> tuple[Any, Any]:
            return a + x * (b + x * (d + x * e)), b + x * (2.0 * d + 3.0 * x * e)

        rise = cubic[1] + cubic[2] + cubic[3]
        start = xp.minimum(xp.maximum((value - cubic[0]) / rise, 0.0), 1.0)
        x = invert_monotone(value_and_slope, value, 0.0 * start, 0.0 * start + 1.0, start, xp, cubic)
        share = (value - first) / (last - first)
        inside = (share >= -ANGLE_SLACK_RAD) & (share <= 1.0 + ANGLE_SLACK_RAD)
        return xp.where(inside, c.low + (patch - row * c.across + x) / c.per_gamma, math.nan)

    def _patch_of(self, c: Any, row: Any, y: Any, value: Any, xp: Formulas) -> Any:
        """The number of the last patch in the row that begins at the column or before it, by halving."""
        found = 0.0 * y
        for halving in reversed(range((self.intervals[1] - 1).bit_length())):
            ahead = found + float(2**halving)
            place = row * c.across + xp.minimum(ahead, c.across - 1.0)
            begins = xp.polynomial([xp.take(factor, place) for factor in c.c[0]], y)
            found = xp.where((ahead < c.across) & (begins <= value), ahead, found)
        return xp.where(found >= 0.0, found, 0.0)


@dataclass(frozen=True)
class ScanLines(Target):
    """û = u(β, γ), v̂ = v(β): every map that keeps rows is of this form, if both images share v.

    >>> import rectbench as rb
    >>> surface = rb.SplineSurface((-1.0, 1.0), (-1.0, 1.0), ((0.0, 1.0, 2.0, 4.0),) * 4)
    >>> target = rb.ScanLines(surface, rb.Radial("equidistant", 300.0, 240.0))
    >>> target.project([0.0, 0.0, 2.0])[0]
    array([  1.625, 240.   ])
    """

    u: SplineSurface
    v: Profile

    @property
    def constants(self) -> Constants:
        return {"u": self.u.constants, "v": self.v.constants}

    def framed(self, left: float, top: float, across: float, down: float) -> ScanLines:
        return ScanLines(self.u.framed(left, across), self.v.framed(top, down))

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        gamma, beta = xp.atan2(x, xp.hypot(y, z)), xp.atan2(y, z)
        ok = in_range(c.u, gamma) & in_range(c.v, beta)
        return self.u.value(c.u, beta, gamma, xp), self.v.value(c.v, beta, xp), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        beta = self.v.angle(c.v, v, xp)
        row = (xp.sin(beta), xp.cos(beta), *self.u.line(c.u, beta, xp))
        x, y, z, ok = self.ray_formula(c, (u,), row, xp)
        return x, y, z, ok & in_range(c.v, beta)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        c = namespaced(self.constants)
        with np.errstate(invalid="ignore"):
            beta = self.v.angle(c.v, rows, NUMPY)
            beta = np.where(in_range(c.v, beta), beta, math.nan)
            return (columns,), (np.sin(beta), np.cos(beta), *self.u.line(c.u, beta, NUMPY))

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (u,), (sin_beta, cos_beta, *line) = column, row
        gamma = self.u.angle(c.u, tuple(line), u, xp)
        cos_gamma = xp.cos(gamma)
        return xp.sin(gamma), cos_gamma * sin_beta, cos_gamma * cos_beta, cos_gamma >= 0.0


def _powers(intervals: int) -> FloatArray:
    """[4, K, K + 3], in each of K unit intervals the factors of 1, x, x² and x³, from the B-splines' own."""
    knots = np.pad(np.arange(intervals + 1.0), DEGREE, mode="edge")
    splines = BSpline(knots, np.eye(intervals + DEGREE), DEGREE)
    starts = np.arange(float(intervals))
    return np.stack([splines(starts, nu=k) / math.factorial(k) for k in range(DEGREE + 1)])


def _piece(place: Any, count: Any, xp: Formulas) -> tuple[Any, Any]:
    """Which of the unit intervals from 0 to `count` a place is nearest to, and how far in; NaN: the first."""
    number = xp.where(place > 0.0, xp.minimum(xp.floor(place), count - 1.0), 0.0)
    return number, place - number


def _along_line(c: Any, patch: Any, y: Any, xp: Formulas) -> list[Any]:
    """The factors of 1, x, x² and x³ on the line at y in a patch."""
    return [xp.polynomial([xp.take(factor, patch) for factor in of_x], y) for of_x in c.c]
