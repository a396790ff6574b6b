"""ORB-SLAM3's settings of a stereo rig, and ORB-SLAM2's with its rectification (OpenCV YAML).

ORB-SLAM3: `Camera1.*`, `Camera2.*` (older files: `Camera.*`), `Camera.type` PinHole or KannalaBrandt8,
and `Stereo.T_c1_c2` (older: `Tlr`), which takes points of the right camera to the left one, metres.
Rectified images have Camera1 alone, and the baseline `Stereo.b`; in ORB-SLAM2's settings, Camera and
`Camera.bf`, the baseline times fx. A `DepthMapFactor` marks the settings of an RGB-D camera, of no rig.
ORB-SLAM2: `LEFT.K`, `LEFT.D`, `LEFT.R`, `LEFT.P` and `RIGHT.*`, as `cv2.stereoRectify` gives them; P[0, 3] of
RIGHT is -fx' B, see `formats.devices.ros`. Four coefficients in LEFT.D are still the pinhole's; of a fisheye
they are in AirVO's files, which are the same but for `distortion_type: 1`.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import (
    assembled,
    camera_of,
    inverse,
    rig_of_posed,
    side_by_side,
    single,
)
from rectbench.calibrations.checks.consistency import compare_numbers
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.devices.ros import rectified
from rectbench.calibrations.formats.toolboxes.opencv import ORDERS, check_pinhole, opencv_camera
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

POSES = ("Stereo.T_c1_c2", "Tlr")
MODELS = {
    "PinHole": ("pinhole", ("k1", "k2", "p1", "p2")),
    "KannalaBrandt8": ("kannala-brandt", ("k1", "k2", "k3", "k4")),
    "Rectified": ("pinhole", ()),
}
OPTIONAL = ("k3",)
"""What PinHole may have beyond its four coefficients."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    if any(key in file for key in POSES):
        return _read_calibrated(file, given, sources[0].name)
    if "Stereo.b" in file:
        left = _read_camera(file, "Camera1", given)
        baseline = file.number("Stereo.b", "metres")
        return side_by_side(left, left, baseline, given, file.at("Stereo.b"), sources[0].name)
    if "LEFT.K" not in file and "RIGHT.K" not in file:
        return _read_side_by_side(file, given, sources[0].name)
    posed = [_read_rectified(file, side, given) for side in ("LEFT", "RIGHT")]
    rig = rig_of_posed(posed, given, sources[0].name)
    _compare_rectified(file, rig)
    return rig


def _compare_rectified(file: Section, rig: Rig) -> None:
    """`Camera` is the rectified one of LEFT.P, and `Camera.bf` its focal length times the baseline."""
    P = file.array("LEFT.P", "the 3x4 projection matrix", (12,))
    for key, place in (("fx", 0), ("fy", 5), ("cx", 2), ("cy", 6)):
        compare_numbers(file, f"Camera.{key}", float(P[place]), "LEFT.P")
    for key in ("Camera.bf", "bf"):
        compare_numbers(file, key, float(P[0]) * rig.baseline_m, "LEFT.P and RIGHT.P")


def _read_side_by_side(file: Section, given: Given, name: str) -> Rig:
    """The rectified pair of `Camera.bf`; a distortion there would be one that nobody undoes."""
    params = {key: file.number(f"Camera.{key}", "pixels") for key in ("fx", "fy", "cx", "cy")}
    distortion = [f"Camera.{key}" for key in ("k1", "k2", "p1", "p2", "k3") if f"Camera.{key}" in file]
    for key in distortion:
        if file.number(key, "0") != 0:
            raise file.fault(key, "0 of rectified images, or LEFT.K, LEFT.D and the like of others")
    if params["fx"] <= 0:
        raise file.fault("Camera.fx", "pixels above 0")
    size = file.sides("Camera.width", "Camera.height", given.size)
    camera = camera_of(file.at("Camera.fx"), "pinhole", size, params)
    baseline = file.number("Camera.bf", "pixels times metres") / params["fx"]
    return side_by_side(camera, camera, baseline, given, file.at("Camera.bf"), name)


def _read_calibrated(file: Section, given: Given, name: str) -> Rig:
    key = next(key for key in POSES if key in file)
    left = _read_camera(file, "Camera1" if "Camera1.fx" in file else "Camera", given)
    right = _read_camera(file, "Camera2", given)
    T_left_right = file.rigid(key, "the pose from the right camera to the left, metres")
    return assembled(left, right, inverse(T_left_right), given, file.at(key), name)


def _read_camera(file: Section, camera: str, given: Given) -> Camera:
    model, distortion = MODELS[file.choice("Camera.type", MODELS)]
    names = ["fx", "fy", "cx", "cy", *distortion]
    names += [name for name in OPTIONAL if model == "pinhole" and f"{camera}.{name}" in file]
    params = {name: file.number(f"{camera}.{name}", "a number") for name in names}
    size = file.sides("Camera.width", "Camera.height", given.size)
    return camera_of(file.at(f"{camera}.fx"), model, size, params)


def _read_rectified(file: Section, side: str, given: Given) -> PosedCamera:
    prefix = f"{side}." if f"{side}.width" in file or "image_width" not in file else "image_"
    size = file.sides(f"{prefix}width", f"{prefix}height", given.size)
    lens = _rectified_lens(file)
    camera = opencv_camera(file, f"{side}.K", f"{side}.D", lens, size)
    if lens == "pinhole" and "distortion_type" not in file:
        coefficients = {name: camera.params[name] for name in ORDERS[lens] if name in camera.params}
        check_pinhole(
            file.at(f"{side}.D"), coefficients, "`distortion_type: 0` or 1 (fisheye)", is_usual=True
        )
    posed = rectified(PosedCamera(file.at(f"{side}.R"), camera), file, f"{side}.R", f"{side}.P")
    if posed.T_shared_camera is None:
        raise InvalidInput(f"{file.at(side)}.R or {side}.P is missing; expected cv2.stereoRectify's R and P")
    return posed


def _rectified_lens(file: Section) -> str:
    """AirVO's `distortion_type` makes a fisheye of what is ORB-SLAM2's pinhole else."""
    if "distortion_type" not in file:
        return "pinhole"
    kind = file.number("distortion_type", "0 (pinhole) or 1 (fisheye)")
    if kind not in (0, 1):
        raise file.fault("distortion_type", "0 (pinhole) or 1 (fisheye)")
    return "fisheye" if kind else "pinhole"


def _recognises(source: Source) -> bool:
    keys = source.keys
    is_stereo = "Camera.bf" in keys and "DepthMapFactor" not in keys
    return is_stereo or bool({"LEFT.K", "RIGHT.K", "Camera1.fx", "Camera2.fx", *POSES} & keys)


FORMAT = RigFormat("orbslam", "ORB-SLAM2 and ORB-SLAM3 stereo settings (YAML)", _recognises, _read)
