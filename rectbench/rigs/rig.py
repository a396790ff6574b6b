"""Two calibrated cameras and the pose of the right one relative to the left."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from rectbench.cameras import Camera, Cones
from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.margin import MARGIN_DEG, checked_margin
from rectbench.types import FloatArray

ROTATION_TOLERANCE = 1e-5
"""Largest entry of RᵀR - 1 that still counts as the rounding of a file with six decimals."""

EXACT_ROTATION = 1e-14
"""Below this RᵀR - 1 is float64 rounding, and the matrix is kept to the last bit."""


RIGHT_FIRST_COSINE = math.cos(math.radians(45.0))
RIM_POINTS = 257
"""On each side of an image, to tell whether a corner of it reaches into the cones."""


class RigWriter(Protocol):
    """What writes a rig to a file, see `Rig.save`."""

    def __call__(self, rig: Rig, path: str | os.PathLike[str], format: str) -> tuple[Path, ...]:
        """The files written."""
        ...


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

    >>> import rectbench as rb
    >>> lens = rb.Camera("equidistant", (800, 800), {"fx": 250, "fy": 250, "cx": 399.5, "cy": 399.5})
    >>> rb.Rig(lens, lens, R_right_left=np.eye(3), t_right_left=[-0.1, 0, 0]).baseline_m
    0.1
    """

    writer: ClassVar[RigWriter]
    """Set by `rectbench.rigs.saving`, which stands above this file as it knows the formats."""

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

    def __hash__(self) -> int:
        pose = np.append(self.R_right_left, self.t_right_left) + 0.0  # 0 and -0 are equal
        return hash((self.left, self.right, pose.tobytes()))

    @property
    def baseline_m(self) -> float:
        """Distance between the two centres, metres.

        >>> import rectbench as rb
        >>> round(rb.load_rig("t265").baseline_m, 3)
        0.064
        """
        return float(np.linalg.norm(self.t_right_left))

    @property
    def centre_right_in_left(self) -> FloatArray:
        """The right camera's centre in left coordinates, metres [3].

        >>> import rectbench as rb
        >>> rb.load_rig("t265").centre_right_in_left.round(3)
        array([ 0.064,  0.   , -0.   ])
        """
        return -self.R_right_left.T @ self.t_right_left

    @property
    def is_right_first(self) -> bool:
        """Whether it is a pair side by side with the right camera on the left: nearer to -x than 45°.

        In the mean of the two cameras' frames. Such a pair keeps its images upright when it is rectified, and
        has negative disparities.

        >>> import rectbench as rb
        >>> rb.load_rig("t265").is_right_first
        False
        """
        half = Rotation.from_matrix(self.R_right_left).as_rotvec() / 2
        towards = Rotation.from_rotvec(half).apply(self.centre_right_in_left)
        return bool(towards[0] < -RIGHT_FIRST_COSINE * self.baseline_m)

    @property
    def essential_matrix(self) -> FloatArray:
        """E with ray_rightᵀ E ray_left = 0 for corresponding rays [3, 3].

        >>> import rectbench as rb
        >>> rig = rb.load_rig("t265")
        >>> point_left = np.array([0.3, -0.2, 1.0])
        >>> point_right = rig.right_from_left(point_left)
        >>> bool(abs(point_right @ rig.essential_matrix @ point_left) < 1e-15)
        True
        """
        x, y, z = self.t_right_left
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return cross @ self.R_right_left

    @property
    def fov_deg(self) -> float:
        """Field of view of the narrower lens, degrees, see `Camera.fov_deg`.

        >>> import rectbench as rb
        >>> round(rb.load_rig("tumvi").fov_deg)
        195
        """
        return min(self.left.fov_deg, self.right.fov_deg)

    def right_from_left(self, points_left: ArrayLike) -> FloatArray:
        """Points [..., 3] of the left camera's frame in the right camera's, metres.

        >>> import rectbench as rb
        >>> rb.load_rig("t265").right_from_left([0.0, 0.0, 1.0]).round(3)
        array([-0.07 ,  0.004,  1.   ])
        """
        return as_points(points_left, 3, "points_left") @ self.R_right_left.T + self.t_right_left

    def scaled(self, factor: float) -> Rig:
        """The same rig with images `factor` times as large.

        >>> import rectbench as rb
        >>> rb.load_rig("t265").scaled(0.5).left.size
        (424, 400)
        """
        return replace(self, left=self.left.scaled(factor), right=self.right.scaled(factor))

    def within(self, max_angle_deg: float) -> Rig:
        """The same rig, its lenses showing nothing beyond this angle from their axes (the image circle).

        >>> import rectbench as rb
        >>> rb.load_rig("t265").within(75).right.max_angle_deg
        75.0
        """
        left, right = (replace(camera, max_angle_deg=max_angle_deg) for camera in (self.left, self.right))
        return replace(self, left=left, right=right)

    def trimmed(self, margin_deg: float = MARGIN_DEG) -> Rig:
        """The same rig, its lenses blind about the epipoles: where rows meet, no map can keep them apart.

        Each camera that sees anything within `margin_deg` of the baseline's direction, or of the opposite
        one, is made blind there, see `Camera.blind`; another one stays what it is. Raises InvalidInput for a
        margin outside (0, 45].

        >>> import rectbench as rb
        >>> rig = rb.load_rig("t265").whole
        >>> ahead = rb.Rig(rig.left, rig.right, np.eye(3), t_right_left=[0.0, 0.0, -0.1])
        >>> ahead.trimmed(10).right.blind
        Cones(axis=(0.0, 0.0, 1.0), within_deg=10.0)
        >>> ahead.trimmed(10).whole == ahead
        True
        """
        margin_deg = checked_margin(margin_deg)
        whole = self.whole
        towards = whole.centre_right_in_left / whole.baseline_m
        left = _blind_about(whole.left, Cones(tuple(towards.tolist()), margin_deg))
        right = _blind_about(whole.right, Cones(tuple((whole.R_right_left @ towards).tolist()), margin_deg))
        return replace(whole, left=left, right=right)

    @property
    def margin_deg(self) -> float | None:
        """Within what of the epipoles its lenses are blind, degrees; None where neither is, see `trimmed`."""
        blind = [camera.blind.within_deg for camera in (self.left, self.right) if camera.blind is not None]
        return max(blind, default=None)

    @property
    def whole(self) -> Rig:
        """The same rig with all that its lenses show, see `trimmed`; itself where nothing is trimmed."""
        left, right = self.left.whole, self.right.whole
        same = left is self.left and right is self.right
        return self if same else replace(self, left=left, right=right)

    def save(self, path: str | os.PathLike[str], format: str = "native") -> tuple[Path, ...]:
        """Write the rig's calibration; what was there before stays until all of it is written.

        Parameters
        ----------
        path : the file; for a format of several files the folder that holds them, which is made where there
            is none. OpenCV's suffix, .yml, .xml or .json, says which language.
        format : "native" is the project's own YAML; `rectbench list formats` shows which others are written.

        Returns the files. `load_rig(path)` gives the rig back to rounding, exactly for "native"; a camera may
        then bear another name for the same lens, such as kannala-brandt for an equidistant one. What a
        format has no place for beside the lenses, `max_angle_deg` above all, is logged as a warning.

        Raises UnknownName for a format that is not written; InvalidInput in one line for a camera that the
        format cannot hold exactly, with the formats that can, and for a path that cannot be written.

        >>> import tempfile
        >>> import rectbench as rb
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     (chain,) = rb.load_rig("t265").save(f"{folder}/camchain.yaml", format="kalibr")
        ...     rb.load_rig(chain).left.model
        'kannala-brandt'
        """
        return Rig.writer(self, path, format)


def _blind_about(camera: Camera, cones: Cones) -> Camera:
    """The camera, blind in these cones if it sees anything there."""
    return replace(camera, blind=cones) if _reaches(camera, cones) else camera


@lru_cache(maxsize=64)
def _reaches(camera: Camera, cones: Cones) -> bool:
    """Whether the camera sees anything in these cones; all methods of a rig ask for the same."""
    rays, seen = camera.unproject(camera.rim(RIM_POINTS))
    return bool(camera.sees(cones.rays()).any() or cones.hold(rays[seen]).any())


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
