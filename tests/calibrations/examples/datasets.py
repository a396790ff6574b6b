"""Examples of what cameras and data sets come with: ROS, ZED, OAK, KITTI, KITTI-360, Middlebury."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rectbench import Camera, Rig
from tests.calibrations.calibration_files import D1, D2, K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    KITTI_RECTIFIED,
    PINHOLES,
    RADTAN,
    RADTAN1,
    RADTAN2,
    RATIONAL1,
    RATIONAL2,
    RATIONALS,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    T_RL,
    UNIFIEDS,
    XI1,
    XI2,
    Example,
    rectification,
    rig,
)
from tests.calibrations.examples.odometry import camodocal_mei


def ros_text(K: np.ndarray, D: list[float], model: str, R: np.ndarray, P: np.ndarray) -> str:
    """As camera_calibration_parsers writes it."""

    def matrix(array: Any) -> dict[str, Any]:
        array = np.atleast_2d(array)
        return {"rows": array.shape[0], "cols": array.shape[1], "data": array.ravel().tolist()}

    content = {
        "image_width": SIZE[0],
        "image_height": SIZE[1],
        "camera_name": "camera",
        "camera_matrix": matrix(K),
        "distortion_model": model,
        "distortion_coefficients": matrix(D),
        "rectification_matrix": matrix(R),
        "projection_matrix": matrix(P),
    }
    return yaml.safe_dump(content, sort_keys=False, default_flow_style=None)


def ros() -> Example:
    R1, R2, P1, P2 = rectification()
    files = {
        "left.yaml": ros_text(K1, RATIONAL1, "rational_polynomial", R1, P1),
        "right.yaml": ros_text(K2, RATIONAL2, "rational_polynomial", R2, P2),
    }
    return Example(files, RATIONALS, tuple(files))


def ros_message() -> Example:
    """As `ros2 topic echo` prints it."""
    R1, R2, P1, P2 = rectification()
    files = {
        name: yaml.safe_dump(
            {
                "header": {"frame_id": "camera"},
                "height": SIZE[1],
                "width": SIZE[0],
                "distortion_model": "equidistant",
                "d": D.ravel().tolist(),
                "k": K.ravel().tolist(),
                "r": R.ravel().tolist(),
                "p": P.ravel().tolist(),
            }
        )
        for name, K, D, R, P in (("left.yaml", K1, D1, R1, P1), ("right.yaml", K2, D2, R2, P2))
    }
    return Example(files, FISHEYES, tuple(files))


def kitti360() -> Example:
    table = "".join(
        f"{name}: {' '.join(map(repr, T[:3].ravel().tolist()))}\n"
        for name, T in (("image_00", np.eye(4)), ("image_02", T_BODY_LEFT), ("image_03", T_BODY_RIGHT))
    )
    files = {
        "calib_cam_to_pose.txt": table,
        "image_02.yaml": camodocal_mei(XI1, FOCAL1, RADTAN1),
        "image_03.yaml": camodocal_mei(XI2, FOCAL2, RADTAN2),
    }
    return Example(files, UNIFIEDS, ("calib_cam_to_pose.txt",))


def kitti() -> Example:
    lines = ["calib_time: 09-Jan-2012 13:57:47", "corner_dist: 9.950000e-02"]
    poses = ((np.eye(3), np.zeros(3)), (R_RIGHT_LEFT, T_RIGHT_LEFT))
    for number, K, D, (R, T) in zip((0, 1), (K1, K2), (RADTAN1, RADTAN2), poses, strict=True):
        for key, numbers in (("S", SIZE), ("K", K.ravel()), ("D", [*D, 0.0]), ("R", R.ravel()), ("T", T)):
            lines.append(f"{key}_0{number}: {' '.join(f'{float(value)!r}' for value in numbers)}")
    return Example({"calib_cam_to_cam.txt": "\n".join(lines) + "\n"}, PINHOLES)


def middlebury() -> Example:
    """Its cameras are rectified: no distortion, no rotation, one focal length."""
    text = (
        "cam0=[3997.684 0 1176.728; 0 3997.684 1011.728; 0 0 1]\n"
        "cam1=[3997.684 0 1307.839; 0 3997.684 1011.728; 0 0 1]\n"
        "doffs=131.111\nbaseline=193.001\nwidth=2964\nheight=1988\nndisp=280\nisint=0\n"
    )
    left, right = (
        Camera("pinhole", (2964, 1988), {"fx": 3997.684, "fy": 3997.684, "cx": cx, "cy": 1011.728})
        for cx in (1176.728, 1307.839)
    )
    return Example({"calib.txt": text}, Rig(left, right, np.eye(3), [-0.193001, 0, 0]))


def ost_text(name: str, K: np.ndarray, D: list[float], R: np.ndarray, P: np.ndarray) -> str:
    def rows(array: np.ndarray) -> str:
        return "\n".join(" ".join(map(repr, row)) for row in np.atleast_2d(array).tolist())

    return (
        f"# oST version 5.0 parameters\n\n\n[image]\n\nwidth\n{SIZE[0]}\n\nheight\n{SIZE[1]}\n\n[{name}]\n\n"
        f"camera matrix\n{rows(K)}\n\ndistortion\n{rows(np.array(D))}\n\n"
        f"rectification\n{rows(R)}\n\nprojection\n{rows(P)}\n\n"
    )


def ost() -> Example:
    """As camera_calibration writes an ost.txt of each camera."""
    R1, R2, P1, P2 = rectification()
    files = {
        "left.ini": ost_text("narrow_stereo/left", K1, RATIONAL1, R1, P1),
        "right.ini": ost_text("narrow_stereo/right", K2, RATIONAL2, R2, P2),
    }
    return Example(files, RATIONALS, tuple(files))


def ost_pair() -> Example:
    """As camera_calibration prints a stereo pair."""
    files = ost().files
    return Example({"ost.txt": files["left.ini"] + files["right.ini"]}, RATIONALS)


def zed() -> Example:
    """A SN<serial>.conf, of which zed_opencv_native.py makes K, D, R and T."""
    text = ""
    for resolution, scale in (("2K", 2.0), ("HD", 1.0)):
        for side, focal, radtan in (("LEFT", FOCAL1, RADTAN1), ("RIGHT", FOCAL2, RADTAN2)):
            names = zip((*FOCAL, *RADTAN), (*(scale * f for f in focal), *radtan), strict=True)
            text += f"[{side}_CAM_{resolution}]\n" + "".join(f"{name}={value!r}\n" for name, value in names)
            text += "k3=0\n\n"
    rx, cv, rz = Rotation.from_matrix(R_RIGHT_LEFT).as_rotvec().tolist()
    x, y, z = (1000 * T_RIGHT_LEFT).tolist()
    text += f"[STEREO]\nBaseline={-x!r}\nTY={y!r}\nTZ_HD={z!r}\nRX_HD={rx!r}\nCV_HD={cv!r}\nRZ_HD={rz!r}\n"
    text += "CV_2K=0.5\n\n[MISC]\nSensor_ID=0\n"
    left, right = (
        Camera("pinhole", (1280, 720), dict(zip((*FOCAL, *RADTAN), (*focal, *radtan), strict=True)))
        for focal, radtan in ((FOCAL1, RADTAN1), (FOCAL2, RADTAN2))
    )
    return Example({"SN1234.conf": text}, rig(left, right), options={"size": (1280, 720)})


def depthai() -> Example:
    """As depthai's eepromToJsonFile writes it: the left camera's chain leads over the right one to CAM_A."""

    def entry(socket: int, K: np.ndarray, D: np.ndarray, to: int, T: np.ndarray | None) -> list[Any]:
        pose = np.eye(4) if T is None else T
        extrinsics = {
            "rotationMatrix": [] if T is None else pose[:3, :3].tolist(),
            "specTranslation": {"x": 7.5, "y": 0.0, "z": 0.0},
            "toCameraSocket": to,
            "translation": dict(zip("xyz", (100 * pose[:3, 3]).tolist(), strict=True)),
        }
        camera = {
            "cameraType": 1,
            "distortionCoeff": [*D.ravel().tolist(), *[0.0] * 10],
            "extrinsics": extrinsics,
            "height": SIZE[1],
            "intrinsicMatrix": K.tolist(),
            "specHfovDeg": 150.0,
            "width": SIZE[0],
        }
        return [socket, camera]

    cameras = [
        entry(0, K1, D1, -1, None),
        entry(2, K2, D2, 0, T_BODY_RIGHT),
        entry(1, K1, D1, 2, T_RL),
    ]
    stereo = {"leftCameraSocket": 1, "rightCameraSocket": 2, "rectifiedRotationLeft": np.eye(3).tolist()}
    content = {"boardName": "OAK-D", "cameraData": cameras, "stereoRectificationData": stereo, "version": 7}
    return Example({"calib.json": json.dumps(content, indent=4)}, FISHEYES)


def kitti_rectified() -> Example:
    """The odometry benchmark's calib.txt of sequences 00 to 02."""
    shifts = {"P0": 0.0, "P1": -386.1448, "P2": 45.38225}
    text = "".join(
        f"{name}: 718.856 0 607.1928 {shift!r} 0 718.856 185.2157 0 0 0 1 0\n"
        for name, shift in shifts.items()
    )
    return Example({"calib.txt": text}, KITTI_RECTIFIED, options={"size": (1241, 376)})


EXAMPLES: dict[str, Example] = {
    "ros": ros(),
    "ros-message": ros_message(),
    "ost": ost(),
    "ost-pair": ost_pair(),
    "zed": zed(),
    "depthai": depthai(),
    "kitti": kitti(),
    "kitti-rectified": kitti_rectified(),
    "kitti360": kitti360(),
    "middlebury": middlebury(),
}
