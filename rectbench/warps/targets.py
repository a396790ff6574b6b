"""What rays of the rectified frame are mapped to: perspective planes and (γ, β) images."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Projection
from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import ANGLE_SLACK_RAD, Profile, Radial

Axis = tuple[FloatArray, ...]
"""Values that depend on the column of a pixel alone, or on its row alone."""


class Target(Projection):
    """A rectified image as a projection, with what its lookup table can share along rows and columns.

    A subclass states the two formulas of a `Projection`, in the language of `rb.Formulas`, and their numbers:

    >>> import rectbench as rb
    >>> class Cylinder(rb.Target):
    ...     constants = {"f": 300.0}
    ...     def project_formula(self, c, x, y, z, xp):
    ...         return c.f * xp.atan2(x, z), c.f * y / xp.hypot(x, z), xp.hypot(x, z) > 0.0
    ...     def unproject_formula(self, c, u, v, xp):
    ...         length = xp.hypot(1.0, v / c.f)
    ...         return xp.sin(u / c.f) / length, v / c.f / length, xp.cos(u / c.f) / length, abs(u) < 900.0
    >>> pixel, ok = Cylinder().project([1.0, 0.0, 1.0])
    >>> pixel.round(2), bool(ok)
    (array([235.62,   0.  ]), True)
    """

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        """Values that depend on the column (û) alone and on the row (v̂) alone, for `ray_formula`."""
        return (columns,), (rows,)

    def framed(self, left: float, top: float, across: float, down: float) -> Target:
        """The image through a window whose corner is (left, top), its pixels scaled; see `Framed`."""
        return Framed(self, left, top, across, down)

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """The unit ray of a rectified pixel from the values of `axis_tables`, and its validity."""
        (u,), (v,) = column, row
        return self.unproject_formula(c, u, v, xp)

    def curve_normals(self, px: FloatArray) -> FloatArray:
        """Covectors [..., 2] across the curves along which a pair is to be searched, at pixels [..., 2].

        These curves are rows, with (0, 1), unless a target says otherwise; see `Rectification.curves_apart`.
        """
        return np.broadcast_to([0.0, 1.0], np.shape(px))


@dataclass(frozen=True, eq=False)
class Framed(Target):
    """Any target seen through a window of its image, `across` times as wide and `down` times as high.

    (left, top) is the window's corner, in pixels of the target's image, whose own corner is (-0.5, -0.5).
    """

    target: Target
    left: float
    top: float
    across: float
    down: float

    @property
    def constants(self) -> Constants:
        window = {name: getattr(self, name) for name in ("left", "top", "across", "down")}
        return {**window, "target": self.target.constants}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        u, v, ok = self.target.project_formula(c.target, x, y, z, xp)
        return (u - c.left) * c.across - 0.5, (v - c.top) * c.down - 0.5, ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        u, v = (u + 0.5) / c.across + c.left, (v + 0.5) / c.down + c.top
        return self.target.unproject_formula(c.target, u, v, xp)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        columns, rows = (columns + 0.5) / self.across + self.left, (rows + 0.5) / self.down + self.top
        return self.target.axis_tables(columns, rows)

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        return self.target.ray_formula(c.target, column, row, xp)

    def curve_normals(self, px: FloatArray) -> FloatArray:
        scales = np.array([self.across, self.down])
        normals: FloatArray = self.target.curve_normals((px + 0.5) / scales + [self.left, self.top]) / scales
        return normals


WORST_CONDITION = 1e13
"""Beyond this the inverse has no digits left."""


@dataclass(frozen=True, eq=False)
class Perspective(Target):
    """(û, v̂, 1) ~ matrix @ ray, valid where the third coordinate is positive.

    >>> import rectbench as rb
    >>> pixel, ok = rb.Perspective.from_focal(300.0, 320.0, 240.0).project([0.5, 0.0, 1.0])
    >>> pixel, bool(ok)
    (array([470., 240.]), True)
    """

    matrix: FloatArray = field(repr=False)
    """[3, 3], pixels from rays; the third row points to where the image looks."""

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        finite = matrix.shape == (3, 3) and bool(np.isfinite(matrix).all())
        if not finite or np.linalg.cond(matrix) > WORST_CONDITION:
            raise InvalidInput("Perspective needs a finite, invertible 3x3 matrix")
        matrix.flags.writeable = False
        object.__setattr__(self, "matrix", matrix)

    @classmethod
    def from_focal(cls, focal_px: float, cx: float, cy: float) -> Perspective:
        """The plain pinhole image of one focal length."""
        return cls(np.array([[focal_px, 0, cx], [0, focal_px, cy], [0, 0, 1.0]]))

    @property
    def constants(self) -> Constants:
        return {"P": _rows(self.matrix), "P_inverse": _rows(np.linalg.inv(self.matrix))}

    def framed(self, left: float, top: float, across: float, down: float) -> Perspective:
        window = np.array([[across, 0, -left * across - 0.5], [0, down, -top * down - 0.5], [0, 0, 1]])
        return Perspective(window @ self.matrix)

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        (a, b, d), (e, f, g), (h, i, j) = c.P
        w = h * x + i * y + j * z
        return (a * x + b * y + d * z) / w, (e * x + f * y + g * z) / w, w > 0.0

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (a, b, d), (e, f, g), (h, i, j) = c.P_inverse
        x, y, z = a * u + b * v + d, e * u + f * v + g, h * u + i * v + j
        length = xp.sqrt(x * x + y * y + z * z)
        return x / length, y / length, z / length, length > 0.0


@dataclass(frozen=True)
class Epipolar(Target):
    """û = u(γ), v̂ = v(β): every map of this form keeps rows, provided both images share v.

    >>> import rectbench as rb
    >>> target = rb.Epipolar(rb.Radial("equidistant", 300.0, 320.0), rb.Radial("equidistant", 300.0, 240.0))
    >>> target.project([0.0, 0.0, 2.0])[0]
    array([320., 240.])
    """

    u: Profile
    v: Profile

    @property
    def constants(self) -> Constants:
        return {"u": self.u.constants, "v": self.v.constants}

    def framed(self, left: float, top: float, across: float, down: float) -> Epipolar:
        return Epipolar(self.u.framed(left, across), self.v.framed(top, down))

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        gamma, beta = xp.atan2(x, xp.hypot(y, z)), xp.atan2(y, z)
        ok = in_range(c.u, gamma) & in_range(c.v, beta)
        return self.u.value(c.u, gamma, xp), self.v.value(c.v, beta, xp), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        gamma, beta = self.u.angle(c.u, u, xp), self.v.angle(c.v, v, xp)
        column, row = (xp.sin(gamma), xp.cos(gamma)), (xp.sin(beta), xp.cos(beta))
        x, y, z, ok = self.ray_formula(c, column, row, xp)
        return x, y, z, ok & in_range(c.u, gamma) & in_range(c.v, beta)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        c = namespaced(self.constants)
        with np.errstate(invalid="ignore"):
            gamma = self.u.angle(c.u, columns, NUMPY)
            beta = self.v.angle(c.v, rows, NUMPY)
            gamma = np.where(in_range(c.u, gamma) & (abs(gamma) <= math.pi / 2), gamma, math.nan)
            beta = np.where(in_range(c.v, beta), beta, math.nan)
        return (np.sin(gamma), np.cos(gamma)), (np.sin(beta), np.cos(beta))

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (sin_gamma, cos_gamma), (sin_beta, cos_beta) = column, row
        return sin_gamma, cos_gamma * sin_beta, cos_gamma * cos_beta, cos_gamma >= 0.0


@dataclass(frozen=True, eq=False)
class Wrapped(Target):
    """A target whose rows go all around the baseline: beyond the last one the first ones come again.

    A ray has one place, in rows `start` to `start + turn`; pixels beyond those show once more what is there.

    >>> import rectbench as rb
    >>> rows = rb.Radial("equidistant", 100.0, 0.0)
    >>> target = rb.Wrapped(rb.Epipolar(rows, rows), -314.0, 628.0)
    >>> target.unproject([[0.0, -10.0], [0.0, 618.0]])[0].round(3)
    array([[ 0.  , -0.1 ,  0.995],
           [ 0.  , -0.1 ,  0.995]])
    """

    target: Target
    start: float
    """The row of β = -180°, its upper edge."""
    turn: float
    """Rows from there to β = 180°."""

    @property
    def constants(self) -> Constants:
        return {"target": self.target.constants, "start": self.start, "turn": self.turn}

    def framed(self, left: float, top: float, across: float, down: float) -> Wrapped:
        start = (self.start - top) * down - 0.5
        return Wrapped(self.target.framed(left, top, across, down), start, self.turn * down)

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        return self.target.project_formula(c.target, x, y, z, xp)

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        return self.target.unproject_formula(c.target, u, v - c.turn * xp.floor((v - c.start) / c.turn), xp)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        rows = rows - self.turn * np.floor((rows - self.start) / self.turn)
        return self.target.axis_tables(columns, rows)

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        return self.target.ray_formula(c.target, column, row, xp)


def in_range(c: Any, angle: Any) -> Any:
    """Mask of the angles that a profile with the constants c has."""
    return (angle >= c.low - ANGLE_SLACK_RAD) & (angle <= c.high + ANGLE_SLACK_RAD)


ANGLES = Epipolar(Radial("equidistant", 1.0, 0.0), Radial("equidistant", 1.0, 0.0))
"""The rectified frame itself, û = γ and v̂ = β in radians."""


def _rows(matrix: NDArray[np.floating[Any]]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(map(float, row)) for row in matrix)
