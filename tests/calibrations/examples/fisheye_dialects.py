"""Examples of how tools write fisheyes in files that are mostly a pinhole's: ZED, AirVO, AirSLAM, ROS."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rectbench import Rig
from tests.calibrations.calibration_files import D1, D2, K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT, opencv_file
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    KB,
    PINHOLES,
    RADTAN1,
    RADTAN2,
    RATIONAL,
    RATIONAL1,
    RATIONAL2,
    RATIONALS,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    Example,
    matrix_block,
    rectification,
)

T_MM = (1000 * T_RIGHT_LEFT).tolist()
ROTATION_VECTOR = Rotation.from_matrix(R_RIGHT_LEFT).as_rotvec()
SKEW1, SKEW2 = -0.96, 0.51


def sized(rig: Rig, size: tuple[int, int]) -> Rig:
    return replace(rig, left=replace(rig.left, size=size), right=replace(rig.right, size=size))


def ini(name: str, names: tuple[str, ...], numbers: list[float]) -> str:
    lines = "".join(f"{key} = {value!r}\n" for key, value in zip(names, numbers, strict=True))
    return f"[{name}]\n{lines}\n"


def zed(resolution: str, names: tuple[str, ...], left: list[float], right: list[float]) -> str:
    """As `saveCalibZED` of zed-opencv-calibration writes a pair of ZED X One cameras."""
    rx, cv, rz = ROTATION_VECTOR.tolist()
    poses = {"Baseline": -T_MM[0], "TY": T_MM[1], "TZ": T_MM[2]}
    poses |= {f"CV_{resolution}": cv, f"RX_{resolution}": rx, f"RZ_{resolution}": rz}
    return (
        ini(f"LEFT_CAM_{resolution}", FOCAL, FOCAL1)
        + ini(f"RIGHT_CAM_{resolution}", FOCAL, FOCAL2)
        + ini("LEFT_DISTO", names, left)
        + ini("RIGHT_DISTO", names, right)
        + ini("STEREO", tuple(poses), list(poses.values()))
    )


def zed_opencv(left: np.ndarray, right: np.ndarray, end: str) -> str:
    """As its `saveCalibOpenCV` does."""
    text = opencv_file(
        K_LEFT=K1,
        K_RIGHT=K2,
        **{f"D_LEFT{end}": left.reshape(-1, 1), f"D_RIGHT{end}": right.reshape(-1, 1)},
        R=ROTATION_VECTOR.reshape(3, 1),
        T=np.array(T_MM).reshape(3, 1),
    )
    return text.replace("---\n", f"---\nSize: [ {SIZE[0]}, {SIZE[1]} ]\n", 1)


def airvo() -> Example:
    """As configs/oivio.yaml of AirVO."""
    R1, R2, P1, P2 = rectification()
    text = f"%YAML:1.0\nimage_height: {SIZE[1]}\nimage_width: {SIZE[0]}\nbf: {-P2[0, 3]!r}\n"
    text += "depth_lower_thr: 0.1\ndistortion_type: 1\n"
    for side, K, D, R, P in (("LEFT", K1, D1, R1, P1), ("RIGHT", K2, D2, R2, P2)):
        for key, matrix in (("D", D), ("K", K), ("R", R), ("P", P)):
            text += matrix_block(f"{side}.{key}", matrix)
    return Example({"oivio.yaml": text}, FISHEYES)


def airslam() -> Example:
    """As configs/camera/oivio.yaml of AirSLAM; the right camera's pose is the other way round."""
    content = {"image_height": SIZE[1], "image_width": SIZE[0], "use_imu": 0, "distortion_type": 2}
    cameras = (
        ("cam0", FOCAL1, D1, 0, T_BODY_LEFT),
        ("cam1", FOCAL2, D2, 1, np.linalg.inv(T_BODY_RIGHT)),
    )
    for name, focal, radial, way, T in cameras:
        content[name] = {
            "intrinsics": focal,
            "distortion_coeffs": [*radial[0].tolist(), 0],
            "T_type": way,
            "T": T.tolist(),
        }
    return Example({"oivio.yaml": yaml.safe_dump(content)}, FISHEYES)


def ros_fisheye(
    model_key: str, P1: np.ndarray, P2: np.ndarray, skews: tuple[float, float] = (0, 0)
) -> Example:
    """As camera_calibration writes a fisheye pair."""
    R1, R2, _, _ = rectification()
    files = {}
    for name, K, skew, D, R, P in (
        ("left.yaml", K1, skews[0], D1, R1, P1),
        ("right.yaml", K2, skews[1], D2, R2, P2),
    ):
        skewed = K + skew * np.array([[0, 1, 0], [0, 0, 0], [0, 0, 0]])
        matrices = {"camera_matrix": skewed, "distortion_coefficients": D}
        matrices |= {"rectification_matrix": R, "projection_matrix": P}
        content = {
            "image_width": SIZE[0],
            "image_height": SIZE[1],
            "camera_name": name,
            model_key: "equidistant",
        }
        content |= {
            key: {"rows": len(matrix), "cols": matrix.shape[1], "data": matrix.ravel().tolist()}
            for key, matrix in matrices.items()
        }
        files[name] = yaml.safe_dump(content, sort_keys=False)
    left, right = (
        replace(camera, params={**camera.params, "skew": float(skew)})
        for camera, skew in zip((FISHEYES.left, FISHEYES.right), skews, strict=True)
    )
    return Example(files, replace(FISHEYES, left=left, right=right), tuple(files))


def stereo_rectified(balance: float) -> tuple[np.ndarray, np.ndarray]:
    """P1 and P2 of cv2.fisheye.stereoRectify."""
    given = (K1, D1[0], K2, D2[0], SIZE, R_RIGHT_LEFT, T_RIGHT_LEFT.reshape(3, 1))
    flags = {"flags": cv2.CALIB_ZERO_DISPARITY, "newImageSize": SIZE, "balance": balance}
    _, _, P1, P2, _ = cv2.fisheye.stereoRectify(*given, **flags)
    return P1, P2


def ros_today() -> Example:
    R1, R2, _, _ = rectification()
    P1, P2 = stereo_rectified(0.0)
    P1[:, :3], P2[:, :3] = K1 @ R1, K2 @ R2
    return ros_fisheye("distortion_model", P1, P2)


def ros_own_focal() -> Example:
    P1, P2 = stereo_rectified(0.3)
    for P, K in ((P1, K1), (P2, K2)):
        P[0, 0] = P[1, 1] = K[0, 0]
    return ros_fisheye("distortion_model", P1, P2)


_, _, P1, P2 = rectification()
GS, ONE_4K = (1920, 1200), (3840, 2160)
EXAMPLES: dict[str, Example] = {
    "zed-fisheye": Example(
        {"SN30.conf": zed("FHD1200", KB, D1[0].tolist(), D2[0].tolist())}, sized(FISHEYES, GS)
    ),
    "zed-radtan": Example(
        {"SN30.conf": zed("FHD1200", RATIONAL, RATIONAL1, RATIONAL2)}, sized(RATIONALS, GS)
    ),
    "zed-4k": Example({"SN30.conf": zed("4k", KB, D1[0].tolist(), D2[0].tolist())}, sized(FISHEYES, ONE_4K)),
    "zed-opencv": Example({"zed_calibration_30.yml": zed_opencv(D1, D2, "_FE")}, FISHEYES),
    "zed-opencv-radtan": Example(
        {"zed_calibration_30.yml": zed_opencv(np.array([*RADTAN1, 0.0]), np.array([*RADTAN2, 0.0]), "")},
        PINHOLES,
    ),
    "orbslam-airvo": airvo(),
    "airslam": airslam(),
    "ros-camera-model": ros_fisheye("camera_model", P1, P2),
    "ros-skew": ros_fisheye("distortion_model", P1, P2, (SKEW1, SKEW2)),
    "ros-fisheye-today": ros_today(),
    "ros-fisheye-own-focal": ros_own_focal(),
}
