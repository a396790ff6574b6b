"""A rig from what the files of its cameras say: which two of many, in which frame, in which unit.

Poses on the way are rigid transformations [4, 4], X_a = T_a_b X_b.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from rectbench.calibrations.choosing import Pair as Pair
from rectbench.calibrations.choosing import chosen as chosen
from rectbench.calibrations.contract import UNITS, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source, errors_at
from rectbench.calibrations.rectified_pair import in_one_frame
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

LONGEST_BASELINE_M = 10.0
"""A longer baseline is rather one in millimetres; it is believed where the unit is stated."""

POSE_FILE = (
    "a third file with the pose, `R_right_left: [[...], ...]` and `t_right_left: [x, y, z]`, or "
    "OpenCV's R and T"
)


def assembled(
    left: Camera,
    right: Camera,
    T_right_left: Any,
    given: Given,
    where: str,
    name: str,
    unit: str | None = None,
) -> Rig:
    """The rig of two cameras and the pose [4, 4] between them, in metres.

    `unit` is what the file itself says its translations are in, None where it leaves that open.
    Raises InvalidInput where caller and file disagree about the unit, where the pose is none, and
    where a baseline beyond `LONGEST_BASELINE_M` suggests millimetres that nobody has stated.
    """
    if None not in (unit, given.unit) and unit != given.unit:
        raise InvalidInput(f"{where}: is in {unit}; expected unit={given.unit!r} as given beside the file")
    stated = unit or given.unit
    T = np.asarray(T_right_left, dtype=np.float64)
    with errors_at(where):
        rig = Rig(left, right, T[:3, :3], UNITS[stated or "m"] * T[:3, 3], name=name)
    if stated is None and rig.baseline_m > LONGEST_BASELINE_M:
        raise InvalidInput(
            f"{where}: the baseline is {rig.baseline_m:.6g} m; expected at most {LONGEST_BASELINE_M:g} m, "
            "or unit='mm' (or cm, in, ft, m) stating what the file's translations are in"
        )
    return rig


def side_by_side(
    left: Camera,
    right: Camera,
    baseline: float,
    given: Given,
    where: str,
    name: str,
    unit: str | None = None,
) -> Rig:
    """The rig of two cameras that look the same way, the right one `baseline` to the right."""
    return assembled(left, right, rigid(np.eye(3), [-baseline, 0.0, 0.0]), given, where, name, unit)


def rig_of_posed(posed: Sequence[PosedCamera], given: Given, name: str, unit: str | None = None) -> Rig:
    """The rig of two cameras, left and right, that stand in one frame."""
    left, right = in_one_frame(*posed)
    where = f"{left.where} and {right.where}"
    if left.T_shared_camera is None or right.T_shared_camera is None:
        unposed = left if left.T_shared_camera is None else right
        raise InvalidInput(f"{unposed.where}: does not say where its camera stands; expected {POSE_FILE}")
    if np.array_equal(left.T_shared_camera[:3, 3], right.T_shared_camera[:3, 3]):
        raise InvalidInput(f"{where}: put both cameras at one place; expected two places, or {POSE_FILE}")
    with np.errstate(all="ignore"):  # what is not finite is said below
        T = inverse(right.T_shared_camera) @ left.T_shared_camera
    return assembled(left.camera, right.camera, T, given, where, name, unit)


def camera_of(
    where: str,
    model: str,
    size: tuple[int, int],
    params: Mapping[str, Any],
    max_angle_deg: float | None = None,
) -> Camera:
    """The camera of a file's numbers; what is wrong with them is said of `where`."""
    with errors_at(where):
        return Camera(model, size, params, max_angle_deg)


def rig_of_list(
    source: Source, cameras: Section, read: Callable[[Section, Given], PosedCamera], given: Given
) -> Rig:
    """The rig of two cameras of a list, which are called cam0, cam1, ... by their places."""

    def rig_of(names: Pair) -> Rig:
        sections = (cameras.section(name.removeprefix("cam"), "a camera") for name in names)
        return rig_of_posed([read(section, given) for section in sections], given, source.name)

    return rig_of(chosen([f"cam{place}" for place in cameras.values], given, source.path, rig_of))


def single(sources: Sequence[Source]) -> Source:
    """The one file of a format that takes no more than one."""
    if len(sources) > 1:
        raise InvalidInput(f"{sources[0].path}: is read together with {sources[1].path}; expected one file")
    return sources[0]


def inverse(T: FloatArray) -> FloatArray:
    """The inverse [4, 4] of a rigid transformation."""
    R = T[:3, :3].T
    return rigid(R, -R @ T[:3, 3])


def rigid(R: Any, t: Any) -> FloatArray:
    """The transformation [4, 4] with X' = R X + t."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def pose_matrix(rig: Rig) -> FloatArray:
    """T_right_left [4, 4], metres."""
    return rigid(rig.R_right_left, rig.t_right_left)
