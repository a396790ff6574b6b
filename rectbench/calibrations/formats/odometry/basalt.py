"""Basalt's `calibration.json`: `value0` with `intrinsics`, `T_imu_cam` and `resolution` of each camera.

`T_imu_cam` takes points of the camera to the IMU: a translation `px py pz` in metres and a quaternion
`qx qy qz qw`. Camera 0 is the left one, camera 1 the right one, unless others are asked for (cam0,
cam1, ... by their places). The models are those of basalt-headers' documentation; pixel (0, 0) is the
centre of a pixel. Written with the left camera in the place of the IMU, about which a rig tells nothing.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.calibrations.assembling import camera_of, inverse, pose_matrix, rig_of_posed, rigid, single
from rectbench.calibrations.choosing import Pair, chosen
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, shown
from rectbench.calibrations.layouts import layout_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.file_formats import Writing, lost_angles
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

FOCAL = ("fx", "fy", "cx", "cy")
RADTAN8 = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
MODELS = {
    "pinhole": ("pinhole", FOCAL),
    "pinhole-radtan8": ("pinhole", (*FOCAL, *RADTAN8)),
    "kb4": ("kannala-brandt", (*FOCAL, "k1", "k2", "k3", "k4")),
    "ds": ("double-sphere", (*FOCAL, "xi", "alpha")),
    "eucm": ("extended-unified", (*FOCAL, "alpha", "beta")),
    "ucm": ("extended-unified", (*FOCAL, "alpha")),
    "fov": ("field-of-view", (*FOCAL, "w")),
}
"""The model and parameters of each `camera_type`. Basalt's ucm is the extended one with beta = 1."""

OURS = {"w": "omega"}
LAYOUTS = {
    name: (model, [OURS.get(param, param) for param in names])
    for name, (model, names) in MODELS.items()
    if name != "ucm"  # has no place for beta, and eucm holds all that it does
}

UNKNOWN: dict[str, Any] = {
    "calib_accel_bias": [0.0] * 9,
    "calib_gyro_bias": [0.0] * 12,
    "imu_update_rate": 200.0,
    "accel_noise_std": [1.0] * 3,
    "gyro_noise_std": [1.0] * 3,
    "accel_bias_std": [1.0] * 3,
    "gyro_bias_std": [1.0] * 3,
    "cam_time_offset_ns": 0,
    "vignette": [],
}
"""What Basalt wants in a file and a rig does not tell: no bias, deviations of 1, no vignette."""

QUATERNION_TOLERANCE = 1e-3
"""How far from 1 a quaternion's length may be; what is farther is another thing than a rotation."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    top = single(sources).document
    content = top.section("value0", "the calibration") if "value0" in top else top

    def rig_of(names: Pair) -> Rig:
        places = [_place(name, top.file) for name in names]
        posed = [_read_posed(content, place, given.size) for place in places]
        return rig_of_posed(posed, given, sources[0].name)

    cameras = [f"cam{place}" for place in content.section_of_list("intrinsics").values]
    few = len(cameras) <= 2 or given.cameras is not None
    return rig_of((given.cameras or ("cam0", "cam1")) if few else chosen(cameras, given, top.file, rig_of))


def _place(name: str, file: str) -> int:
    """The place in the file's lists of a camera called cam0, cam1, ..."""
    found = re.fullmatch(r"cam(\d{1,3})", name)
    if not found:
        raise InvalidInput(f"{file}: has no camera {shown(name)}; expected cam0, cam1 and so on")
    return int(found[1])


def _read_posed(content: Section, index: int, size: tuple[int, int] | None) -> PosedCamera:
    camera = content.item("intrinsics", index, "a camera, of two at least")
    kind = camera.choice("camera_type", MODELS)
    model, order = MODELS[kind]
    intrinsics = camera.section("intrinsics", f"the numbers {' '.join(order)}")
    params = {name: intrinsics.number(name, "a number") for name in order}
    params |= {"beta": 1.0} if kind == "ucm" else {}
    params |= {"omega": params.pop("w")} if kind == "fov" else {}
    image = content.section_of_list("resolution").size(str(index), size)
    rpmax = intrinsics.number("rpmax", "a radius") if "rpmax" in intrinsics else 0.0
    edge = math.degrees(math.atan(rpmax)) if rpmax > 0 else None  # where radtan8 ends, on the plane z = 1
    built = camera_of(camera.where, model, image, params, edge)
    pose = content.item("T_imu_cam", index, "a pose, of two at least")
    return PosedCamera(camera.where, built, _read_pose(pose))


def _read_pose(pose: Section) -> FloatArray:
    t = [pose.number(f"p{axis}", "metres") for axis in "xyz"]
    q = np.array([pose.number(f"q{axis}", "a part of a unit quaternion") for axis in "xyzw"])
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(q))
    if not abs(length - 1) < QUATERNION_TOLERANCE:
        raise InvalidInput(f"{pose.at('qx')} to qw have the length {length:g}; expected 1")
    return rigid(Rotation.from_quat(q).as_matrix(), t)


def _recognises(source: Source) -> bool:
    content = source.document.values.get("value0", source.document.values) if source.keys else {}
    return isinstance(content, dict) and {"T_imu_cam", "intrinsics"} <= content.keys()


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """The rig as Basalt's programs load it, the left camera in the place of the IMU."""
    cameras = [_camera_fields(rig.left, "left"), _camera_fields(rig.right, "right")]
    content = {
        "T_imu_cam": [_pose_fields(np.eye(4)), _pose_fields(inverse(pose_matrix(rig)))],
        "intrinsics": cameras,
        "resolution": [list(rig.left.size), list(rig.right.size)],
        **UNKNOWN,
    }
    return {name: json.dumps({"value0": content}, indent=4) + "\n"}


def _camera_fields(camera: Camera, side: str) -> dict[str, Any]:
    model, equal = layout_of(camera, LAYOUTS, "basalt", side)
    if _has_radius(equal):
        model = "pinhole-radtan8"
    params = {name: equal.params[OURS.get(name, name)] for name in MODELS[model][1]}
    if model == "pinhole-radtan8":
        params["rpmax"] = math.tan(math.radians(equal.max_angle_deg or 0.0))
    return {"camera_type": model, "intrinsics": params}


def _has_radius(camera: Camera) -> bool:
    """Whether `rpmax`, a radius on the plane z = 1, says where the camera's image circle ends."""
    return camera.model == "pinhole" and camera.max_angle_deg is not None and camera.max_angle_deg < 90


def _losses(rig: Rig) -> list[str]:
    left, right = (
        replace(camera, max_angle_deg=None) if _has_radius(camera) else camera
        for camera in (rig.left, rig.right)
    )
    return lost_angles(replace(rig, left=left, right=right))


def _pose_fields(T: FloatArray) -> dict[str, float]:
    numbers = [*T[:3, 3], *Rotation.from_matrix(T[:3, :3]).as_quat()]
    return dict(zip(("px", "py", "pz", "qx", "qy", "qz", "qw"), map(float, numbers), strict=True))


FORMAT = RigFormat(
    "basalt",
    "Basalt calibration.json",
    _recognises,
    _read,
    has_many=True,
    write=Writing(_texts, losses=_losses),
)
