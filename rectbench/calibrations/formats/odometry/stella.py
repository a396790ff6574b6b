"""stella_vslam's configuration of a stereo camera, with a `StereoRectifier` where it is not rectified yet.

`R_left` and `R_right` turn the cameras into the rectified frame, as `cv2.stereoRectify` gives them, and
`Camera.focal_x_baseline` is -P2[0][3], the rectified focal length times the baseline in metres. Hence

    R_right_left = R_right^T R_left,    t_right_left = R_right^T (-focal_x_baseline / fx, 0, 0).

Without a rectifier both cameras are the perspective one of `Camera`, side by side at that baseline.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import assembled, rig_of_posed, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, blaming
from rectbench.calibrations.formats.toolboxes.opencv import (
    CAMERA_MODELS,
    PINHOLE_COUNTS,
    camera_matrix,
    lens_parameters,
)
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

MODELS = {"perspective": "pinhole", "fisheye": "fisheye"}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    rectified = file.section("Camera", "the rectified camera")
    size = rectified.sides("cols", "rows", given.size)
    focal = rectified.number("fx", "pixels")
    shift = rectified.number("focal_x_baseline", "pixels times metres")
    if focal <= 0:
        raise rectified.fault("fx", "pixels above 0")
    if "StereoRectifier" not in file:
        return _rectified(rectified, size, shift / focal, given, sources[0].name)
    rectifier = file.section("StereoRectifier", "K, D and R of both cameras")
    left = _read_posed(rectifier, "left", size, 0.0)
    right = _read_posed(rectifier, "right", size, shift / focal)
    return rig_of_posed((left, right), given, sources[0].name)


def _rectified(file: Section, size: tuple[int, int], baseline: float, given: Given, name: str) -> Rig:
    params = {key: file.number(key, "pixels") for key in ("fx", "fy", "cx", "cy")}
    distortion = {key: file.number(key, "a number") for key in ("k1", "k2", "p1", "p2", "k3") if key in file}
    if file.values.get("model") != "perspective" or any(distortion.values()):
        raise InvalidInput(
            f"{file.at('model')} is not perspective without distortion; expected it, or a StereoRectifier"
        )
    with blaming(file.at("fx")):
        camera = Camera("pinhole", size, params)
    return assembled(camera, camera, rigid(np.eye(3), [-baseline, 0.0, 0.0]), given, file.at("fx"), name)


def _read_posed(rectifier: Section, side: str, size: tuple[int, int], baseline: float) -> PosedCamera:
    kind = rectifier.text("model", "perspective or fisheye") if "model" in rectifier else "perspective"
    if kind not in MODELS:
        raise rectifier.fault("model", "perspective or fisheye")
    lens = MODELS[kind]
    params = camera_matrix(rectifier, f"K_{side}", lens)
    params |= lens_parameters(rectifier, f"D_{side}", lens, PINHOLE_COUNTS if lens == "pinhole" else (4,))
    with blaming(rectifier.at(f"K_{side}")):
        camera = Camera(CAMERA_MODELS[lens], size, params)
    return PosedCamera(rectifier.at(f"R_{side}"), camera, rectified_pose(rectifier, f"R_{side}", baseline))


def rectified_pose(section: Section, key: str, baseline: float) -> FloatArray:
    """The pose from a camera to the rectified frame of the left one, `baseline` to its left."""
    R = section.array(key, "a 3x3 rotation", (9,)).reshape(3, 3)
    with blaming(section.at(key)):
        return rigid(checked_rotation(R, "it"), [baseline, 0.0, 0.0])


def _recognises(source: Source) -> bool:
    camera = source.document.values.get("Camera") if source.keys else None
    is_stereo = isinstance(camera, dict) and camera.get("setup") == "stereo"
    return "StereoRectifier" in source.keys or is_stereo


FORMAT = RigFormat("stella", "stella_vslam configuration of a stereo camera (YAML)", _recognises, _read)
