"""What rays of the rectified frame are mapped to: perspective planes and (γ, β) images."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.cameras import Projection
from rectbench.cameras.arrays import Constants, FloatArray, namespaced
from rectbench.cameras.inversion import invert_monotone
from rectbench.errors import InvalidInput

ANGLE_SLACK_RAD = 1e-9
"""Rays this little beyond a profile's range still count as in it (rounding at the image's corner)."""


class Target(Projection):
    """A rectified image as a projection, with what its lookup table can share along rows and columns."""

    def axis_tables(
        self, columns: FloatArray, rows: FloatArray
    ) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
        """Values that hang on the column (û) alone and on the row (v̂) alone, for `ray_formula`."""
        return (columns,), (rows,)

    def ray_formula(
        self, c: Any, column: tuple[Any, ...], row: tuple[Any, ...], xp: Any
    ) -> tuple[Any, Any, Any, Any]:
        """The unit ray of a rectified pixel from the values of `axis_tables`, and its validity."""
        (u,), (v,) = column, row
        return self.unproject_formula(c, u, v, xp)


WORST_CONDITION = 1e13
"""Beyond this the inverse has no digits left."""


@dataclass(frozen=True, eq=False)
class Perspective(Target):
    """(û, v̂, 1) ~ matrix @ ray, valid where the third coordinate is positive."""

    matrix: FloatArray = field(repr=False)
    """[3, 3], pixels from rays; the third row points to where the image looks."""

    def __post_init__(self) -> None:
        matrix = np.array(self.matrix, dtype=np.float64)
        if (
            matrix.shape != (3, 3)
            or not np.isfinite(matrix).all()
            or np.linalg.cond(matrix) > WORST_CONDITION
        ):
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

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> tuple[Any, Any, Any]:
        (a, b, d), (e, f, g), (h, i, j) = c.P
        w = h * x + i * y + j * z
        return (a * x + b * y + d * z) / w, (e * x + f * y + g * z) / w, w > 0.0

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
        (a, b, d), (e, f, g), (h, i, j) = c.P_inverse
        x, y, z = a * u + b * v + d, e * u + f * v + g, h * u + i * v + j
        length = xp.sqrt(x * x + y * y + z * z)
        return x / length, y / length, z / length, length > 0.0


class Profile(ABC):
    """A rising function from an angle to a pixel coordinate, on a stated range of angles."""

    low: float
    """Least angle, radians."""
    high: float
    """Greatest angle, radians."""

    @property
    @abstractmethod
    def constants(self) -> Constants:
        """The numbers in the formulas, `low` and `high` among them."""

    @abstractmethod
    def value(self, c: Any, angle: Any, xp: Any) -> Any:
        """Pixel coordinate of the angle (radians)."""

    @abstractmethod
    def angle(self, c: Any, value: Any, xp: Any) -> Any:
        """Angle (radians) of the pixel coordinate; anything for one out of range."""

    def __call__(self, angle: ArrayLike) -> FloatArray:
        """Pixel coordinates of angles in radians, of any shape."""
        result: FloatArray = np.asarray(
            self.value(namespaced(self.constants), np.asarray(angle, dtype=float), np)
        )
        return result


@dataclass(frozen=True)
class Cubic(Profile):
    """Ψ(θ) = c0 + c1 θ + c2 θ² + c3 θ³, rising over [low, high] (the paper's rectification model)."""

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

    def _cubic(self, angle: float) -> float:
        return self.c0 + angle * (self.c1 + angle * (self.c2 + angle * self.c3))

    def value(self, c: Any, angle: Any, xp: Any) -> Any:
        return c.c0 + angle * (c.c1 + angle * (c.c2 + angle * c.c3))

    def angle(self, c: Any, value: Any, xp: Any) -> Any:
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
}


@dataclass(frozen=True)
class Radial(Profile):
    """centre + focal r(θ) with r one of the classical lens laws (Abraham and Förstner 2005)."""

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

    @property
    def low(self) -> float:  # type: ignore[override]
        return -RADIAL_LIMIT_RAD[self.law]

    @property
    def high(self) -> float:  # type: ignore[override]
        return RADIAL_LIMIT_RAD[self.law]

    @property
    def constants(self) -> Constants:
        return {"focal": self.focal_px, "centre": self.centre_px, "low": self.low, "high": self.high}

    def value(self, c: Any, angle: Any, xp: Any) -> Any:
        laws = {
            "equidistant": lambda t: t,
            "stereographic": lambda t: 2.0 * xp.tan(0.5 * t),
            "equisolid": lambda t: 2.0 * xp.sin(0.5 * t),
            "orthographic": lambda t: xp.sin(t),
            "cylindrical": lambda t: xp.tan(t),
        }
        return c.centre + c.focal * laws[self.law](angle)

    def angle(self, c: Any, value: Any, xp: Any) -> Any:
        inverses = {
            "equidistant": lambda r: r,
            "stereographic": lambda r: 2.0 * xp.atan2(r, 2.0 + 0.0 * r),
            "equisolid": lambda r: 2.0 * xp.asin(0.5 * r),
            "orthographic": lambda r: xp.asin(r),
            "cylindrical": lambda r: xp.atan2(r, 1.0 + 0.0 * r),
        }
        return inverses[self.law]((value - c.centre) / c.focal)


@dataclass(frozen=True)
class Epipolar(Target):
    """û = u(γ), v̂ = v(β): every map of this form keeps rows, provided both images share v."""

    u: Profile
    v: Profile

    @property
    def constants(self) -> Constants:
        return {"u": self.u.constants, "v": self.v.constants}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> tuple[Any, Any, Any]:
        gamma, beta = xp.atan2(x, xp.hypot(y, z)), xp.atan2(y, z)
        ok = _in_range(c.u, gamma) & _in_range(c.v, beta)
        return self.u.value(c.u, gamma, xp), self.v.value(c.v, beta, xp), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
        gamma, beta = self.u.angle(c.u, u, xp), self.v.angle(c.v, v, xp)
        column, row = (xp.sin(gamma), xp.cos(gamma)), (xp.sin(beta), xp.cos(beta))
        x, y, z, ok = self.ray_formula(c, column, row, xp)
        in_range = _in_range(c.u, gamma) & _in_range(c.v, beta)
        return x, y, z, ok & in_range

    def axis_tables(
        self, columns: FloatArray, rows: FloatArray
    ) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
        c = namespaced(self.constants)
        with np.errstate(invalid="ignore"):
            gamma = self.u.angle(c.u, columns, np)
            beta = self.v.angle(c.v, rows, np)
            gamma = np.where(_in_range(c.u, gamma) & (abs(gamma) <= math.pi / 2), gamma, math.nan)
            beta = np.where(_in_range(c.v, beta), beta, math.nan)
        return (np.sin(gamma), np.cos(gamma)), (np.sin(beta), np.cos(beta))

    def ray_formula(
        self, c: Any, column: tuple[Any, ...], row: tuple[Any, ...], xp: Any
    ) -> tuple[Any, Any, Any, Any]:
        (sin_gamma, cos_gamma), (sin_beta, cos_beta) = column, row
        return sin_gamma, cos_gamma * sin_beta, cos_gamma * cos_beta, cos_gamma >= 0.0


def _in_range(c: Any, angle: Any) -> Any:
    return (angle >= c.low - ANGLE_SLACK_RAD) & (angle <= c.high + ANGLE_SLACK_RAD)


ANGLES = Epipolar(Radial("equidistant", 1.0, 0.0), Radial("equidistant", 1.0, 0.0))
"""The rectified frame itself, û = γ and v̂ = β in radians."""


def _rows(matrix: NDArray[np.floating[Any]]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(map(float, row)) for row in matrix)
