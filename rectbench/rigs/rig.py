"""Two calibrated cameras and how the right one stands to the left."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.cameras import Camera
from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.types import FloatArray

ROTATION_TOLERANCE = 1e-5
"""Largest entry of RᵀR - 1 that still counts as the rounding of a file with six decimals."""

EXACT_ROTATION = 1e-14
"""Below this RᵀR - 1 is float64 rounding, and the matrix is kept to the last bit."""


@dataclass(frozen=True, eq=False)
class Rig:
    """A stereo rig: X_right = R_right_left X_left + t_right_left, metres.

    Parameters
    ----------
    left, right : the two cameras.
    R_right_left : rotation [3, 3] from left to right coordinates; one that is orthonormal up to the
        rounding of a calibration file is made exactly so.
    t_right_left : translation [3] in right coordinates, metres.
    name : what reports call the rig.
    source : where the numbers come from, and their licence; prose.

    Raises InvalidInput for a matrix that is no rotation, a zero baseline, NaN or infinity.
    """

    left: Camera
    right: Camera
    R_right_left: FloatArray = field(repr=False)
    t_right_left: FloatArray
    name: str = "rig"
    source: str = field(default="", repr=False)

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            if not isinstance(getattr(self, side), Camera):
                raise InvalidInput(f"{side} is {type(getattr(self, side)).__name__}; expected a Camera")
        if not isinstance(self.name, str) or not self.name or not self.name.isprintable():
            raise InvalidInput(f"the rig's name is {self.name!r}; expected one printable line")
        object.__setattr__(self, "R_right_left", checked_rotation(self.R_right_left, "R_right_left"))
        object.__setattr__(self, "t_right_left", _checked_translation(self.t_right_left))

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Rig)
            and (self.left, self.right) == (other.left, other.right)
            and np.array_equal(self.R_right_left, other.R_right_left)
            and np.array_equal(self.t_right_left, other.t_right_left)
        )

    @property
    def baseline_m(self) -> float:
        """Distance between the two centres, metres."""
        return float(np.linalg.norm(self.t_right_left))

    @property
    def centre_right_in_left(self) -> FloatArray:
        """The right camera's centre in left coordinates, metres [3]."""
        centre: FloatArray = -self.R_right_left.T @ self.t_right_left
        return centre

    @property
    def essential_matrix(self) -> FloatArray:
        """E with ray_rightᵀ E ray_left = 0 for corresponding rays [3, 3]."""
        x, y, z = self.t_right_left
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        essential: FloatArray = cross @ self.R_right_left
        return essential

    def right_from_left(self, points_left: ArrayLike) -> FloatArray:
        """Points [..., 3] of the left camera's frame in the right camera's, metres."""
        points: FloatArray = (
            as_points(points_left, 3, "points_left") @ self.R_right_left.T + self.t_right_left
        )
        return points

    def scaled(self, factor: float) -> Rig:
        """The same rig with images `factor` times as large."""
        return replace(self, left=self.left.scaled(factor), right=self.right.scaled(factor))

    def within(self, max_angle_deg: float) -> Rig:
        """The same rig, its lenses showing nothing beyond this angle from their axes (the image circle)."""
        left, right = (replace(camera, max_angle_deg=max_angle_deg) for camera in (self.left, self.right))
        return replace(self, left=left, right=right)

    def save(self, path: str | os.PathLike[str], format: str = "native") -> tuple[Path, ...]:
        """Write the rig's calibration as the project's own YAML, or in another format.

        Returns the files; `load_rig(path)` reads the rig back. See `rectbench.calibrations.writing.save_rig`.
        """
        from rectbench.calibrations.writing import save_rig

        return save_rig(self, path, format)


@np.errstate(over="ignore", invalid="ignore")
def checked_rotation(R: Any, name: str) -> FloatArray:
    """`R` as an exact rotation [3, 3], read-only; InvalidInput, by its name, for what is none."""
    matrix = _finite(R, name, "a 3x3 rotation", (3, 3))
    error = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    determinant = float(np.linalg.det(matrix))
    if not (error <= ROTATION_TOLERANCE and determinant > 0):
        raise InvalidInput(
            f"{name} is no rotation (RᵀR is off by {error:.2g}, determinant {determinant:.3g}); "
            "expected RᵀR = 1, determinant +1"
        )
    if error > EXACT_ROTATION:
        u, _, vt = np.linalg.svd(matrix)
        matrix = u @ vt
    matrix.flags.writeable = False
    return matrix


@np.errstate(over="ignore")
def _checked_translation(t: Any) -> FloatArray:
    vector = _finite(t, "t_right_left", "three finite metres", (3,), (3, 1), (1, 3)).ravel()
    baseline = np.linalg.norm(vector)
    if not 0 < baseline < np.inf:
        size = "infinite" if baseline else "zero"
        raise InvalidInput(f"the baseline is {size}; expected two cameras at different places")
    vector.flags.writeable = False
    return vector


def _finite(value: Any, name: str, expected: str, *shapes: tuple[int, ...]) -> FloatArray:
    """A float64 copy of `value`, of one of these shapes."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} is {type(value).__name__} of no numbers; expected {expected}") from None
    if array.shape not in shapes:
        raise InvalidInput(f"{name} has shape {array.shape}; expected {expected}")
    if not np.isfinite(array).all():
        raise InvalidInput(f"{name} is not finite; expected {expected}")
    return array
