"""Images whose columns are half planes about the vertical: longitudes λ = atan2(x, z)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray
from rectbench.warps.profiles import Profile
from rectbench.warps.targets import Axis, Target, in_range


@dataclass(frozen=True)
class Upright(Target):
    """û = u(λ), v̂ = v(φ) with the latitude φ = atan2(y, hypot(x, z)): maps of the earth, the y axis down.

    Equidistant both ways this is the equirectangular image, with rows f tan φ a cylinder that stands upright.
    Its rows are circles of latitude; but for the equator they are no epipolar planes of a baseline along x.

    >>> import rectbench as rb
    >>> degrees = rb.Radial("equidistant", 57.3, 0.0)
    >>> rb.Upright(degrees, degrees).project([1.0, 1.0, 1.0])[0].round()
    array([45., 35.])
    """

    u: Profile
    v: Profile

    @property
    def constants(self) -> Constants:
        return {"u": self.u.constants, "v": self.v.constants}

    def framed(self, left: float, top: float, across: float, down: float) -> Upright:
        return Upright(self.u.framed(left, across), self.v.framed(top, down))

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        longitude, latitude = xp.atan2(x, z), xp.atan2(y, xp.hypot(x, z))
        ok = in_range(c.u, longitude) & in_range(c.v, latitude)
        return self.u.value(c.u, longitude, xp), self.v.value(c.v, latitude, xp), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        longitude, latitude = self.u.angle(c.u, u, xp), self.v.angle(c.v, v, xp)
        column, row = (xp.sin(longitude), xp.cos(longitude)), (xp.sin(latitude), xp.cos(latitude))
        x, y, z, ok = self.ray_formula(c, column, row, xp)
        return x, y, z, ok & in_range(c.u, longitude) & in_range(c.v, latitude)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        longitude, latitude = _angles(self.u, columns, math.pi), _angles(self.v, rows, math.pi / 2)
        return (np.sin(longitude), np.cos(longitude)), (np.sin(latitude), np.cos(latitude))

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (sin_longitude, cos_longitude), (sin_latitude, cos_latitude) = column, row
        x, z = cos_latitude * sin_longitude, cos_latitude * cos_longitude
        return x, sin_latitude, z, (cos_latitude >= 0.0) & (cos_longitude >= -1.0)


@dataclass(frozen=True)
class Planospheric(Target):
    """û = u(λ), v̂ = v(β): a pixel is where a plane about the vertical meets one about the baseline.

    With both equidistant this is JPL's planospheric model. Rows are epipolar planes. At |λ| or |β| = 90° the
    two planes are one, so that it shows what lies in front, z > 0.

    >>> import rectbench as rb
    >>> degrees = rb.Radial("equidistant", 57.3, 0.0)
    >>> rb.Planospheric(degrees, degrees).project([1.0, 1.0, 1.0])[0].round()
    array([45., 45.])
    """

    u: Profile
    v: Profile

    @property
    def constants(self) -> Constants:
        return {"u": self.u.constants, "v": self.v.constants}

    def framed(self, left: float, top: float, across: float, down: float) -> Planospheric:
        return Planospheric(self.u.framed(left, across), self.v.framed(top, down))

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        longitude, beta = xp.atan2(x, z), xp.atan2(y, z)
        ok = (z > 0.0) & in_range(c.u, longitude) & in_range(c.v, beta)
        return self.u.value(c.u, longitude, xp), self.v.value(c.v, beta, xp), ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        longitude, beta = self.u.angle(c.u, u, xp), self.v.angle(c.v, v, xp)
        column, row = (xp.sin(longitude), xp.cos(longitude)), (xp.sin(beta), xp.cos(beta))
        x, y, z, ok = self.ray_formula(c, column, row, xp)
        return x, y, z, ok & in_range(c.u, longitude) & in_range(c.v, beta)

    def axis_tables(self, columns: FloatArray, rows: FloatArray) -> tuple[Axis, Axis]:
        longitude, beta = _angles(self.u, columns, math.pi / 2), _angles(self.v, rows, math.pi / 2)
        return (np.sin(longitude), np.cos(longitude)), (np.sin(beta), np.cos(beta))

    def ray_formula(self, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        (sin_longitude, cos_longitude), (sin_beta, cos_beta) = column, row
        x, y, z = sin_longitude * cos_beta, cos_longitude * sin_beta, cos_longitude * cos_beta
        length = xp.sqrt(x * x + y * y + z * z)
        return x / length, y / length, z / length, (cos_longitude > 0.0) & (cos_beta > 0.0)


def _angles(profile: Profile, values: FloatArray, limit: float) -> FloatArray:
    """Angles of pixel coordinates [K], radians; NaN beyond the profile's range and beyond ± the limit."""
    c = namespaced(profile.constants)
    with np.errstate(invalid="ignore"):
        angle = profile.angle(c, values, NUMPY)
        return np.where(in_range(c, angle) & (abs(angle) <= limit), angle, math.nan)
