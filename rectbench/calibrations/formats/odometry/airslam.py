"""AirSLAM's camera file of a stereo pair (YAML): `cam0` (left) and `cam1` (right), with their poses.

`distortion_type` is 0 of images that are undistorted already, whose coefficients AirSLAM does not use, 1 of
OpenCV's pinhole (k1 k2 p1 p2 k3), 2 of its fisheye (k1 k2 k3 k4 and a 0). `T` takes points of the camera to
the body where `T_type` is 0, as EuRoC's T_BS, and points of the body to the camera where it is 1, as Kalibr's
T_cam_imu; metres. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, inverse, rig_of_posed, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.odometry.kalibr import EQUI, FOCAL, RADTAN
from rectbench.rigs.rig import Rig

LENSES: dict[float, tuple[str, tuple[str, ...]]] = {
    0: ("pinhole", ()),
    1: ("pinhole", (*RADTAN, "k3")),
    2: ("kannala-brandt", EQUI),
}
TYPES = "0 (undistorted), 1 (radial-tangential) or 2 (equidistant)"
CAMERAS = ("cam0", "cam1")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    kind = file.number("distortion_type", TYPES)
    if kind not in LENSES:
        raise file.fault("distortion_type", TYPES)
    size = file.sides("image_width", "image_height", given.size)
    posed = [_read_posed(file.section(name, "a camera"), kind, size) for name in CAMERAS]
    return rig_of_posed(posed, given, source.name)


def _read_posed(section: Section, kind: float, size: tuple[int, int]) -> PosedCamera:
    model, order = LENSES[kind]
    params = section.named("intrinsics", FOCAL)
    expected = "five coefficients, the last 0 of a fisheye"
    coefficients = section.numbers("distortion_coeffs", expected, 5)
    if model == "kannala-brandt" and coefficients[4] != 0:
        raise section.fault("distortion_coeffs", expected)
    params |= dict(zip(order, coefficients, strict=False))
    T = section.rigid("T", "the pose of the camera, metres")
    way = section.number("T_type", "0 (from camera to body) or 1 (from body to camera)")
    if way not in (0, 1):
        raise section.fault("T_type", "0 (from camera to body) or 1 (from body to camera)")
    camera = camera_of(section.where, model, size, params)
    return PosedCamera(section.where, camera, inverse(T) if way else T)


def is_camera_file(source: Source) -> bool:
    """Whether a file has a camera with AirSLAM's way to say what its pose takes where."""
    if "distortion_type" not in source.keys:
        return False
    cameras = [source.document.values.get(name) for name in CAMERAS]
    return any(isinstance(camera, dict) and camera.keys() & {"T", "T_type"} for camera in cameras)


FORMAT = RigFormat("airslam", "AirSLAM camera file (YAML)", is_camera_file, _read)
