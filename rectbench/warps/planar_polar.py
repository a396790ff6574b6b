"""The plane of a pinhole image in polar coordinates about its epipole."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import Profile
from rectbench.warps.targets import Axis, Target, in_range

Along = Literal["length", "logarithm"]
LEAST_REACH = 1e-9
"""A reference point nearer to the epipole, as a share of the plane's unit, is the epipole."""


@dataclass(frozen=True, eq=False)
class PlanarPolar(Target):
    """û along half epipolar lines of a plane, by lengths or their logarithms, and v̂ = v(β) across them.

    `matrix` [3, 3] takes rays of the rectified frame to pixels of a plane without distortion, (a, b, w) with
    w > 0. Its first column is the epipole, at any place: on the image, far off, or at infinity. A half plane
    about the baseline is one half epipolar line, in both images of a pair, so that β orients the lines
    (Pollefeys, Koch and Van Gool 1999). With r the distance from the epipole and ρ that of the `reference`,

        length       û = start_px ∓ (r - ρ)
        logarithm    û = start_px ∓ ρ log(r / ρ)

    with - where the epipole is the baseline's +x, so that û rises towards it. For an epipole at infinity both
    are the distance along parallel lines.

    >>> import rectbench as rb
    >>> matrix = [[100.0, 0.0, -300.0], [50.0, 300.0, 0.0], [1.0, 0.0, 0.0]]  # the epipole at (100, 50)
    >>> target = rb.PlanarPolar(matrix, (0.0, 50.0), rb.Radial("equidistant", 200.0, 0.0))
    >>> target.project([1.0, 0.0, 0.1])[0].round(6)  # at pixel (70, 50), 30 px from the epipole
    array([70.,  0.])
    """

    matrix: FloatArray = field(repr=False)
    reference: tuple[float, float]
    """A pixel of the plane that is not the epipole."""
    v: Profile
    along: Along = "length"
    start_px: float = 0.0

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or np.linalg.cond(matrix) > 1e13:
            raise InvalidInput("PlanarPolar needs a finite, invertible 3x3 matrix")
        if self.along not in get_args(Along):
            raise InvalidInput(f"along is {self.along!r}; expected length or logarithm")
        matrix.flags.writeable = False
        object.__setattr__(self, "matrix", matrix)
        _ = self.constants

    @cached_property
    def constants(self) -> Constants:
        """Everything relative to the reference; the epipole is at toward / nearness, |toward| = 1."""
        u0, v0 = self.reference
        centred = np.array([[1, 0, -u0], [0, 1, -v0], [0, 0, 1]]) @ self.matrix
        reach = math.hypot(centred[0, 0], centred[1, 0])
        if not reach > LEAST_REACH * math.hypot(reach, centred[2, 0]):
            raise InvalidInput(f"the reference ({u0:g}, {v0:g}) is the epipole; expected another pixel")
        return {
            "M": tuple(tuple(map(float, row)) for row in centred),
            "M_inverse": tuple(tuple(map(float, row)) for row in np.linalg.inv(centred)),
            "toward": (float(centred[0, 0] / reach), float(centred[1, 0] / reach)),
            "nearness": float(centred[2, 0] / reach),
            "start": self.start_px,
            "v": self.v.constants,
        }

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        a, b, w = (row[0] * x + row[1] * y + row[2] * z for row in c.M)
        a, b = a / w, b / w
        (e, f), near = c.toward, c.nearness
        distance = xp.hypot(near * a - e, near * b - f)  # r / ρ
        length = (a * (2.0 * e - near * a) + b * (2.0 * f - near * b)) / (1.0 + distance)
        beta = xp.atan2(y, z)
        u = c.start + (length if self.along == "length" else _logarithm(length, near, xp))
        return u, self.v.value(c.v, beta, xp), (w > 0.0) & in_range(c.v, beta)

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        beta = self.v.angle(c.v, v, xp)
        x, y, z, ok = self.ray_formula(c, (self._length(c, u, xp),), self._line(c, beta, xp), xp)
        return x, y, z, ok & in_range(c.v, beta)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        c = namespaced(self.constants)
        with np.errstate(all="ignore"):
            beta = self.v.angle(c.v, rows, NUMPY)
            beta = np.where(in_range(c.v, beta), beta, math.nan)
            return (self._length(c, columns, NUMPY),), self._line(c, beta, NUMPY)

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (length,), (start_a, start_b, along_a, along_b) = column, row
        a, b = start_a - length * along_a, start_b - length * along_b
        x, y, z = (m[0] * a + m[1] * b + m[2] for m in c.M_inverse)
        norm = xp.sqrt(x * x + y * y + z * z)
        return x / norm, y / norm, z / norm, 1.0 - c.nearness * length > 0.0

    def _length(self, c: Any, u: Any, xp: Formulas) -> Any:
        u = u - c.start
        if self.along == "length":
            return u
        half = -0.5 * c.nearness * u
        return u * xp.sinhc(half) * xp.exp(half)  # expm1(x) / x, at 0 too

    def _line(self, c: Any, beta: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """Start (a, b) and unit direction away from the epipole or towards it of the half line at β.

        φ is its turn from the line through the reference. Points of it are start - length direction.
        """
        (e, f), near = c.toward, c.nearness
        a, b, w = (row[1] * xp.sin(beta) + row[2] * xp.cos(beta) for row in c.M)
        ahead, aside = w - near * (e * a + f * b), f * a - e * b
        norm = xp.hypot(ahead, near * aside)
        cos, sin_per_near = ahead / norm, aside / norm
        versine = xp.where(
            cos > 0.0, near * sin_per_near * sin_per_near / (1.0 + cos), (1.0 - cos) / near
        )  # (1 - cos φ) / nearness, to all digits where the epipole is far
        start = versine * e + sin_per_near * f, versine * f - sin_per_near * e
        sin = near * sin_per_near
        return *start, sin * f - cos * e, -sin * e - cos * f


def _logarithm(length: Any, near: Any, xp: Formulas) -> Any:
    """-log(1 - near length) / near, which is the length for an epipole at infinity."""
    x = -near * length
    away = xp.where(x == 0.0, 1.0, x)
    return xp.where(x == 0.0, length, length * xp.log1p(away) / away)
