"""ROS `camera_info` YAML, a file a camera, as camera_calibration_parsers or `topic echo` write it.

K and D hold for the raw image. The pose is in the rectification that the two files share
(sensor_msgs/CameraInfo): R turns the camera into the rectified frame, and P = [K' | K' o] has the
place o of that frame in its last column, P[0, 3] = -fx' B for the right camera of a stereo pair: a
point X of the pair's frame is R X_camera = X + o. Hence

    R_right_left = R_right^T R_left,    t_right_left = R_right^T (o_right - o_left).

Two files of cameras calibrated alone have P[:, 3] = 0; they want a third file with the pose.
What ROS' calibrator of fisheyes makes of P, `rectified_pair` says. Translations are metres. plumb_bob,
rational_polynomial and thin_prism_model are OpenCV's pinhole, equidistant and fisheye OpenCV's fisheye, whose
K may have a skew; camera_calibration wrote them under `camera_model` for years.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rectbench.calibrations.assembling import rigid
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source, errors_at
from rectbench.calibrations.formats.toolboxes.opencv import (
    COUNTS,
    FOCAL,
    ORDERS,
    distortion_of,
    opencv_camera,
)
from rectbench.calibrations.layouts import layout_of
from rectbench.calibrations.rectified_pair import is_turned, matrix_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray
from rectbench.yaml_text import yaml_text

KEYS = {
    "K": ("camera_matrix", "K", "k"),
    "D": ("distortion_coefficients", "D", "d"),
    "R": ("rectification_matrix", "R", "r"),
    "P": ("projection_matrix", "P", "p"),
}
MODELS = {
    "plumb_bob": "pinhole",
    "rational_polynomial": "pinhole",
    "thin_prism_model": "pinhole",
    "equidistant": "fisheye",
    "fisheye": "fisheye",
    "kannala_brandt": "fisheye",
    "pinhole": "pinhole",
}
LAYOUTS = {
    "plumb_bob": ("pinhole", (*FOCAL, *ORDERS["pinhole"][:5])),
    "rational_polynomial": ("pinhole", (*FOCAL, *ORDERS["pinhole"][:8])),
    "equidistant": ("kannala-brandt", (*FOCAL, *ORDERS["fisheye"], "skew")),
}
"""The models that sensor_msgs/distortion_models names and image_geometry takes, which are written."""


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file and, where its projection matrix tells, its place in the rectified frame."""
    return posed_of(source.document, given)


def posed_of(file: Section, given: Given) -> PosedCamera:
    """The same of the content of a file."""
    lens = _read_lens(file)
    K, D = _key(file, "K"), _key(file, "D")
    width, height = ("image_width", "image_height") if "image_width" in file else ("width", "height")
    size = file.sides(width, height, given.size)
    camera = opencv_camera(file, K, D, lens, size, f"{file.at(K)}, {D}", (0, *COUNTS[lens]))
    return rectified(PosedCamera(file.where, camera), file, _key(file, "R"), _key(file, "P"))


def _read_lens(file: Section) -> str:
    """The lens, by `distortion_model` or by what camera_calibration called it for years, `camera_model`."""
    key = "camera_model" if "camera_model" in file and "distortion_model" not in file else "distortion_model"
    lens = MODELS[file.choice(key, MODELS, "plumb_bob")]
    if "camera_model" in file and MODELS[file.choice("camera_model", MODELS)] not in (lens, "pinhole"):
        raise file.fault("camera_model", f"a {lens}, as distortion_model says")
    return lens


def rectified(posed: PosedCamera, file: Section, R_key: str, P_key: str) -> PosedCamera:
    """The camera in its pair's rectified frame; as it is where the file does not tell of one."""
    if P_key not in file or R_key not in file:
        return posed
    P = file.array(P_key, "the 3x4 projection matrix", (12,)).reshape(3, 4)
    R = file.array(R_key, "the 3x3 rectification matrix", (9,)).reshape(3, 3)
    if not np.any(R) or not np.any(P):  # how an uncalibrated camera is published
        return posed
    with errors_at(file.at(R_key)):
        R = checked_rotation(R, "it")
    focal = P[[0, 1, 2], [0, 1, 2]]
    if is_turned(P, R, posed.camera):
        return replace(posed, T_shared_camera=rigid(R, [0.0, 0.0, 0.0]), projection=P)
    if not (np.all(focal > 0) and focal[2] == 1):
        raise InvalidInput(
            f"{file.at(P_key)} has no focal length; expected [fx 0 cx Tx; 0 fy cy Ty; 0 0 1 0]"
        )
    with errors_at(file.at(P_key)):
        T_rect_camera = rigid(R, -np.linalg.solve(P[:, :3], P[:, 3]))
    return replace(posed, T_shared_camera=T_rect_camera, projection=P)


def _key(file: Section, what: str) -> str:
    """The name that the file has for K, D, R or P."""
    return next((key for key in KEYS[what] if key in file), KEYS[what][0])


def _recognises(source: Source) -> bool:
    keys = source.keys
    is_info = "projection_matrix" in keys or {"rectification_matrix", "camera_matrix"} <= keys
    is_message = "distortion_model" in keys and ({"K", "P"} <= keys or {"k", "p"} <= keys)
    return is_info or is_message or {"distortion_model", "camera_matrix"} <= keys


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """The two camera_info files, with a rectification R, P that holds the pose.

    The rectified frame has x along the baseline and z as near to the left camera's as that leaves; P's focal
    length is the smaller of the left camera's two.
    """
    layouts = [
        layout_of(camera, LAYOUTS, "ros", side) for side, camera in (("left", rig.left), ("right", rig.right))
    ]
    R_rect_left = _along_baseline(rig.centre_right_in_left)
    left = layouts[0][1]
    focal = min(left.params["fx"], left.params["fy"])
    K = np.array([[focal, 0, (left.width - 1) / 2], [0, focal, (left.height - 1) / 2], [0, 0, 1]])
    places = (("left", R_rect_left, 0.0), ("right", R_rect_left @ rig.R_right_left.T, rig.baseline_m))
    return {
        f"{side}.yaml": yaml_text(_info(side, model, camera, R, np.c_[K, [-focal * baseline, 0, 0]]))
        for (side, R, baseline), (model, camera) in zip(places, layouts, strict=True)
    }


def _along_baseline(centre: FloatArray) -> FloatArray:
    x = centre / np.linalg.norm(centre)
    z = np.array([0.0, 0.0, 1.0]) - x[2] * x
    z = z if np.linalg.norm(z) > 1e-6 else np.array([1.0, 0.0, 0.0]) - x[0] * x
    z /= np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z])


def _info(side: str, model: str, camera: Camera, R: FloatArray, P: FloatArray) -> dict[str, Any]:
    return {
        "image_width": camera.width,
        "image_height": camera.height,
        "camera_name": side,
        "camera_matrix": _matrix(matrix_of(camera)),
        "distortion_model": model,
        "distortion_coefficients": _matrix(np.array([distortion_of(camera, MODELS[model])])),
        "rectification_matrix": _matrix(R),
        "projection_matrix": _matrix(P),
    }


def _matrix(matrix: FloatArray) -> dict[str, Any]:
    return {"rows": matrix.shape[0], "cols": matrix.shape[1], "data": matrix.ravel().tolist()}


FORMAT = CameraFormat(
    "ros",
    "ROS camera_info (YAML; two files)",
    _recognises,
    read_posed,
    write=Writing(_texts, in_folder=True),
)
