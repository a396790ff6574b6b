"""Kalibr's `camchain.yaml`, and OpenVINS' `kalibr_imucam_chain.yaml`: cam0 (left), cam1 (right).

OpenVINS' `estimator_config.yaml` leads to its chain by `relative_config_imucam`.

The projections and their numbers are those of Kalibr's wiki, "Supported models" and "YAML formats".
The pose is `T_cn_cnm1` of cam1, which takes points of cam0 to cam1; where that is missing, the two
cameras' `T_cam_imu` (points of the IMU to the camera; OpenVINS may write its inverse, `T_imu_cam`).
A camera without `camera_model` is a pinhole, as other programs that write chains leave it out.
Of a longer chain any two cameras make a rig.
Translations are metres, pixel (0, 0) is the centre of a pixel, there is no skew. Written are cam0, cam1
and its `T_cn_cnm1`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rectbench.calibrations.assembling import assembled, camera_of, inverse, pose_matrix, single
from rectbench.calibrations.checks.consistency import compare_poses
from rectbench.calibrations.choosing import Pair, chosen
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv_keys import MATRIX
from rectbench.calibrations.layouts import layout_of
from rectbench.cameras import Camera
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray
from rectbench.yaml_text import yaml_text

FOCAL = ("fx", "fy", "cx", "cy")
RADTAN = ("k1", "k2", "p1", "p2")
EQUI = ("k1", "k2", "k3", "k4")


@dataclass(frozen=True)
class Layout:
    """A projection model and the order in which Kalibr lists its parameters."""

    model: str
    intrinsics: tuple[str, ...]
    distortion: tuple[str, ...] = ()


IMU_KEYS = ("T_cam_imu", "T_imu_cam")

LAYOUTS = {
    ("pinhole", "none"): Layout("pinhole", FOCAL),
    ("pinhole", "radtan"): Layout("pinhole", FOCAL, RADTAN),
    ("pinhole", "equi"): Layout("kannala-brandt", FOCAL, EQUI),
    ("pinhole", "equidistant"): Layout("kannala-brandt", FOCAL, EQUI),
    ("pinhole", "fov"): Layout("field-of-view", FOCAL, ("omega",)),
    ("omni", "none"): Layout("unified", ("xi", *FOCAL)),
    ("omni", "radtan"): Layout("unified", ("xi", *FOCAL), RADTAN),
    ("ds", "none"): Layout("double-sphere", ("xi", "alpha", *FOCAL)),
    ("eucm", "none"): Layout("extended-unified", ("alpha", "beta", *FOCAL)),
}
"""What rectbench's models hold; `omni` with equi or fov, and `ds` and `eucm` with a distortion on top,
are no camera that it has."""


OTHERS_LAYOUTS = {
    ("pinhole", "rational_polynomial"): Layout("pinhole", FOCAL, (*RADTAN, "k3", "k4", "k5", "k6")),
    ("pinhole", "plumb_bob"): Layout("pinhole", FOCAL, (*RADTAN, "k3")),
}
"""What others put into a chain, and Kalibr itself does not read."""

CAMERA = re.compile("cam[0-9]{1,2}")
CONFIG = "relative_config_imucam"
"""Where OpenVINS' configuration names its chain."""


def _recognises(source: Source) -> bool:
    return _is_chain(source) or CONFIG in source.keys


def _is_chain(source: Source) -> bool:
    """Whether a file has cameras by Kalibr's names; some with other keys are OpenCV's or AirSLAM's."""
    cameras = [source.document.values[key] for key in source.keys if CAMERA.fullmatch(key)]
    others = {*MATRIX, "T_type"}
    return any(not (isinstance(camera, dict) and camera.keys() & others) for camera in cameras)


def _read(sources: Sequence[Source], given: Given) -> Rig:
    """The rig of cam0 (left) and cam1 (right), or of the two asked for."""
    source = _chain(sources)
    chain = source.document

    def rig_of(names: Pair) -> Rig:
        expected = ("the first camera, the left one", "the second camera; a rig takes two")
        sections = [chain.section(name, what) for name, what in zip(names, expected, strict=True)]
        left, right = (_read_camera(section, given.size) for section in sections)
        key, T = _read_pose(chain, *names)
        return assembled(left, right, T, given, key, source.name)

    cameras = [key for key in chain.values if CAMERA.fullmatch(key)]
    few = len(cameras) <= 2 and not given.cameras
    return rig_of(("cam0", "cam1") if few else chosen(cameras, given, chain.file, rig_of))


def _chain(sources: Sequence[Source]) -> Source:
    """The chain among the files of a folder, or the one that a configuration names."""
    chains = [source for source in sources if _is_chain(source)]
    configs = [source for source in sources if source not in chains and CONFIG in source.keys]
    if configs and not chains:
        config = single(configs)
        return config.beside(config.document.text(CONFIG, "the name of the cameras' file"))
    return single(chains if configs else sources)


def _read_pose(chain: Section, left: str, right: str) -> tuple[str, FloatArray]:
    """Where the pose is, and the transformation from the left camera to the right one."""
    first, last = sorted((left, right), key=lambda name: int(name[3:]))
    links = [
        chain.section(f"cam{place}", "a camera") for place in range(int(first[3:]) + 1, int(last[3:]) + 1)
    ]
    ends = [chain.section(name, "a camera") for name in (left, right)]
    if all("T_cn_cnm1" not in link for link in links) and any(key in ends[1] for key in IMU_KEYS):
        T_left_imu, T_right_imu = (_from_imu(end) for end in ends)
        return f"{chain.at(left)} and {right}", T_right_imu @ inverse(T_left_imu)
    T = np.eye(4)
    for link in links:
        T = link.rigid("T_cn_cnm1", "the pose from the camera before to this one, metres") @ T
    T = T if first == left else inverse(T)
    if all(key in end for key in IMU_KEYS[:1] for end in ends):
        T_left_imu, T_right_imu = (_from_imu(end) for end in ends)
        compare_poses(f"{chain.at(right)}.T_cam_imu", T_right_imu @ inverse(T_left_imu), T, "T_cn_cnm1")
    return chain.at(f"{last}.T_cn_cnm1"), T


def _from_imu(camera: Section) -> FloatArray:
    if "T_imu_cam" in camera and "T_cam_imu" not in camera:
        return inverse(camera.rigid("T_imu_cam", "the pose from camera to IMU, metres"))
    return camera.rigid("T_cam_imu", "the pose from IMU to camera, metres")


def _read_camera(section: Section, size: tuple[int, int] | None) -> Camera:
    expected = "pinhole, omni, ds or eucm"
    projection = section.text("camera_model", expected) if "camera_model" in section else "pinhole"
    layouts = LAYOUTS | OTHERS_LAYOUTS
    known = [distortion for name, distortion in layouts if name == projection]
    if not known:
        raise section.fault("camera_model", expected)
    distortion = section.values.get("distortion_model", "none")
    if distortion not in known:
        raise section.fault("distortion_model", f"{', '.join(known)} with {projection}")
    layout = layouts[projection, distortion]
    params = section.named("intrinsics", layout.intrinsics)
    if layout.distortion:
        params |= section.named("distortion_coeffs", layout.distortion)
    return camera_of(section.where, layout.model, section.size("resolution", size), params)


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """The camchain of a rig: cam0 is the left camera, cam1 the right one."""
    left, right = _camera_fields(rig.left, "left"), _camera_fields(rig.right, "right")
    pose = {"T_cn_cnm1": pose_matrix(rig).tolist()}
    return {name: yaml_text({"cam0": left, "cam1": pose | right})}


def _camera_fields(camera: Camera, side: str) -> dict[str, Any]:
    """The entries of a camera under the first layout that holds it."""
    layouts = {key: (layout.model, layout.intrinsics + layout.distortion) for key, layout in LAYOUTS.items()}
    key, equal = layout_of(camera, layouts, "kalibr", side)
    projection, distortion = key
    return {
        "camera_model": projection,
        "intrinsics": [equal.params[name] for name in LAYOUTS[key].intrinsics],
        "distortion_model": distortion,
        "distortion_coeffs": [equal.params[name] for name in LAYOUTS[key].distortion],
        "resolution": list(equal.size),
    }


FORMAT = RigFormat(
    "kalibr",
    "Kalibr camchain, OpenVINS kalibr_imucam_chain (YAML)",
    _recognises,
    _read,
    has_many=True,
    write=Writing(_texts),
)
