"""stella_vslam's configuration of a stereo camera, with a `StereoRectifier` where it is not rectified yet.

`R_left` and `R_right` turn the cameras into the rectified frame, as `cv2.stereoRectify` gives them, and
`Camera.focal_x_baseline` is -P2[0][3], the rectified focal length times the baseline in metres. Hence

    R_right_left = R_right^T R_left,    t_right_left = R_right^T (-focal_x_baseline / fx, 0, 0).

Without a rectifier both cameras are the perspective one of `Camera`, side by side at that baseline.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, rig_of_posed, rigid, side_by_side, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

MODELS = {"perspective": "pinhole", "fisheye": "fisheye"}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    rectified = file.section("Camera", "the rectified camera")
    file.knows("Tracking", "Mapping")
    size = rectified.sides("cols", "rows", given.size)
    focal = rectified.number("fx", "pixels")
    shift = rectified.number("focal_x_baseline", "pixels times metres")
    if focal <= 0:
        raise rectified.fault("fx", "pixels above 0")
    if "StereoRectifier" not in file:
        return _rectified(rectified, size, shift / focal, given, sources[0].name)
    rectified.knows("model", "fy", "c[xy]", "[kp]?")  # of the rectified images
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
    camera = camera_of(file.at("fx"), "pinhole", size, params)
    return side_by_side(camera, camera, baseline, given, file.at("fx"), name)


def _read_posed(rectifier: Section, side: str, size: tuple[int, int], baseline: float) -> PosedCamera:
    lens = MODELS[rectifier.choice("model", MODELS, "perspective")]
    camera = opencv_camera(rectifier, f"K_{side}", f"D_{side}", lens, size)
    T_rect_camera = rigid(rectifier.rotation(f"R_{side}"), [baseline, 0.0, 0.0])
    return PosedCamera(rectifier.at(f"R_{side}"), camera, T_rect_camera)


def _recognises(source: Source) -> bool:
    camera = source.document.values.get("Camera") if source.keys else None
    is_stereo = isinstance(camera, dict) and camera.get("setup") == "stereo"
    return "StereoRectifier" in source.keys or is_stereo


FORMAT = RigFormat("stella", "stella_vslam configuration of a stereo camera (YAML)", _recognises, _read)
