"""One made-up rig in every calibration format, each text written from the format's own documentation.

Two lenses differ in every number, the pose turns about all three axes, and the body that some formats
refer to stands askew, so that no transposed, inverted or swapped reading can pass.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rectbench import Camera, Rig
from tests.rigs.calibration_files import (
    D1,
    D2,
    INTRINSICS,
    K1,
    K2,
    POSE,
    R_RIGHT_LEFT,
    T_RIGHT_LEFT,
    WHOLE_RIG,
    opencv_file,
)

SIZE = (848, 800)
T_RL = np.eye(4)
T_RL[:3, :3], T_RL[:3, 3] = R_RIGHT_LEFT, T_RIGHT_LEFT
T_BODY_LEFT = np.eye(4)
T_BODY_LEFT[:3, :3] = Rotation.from_euler("xyz", [91, -3, 88], degrees=True).as_matrix()
T_BODY_LEFT[:3, 3] = [0.3, -0.02, 1.1]
T_BODY_RIGHT = T_BODY_LEFT @ np.linalg.inv(T_RL)

FOCAL1, FOCAL2 = ([float(K[i, j]) for i, j in ((0, 0), (1, 1), (0, 2), (1, 2))] for K in (K1, K2))
FOCAL = ("fx", "fy", "cx", "cy")
RADTAN1, RADTAN2 = [-0.28, 0.07, 2e-4, 1.8e-5], [-0.27, 0.06, -1e-4, 3e-5]
RATIONAL1 = [*RADTAN1, 0.01, 0.02, -0.03, 0.004]
RATIONAL2 = [*RADTAN2, 0.011, 0.019, -0.028, 0.003]
XI1, XI2 = 0.91, 0.89


@dataclass(frozen=True)
class Example:
    """Files by name, what of them is passed to `load_rig`, and the rig that comes out."""

    files: Mapping[str, str]
    rig: Rig
    paths: tuple[str, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)


def camera(model: str, names: tuple[str, ...], numbers: list[float], focal: list[float]) -> Camera:
    return Camera(model, SIZE, dict(zip((*FOCAL, *names), (*focal, *numbers), strict=True)))


def rig(left: Camera, right: Camera) -> Rig:
    return Rig(left, right, R_RIGHT_LEFT, T_RIGHT_LEFT)


KB = ("k1", "k2", "k3", "k4")
RADTAN = ("k1", "k2", "p1", "p2")
RATIONAL = (*RADTAN, "k3", "k4", "k5", "k6")
FISHEYES = rig(
    camera("kannala-brandt", KB, D1[0].tolist(), FOCAL1), camera("kannala-brandt", KB, D2[0].tolist(), FOCAL2)
)
PINHOLES = rig(camera("pinhole", RADTAN, RADTAN1, FOCAL1), camera("pinhole", RADTAN, RADTAN2, FOCAL2))
RATIONALS = rig(
    camera("pinhole", RATIONAL, RATIONAL1, FOCAL1), camera("pinhole", RATIONAL, RATIONAL2, FOCAL2)
)
UNIFIEDS = rig(
    camera("unified", ("xi", *RADTAN), [XI1, *RADTAN1], FOCAL1),
    camera("unified", ("xi", *RADTAN), [XI2, *RADTAN2], FOCAL2),
)
DOUBLE_SPHERES = rig(
    camera("double-sphere", ("xi", "alpha"), [-0.2, 0.59], FOCAL1),
    camera("double-sphere", ("xi", "alpha"), [-0.19, 0.6], FOCAL2),
)


def quaternion(T: np.ndarray) -> dict[str, float]:
    x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat()
    px, py, pz = T[:3, 3]
    return {"px": px, "py": py, "pz": pz, "qx": x, "qy": y, "qz": z, "qw": w}


def kalibr_camera(model: str, distortion: str, intrinsics: list[float], coefficients: list[float]) -> dict:
    return {
        "camera_model": model,
        "distortion_model": distortion,
        "intrinsics": intrinsics,
        "distortion_coeffs": coefficients,
        "resolution": list(SIZE),
    }


def kalibr() -> Example:
    left = kalibr_camera("omni", "radtan", [XI1, *FOCAL1], RADTAN1)
    right = kalibr_camera("omni", "radtan", [XI2, *FOCAL2], RADTAN2)
    right["T_cn_cnm1"] = T_RL.tolist()
    return Example({"camchain.yaml": yaml.safe_dump({"cam0": left, "cam1": right})}, UNIFIEDS)


def openvins() -> Example:
    left = kalibr_camera("pinhole", "equidistant", FOCAL1, D1[0].tolist())
    right = kalibr_camera("pinhole", "equidistant", FOCAL2, D2[0].tolist())
    left["T_cam_imu"] = np.linalg.inv(T_BODY_LEFT).tolist()
    right["T_imu_cam"] = T_BODY_RIGHT.tolist()
    text = "%YAML:1.0 # need to specify the file type at the top!\n\n"
    return Example({"chain.yaml": text + yaml.safe_dump({"cam0": left, "cam1": right})}, FISHEYES)


def basalt() -> Example:
    cameras = [
        {
            "camera_type": "ds",
            "intrinsics": dict(zip((*FOCAL, "xi", "alpha"), (*focal, *numbers), strict=True)),
        }
        for focal, numbers in ((FOCAL1, (-0.2, 0.59)), (FOCAL2, (-0.19, 0.6)))
    ]
    content = {
        "T_imu_cam": [quaternion(T_BODY_LEFT), quaternion(T_BODY_RIGHT)],
        "intrinsics": cameras,
        "resolution": [list(SIZE), list(SIZE)],
        "calib_accel_bias": [0.0] * 9,
        "vignette": [],
    }
    return Example({"calibration.json": json.dumps({"value0": content}, indent=4)}, DOUBLE_SPHERES)


def camodocal_mei(xi: float, focal: list[float], radtan: list[float]) -> str:
    return (
        "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: camera\n"
        f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\nmirror_parameters:\n   xi: {xi!r}\n"
        "distortion_parameters:\n"
        + "".join(f"   {name}: {value!r}\n" for name, value in zip(RADTAN, radtan, strict=True))
        + "projection_parameters:\n"
        + "".join(
            f"   {name}: {value!r}\n"
            for name, value in zip(("gamma1", "gamma2", "u0", "v0"), map(float, focal), strict=True)
        )
    )


def camodocal_kannala_brandt(focal: list[float], radial: list[float]) -> str:
    names = ("k2", "k3", "k4", "k5", "mu", "mv", "u0", "v0")
    return (
        "%YAML:1.0\n---\nmodel_type: KANNALA_BRANDT\ncamera_name: camera\n"
        f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\nprojection_parameters:\n"
        + "".join(
            f"   {name}: {float(value)!r}\n" for name, value in zip(names, (*radial, *focal), strict=True)
        )
    )


def matrix_block(key: str, matrix: np.ndarray) -> str:
    """As cv::FileStorage writes a matrix."""
    rows, columns = matrix.shape
    data = ", ".join(map(repr, matrix.ravel().tolist()))
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [{data}]\n"


def vins() -> Example:
    config = (
        '%YAML:1.0\n\n#common parameters\nnum_of_cam: 2\nimage0_topic: "/left/image_raw"\n'
        'cam0_calib: "left.yaml"\ncam1_calib: "right.yaml"\n'
        "estimate_extrinsic: 0   # 0  Have an accurate extrinsic parameters.\n"
        + matrix_block("body_T_cam0", T_BODY_LEFT)
        + matrix_block("body_T_cam1", T_BODY_RIGHT)
    )
    files = {
        "config.yaml": config,
        "left.yaml": camodocal_kannala_brandt(FOCAL1, D1[0].tolist()),
        "right.yaml": camodocal_kannala_brandt(FOCAL2, D2[0].tolist()),
    }
    return Example(files, FISHEYES, ("config.yaml",))


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


POSE_FILE = yaml.safe_dump({"R_right_left": R_RIGHT_LEFT.tolist(), "t_right_left": T_RIGHT_LEFT.tolist()})


def camodocal() -> Example:
    files = {
        "0.yaml": camodocal_mei(XI1, FOCAL1, RADTAN1),
        "1.yaml": camodocal_mei(XI2, FOCAL2, RADTAN2),
        "pose.yaml": POSE_FILE,
    }
    return Example(files, UNIFIEDS, tuple(files))


POLY1 = [-240.1, 0.0, 9.1e-4, -4.1e-7, 8.2e-10]
POLY2 = [-238.2, 0.0, 9.3e-4, -4.3e-7, 8.1e-10]
AFFINE1, AFFINE2 = (1.0003, -2.8e-4, -9.2e-4), (0.9998, 3.1e-4, 4.2e-4)


def ocam_text(poly: list[float], centre: list[float], affine: tuple[float, ...]) -> str:
    c, d, e = affine
    return (
        "#polynomial coefficients for the DIRECT mapping function (ocam_model.ss in MATLAB). "
        "These are used by cam2world\n\n"
        f"{len(poly)} {' '.join(map(repr, poly))} \n\n"
        "#polynomial coefficients for the inverse mapping function (ocam_model.invpol in MATLAB). "
        "These are used by world2cam\n\n3 380.1 250.2 7.03 \n\n"
        '#center: "row" and "column", starting from 0 (C convention)\n\n'
        f"{float(centre[1])!r} {float(centre[0])!r}\n\n"
        f'#affine parameters "c", "d", "e"\n\n{c} {d} {e}\n\n'
        f'#image size: "height" and "width"\n\n{SIZE[1]} {SIZE[0]}\n\n'
    )


def ocam_camera(poly: list[float], centre: list[float], affine: tuple[float, ...]) -> Camera:
    c, d, e = affine
    params = {"cx": centre[0], "cy": centre[1], "c": c, "d": d, "e": e}
    return Camera("ocam", SIZE, params | {"poly": poly, "inverse_poly": [380.1, 250.2, 7.03]})


def ocamcalib() -> Example:
    files = {
        "left.txt": ocam_text(POLY1, FOCAL1[2:], AFFINE1),
        "right.txt": ocam_text(POLY2, FOCAL2[2:], AFFINE2),
        "extrinsics.yml": opencv_file(**POSE),
    }
    left, right = ocam_camera(POLY1, FOCAL1[2:], AFFINE1), ocam_camera(POLY2, FOCAL2[2:], AFFINE2)
    return Example(files, rig(left, right), tuple(files))


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


def rectification() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """R1, R2, P1, P2 of the made-up pose: x along the baseline, as cv2.stereoRectify defines them."""
    baseline = np.linalg.norm(T_RIGHT_LEFT)
    x = -R_RIGHT_LEFT.T @ T_RIGHT_LEFT / baseline
    y = np.cross([0.0, 0.0, 1.0], x)
    y /= np.linalg.norm(y)
    R1 = np.stack([x, y, np.cross(x, y)])
    P1 = np.array([[300.0, 0, 400, 0], [0, 300, 390, 0], [0, 0, 1, 0]])
    P2 = P1.copy()
    P2[0, 3] = -300 * baseline
    return R1, R1 @ R_RIGHT_LEFT.T, P1, P2


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


def euroc() -> Example:
    def text(focal: list[float], radtan: list[float], T: np.ndarray) -> str:
        data = ", ".join(map(repr, T.ravel().tolist()))
        return (
            "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
            f"T_BS:\n  cols: 4\n  rows: 4\n  data: [{data}]\n\nrate_hz: 20\n"
            f"resolution: {list(SIZE)}\ncamera_model: pinhole\nintrinsics: {focal} #fu, fv, cu, cv\n"
            f"distortion_model: radial-tangential\ndistortion_coefficients: {radtan}\n"
        )

    files = {
        "cam0/sensor.yaml": text(FOCAL1, RADTAN1, T_BODY_LEFT),
        "cam1/sensor.yaml": text(FOCAL2, RADTAN2, T_BODY_RIGHT),
    }
    return Example(files, PINHOLES, tuple(files))


def matlab_pinhole(K: np.ndarray, radtan: list[float]) -> dict[str, Any]:
    shifted = K + np.array([[0, 0, 1], [0, 0, 1], [0, 0, 0]])
    return {
        "ImageSize": [SIZE[1], SIZE[0]],
        "RadialDistortion": radtan[:2],
        "TangentialDistortion": radtan[2:],
        "IntrinsicMatrix": shifted.T.tolist(),
        "WorldUnits": "millimeters",
    }


def matlab() -> Example:
    content = {
        "CameraParameters1": matlab_pinhole(K1, RADTAN1),
        "CameraParameters2": matlab_pinhole(K2, RADTAN2),
        "RotationOfCamera2": R_RIGHT_LEFT.T.tolist(),
        "TranslationOfCamera2": (1000 * T_RIGHT_LEFT).tolist(),
        "MeanReprojectionError": 0.12,
    }
    return Example({"stereoParams.json": json.dumps(content)}, PINHOLES)


def matlab_fisheye(poly: list[float], centre: list[float]) -> dict[str, Any]:
    a0, _, *higher = poly
    return {
        "Intrinsics": {
            "MappingCoefficients": [-a0, *[-a for a in higher]],
            "DistortionCenter": [centre[0] + 1, centre[1] + 1],
            "StretchMatrix": [[1, 0], [0, 1]],
            "ImageSize": [SIZE[1], SIZE[0]],
        },
        "WorldUnits": "mm",
    }


def matlab_fisheyes() -> Example:
    files = {
        "left.json": json.dumps(matlab_fisheye(POLY1, FOCAL1[2:])),
        "right.json": json.dumps(matlab_fisheye(POLY2, FOCAL2[2:])),
        "pose.json": json.dumps({"R": R_RIGHT_LEFT.tolist(), "T": T_RIGHT_LEFT.tolist()}),
    }
    left, right = (
        Camera("ocam", SIZE, {"cx": focal[2], "cy": focal[3], "poly": [-a for a in poly]})
        for focal, poly in ((FOCAL1, POLY1), (FOCAL2, POLY2))
    )
    return Example(files, rig(left, right), tuple(files))


def boofcv() -> Example:
    def side(focal: list[float], radtan: list[float]) -> dict[str, Any]:
        pinhole = dict(zip(FOCAL, map(float, focal), strict=True))
        return {
            "model": "pinhole_radial_tangential",
            "pinhole": pinhole | {"width": SIZE[0], "height": SIZE[1], "skew": 0.0},
            "radial_tangential": {"radial": radtan[:2], "t1": radtan[2], "t2": radtan[3]},
        }

    T_left_right = np.linalg.inv(T_RL)
    x, y, z = (1000 * T_left_right[:3, 3]).tolist()
    pose = {"rotation": T_left_right[:3, :3].ravel().tolist(), "x": x, "y": y, "z": z}
    content = {
        "model": "stereo_camera",
        "left": side(FOCAL1, RADTAN1),
        "right": side(FOCAL2, RADTAN2),
        "rightToLeft": pose,
    }
    return Example({"stereo.yaml": yaml.safe_dump(content)}, PINHOLES, options={"unit": "mm"})


def orbslam3() -> Example:
    lines = ['%YAML:1.0\nFile.version: "1.0"\nCamera.type: "KannalaBrandt8"']
    for number, focal, radial in ((1, FOCAL1, D1[0]), (2, FOCAL2, D2[0])):
        lines += [
            f"Camera{number}.{name}: {float(value)!r}"
            for name, value in zip((*FOCAL, *KB), (*focal, *radial), strict=True)
        ]
    lines += [f"Camera.width: {SIZE[0]}", f"Camera.height: {SIZE[1]}", "Stereo.ThDepth: 40.0"]
    pose = matrix_block("Stereo.T_c1_c2", np.linalg.inv(T_RL))
    return Example({"TUM-VI.yaml": "\n".join(lines) + "\n" + pose}, FISHEYES)


def orbslam2() -> Example:
    R1, R2, P1, P2 = rectification()
    text = "%YAML:1.0\nCamera.fx: 300.0\nCamera.bf: 33.0\n"
    for side, K, D, R, P in (("LEFT", K1, RADTAN1, R1, P1), ("RIGHT", K2, RADTAN2, R2, P2)):
        text += f"{side}.height: {SIZE[1]}\n{side}.width: {SIZE[0]}\n"
        text += matrix_block(f"{side}.D", np.array([[*D, 0.0]])).replace("data: [", "data:[")
        text += matrix_block(f"{side}.K", K) + matrix_block(f"{side}.R", R) + matrix_block(f"{side}.P", P)
    return Example({"EuRoC.yaml": text}, PINHOLES)


def stella() -> Example:
    R1, R2, _, P2 = rectification()
    content = {
        "Camera": {
            "name": "TUM VI stereo",
            "setup": "stereo",
            "model": "perspective",
            "fx": 300.0,
            "cols": SIZE[0],
            "rows": SIZE[1],
            "focal_x_baseline": float(-P2[0, 3]),
        },
        "StereoRectifier": {
            "model": "fisheye",
            **{f"K_{side}": K.ravel().tolist() for side, K in (("left", K1), ("right", K2))},
            **{f"D_{side}": D.ravel().tolist() for side, D in (("left", D1), ("right", D2))},
            **{f"R_{side}": R.ravel().tolist() for side, R in (("left", R1), ("right", R2))},
        },
    }
    return Example({"stereo.yaml": yaml.safe_dump(content)}, FISHEYES)


def opencv(suffix: str) -> Example:
    return Example({f"stereo{suffix}": opencv_file(suffix, **WHOLE_RIG)}, FISHEYES)


def opencv_samples() -> Example:
    """samples/cpp/stereo_calib.cpp: no image size, a file for the pose, here with squares in millimetres."""
    R1, R2, P1, P2 = rectification()
    rectified = {"R1": R1, "R2": R2, "P1": P1, "P2": P2, "Q": np.eye(4)}
    distortion = {"D1": np.array([[*RADTAN1, 0.0]]), "D2": np.array([[*RADTAN2, 0.0]])}
    files = {
        "intrinsics.yml": opencv_file(**(INTRINSICS | distortion)),
        "extrinsics.yml": opencv_file(R=R_RIGHT_LEFT, T=1000 * T_RIGHT_LEFT, **rectified),
    }
    return Example(files, PINHOLES, tuple(files), {"size": SIZE, "unit": "mm"})


def opencv_omnidir() -> Example:
    """ccalib's omni_stereo_calibration.cpp: the pose is six numbers, rotation vector and translation."""
    rvec = Rotation.from_matrix(R_RIGHT_LEFT).as_rotvec()
    text = opencv_file(
        ".xml",
        calibration_time="Thu Nov 20 2025",
        nFrames=20,
        camera_matrix_1=K1,
        distortion_coefficients_1=np.array([RADTAN1]),
        xi_1=XI1,
        camera_matrix_2=K2,
        distortion_coefficients_2=np.array([RADTAN2]),
        xi_2=XI2,
        extrinsic_parameters=np.array([[*rvec, *T_RIGHT_LEFT]]),
        extrinsic_parameters_1=np.zeros((20, 6)),
        rms=0.3,
        image_points_1=np.zeros((20, 54, 2)),
    )
    return Example({"omni.xml": text}, UNIFIEDS, options={"size": SIZE})


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


EXAMPLES: dict[str, Example] = {
    "kalibr": kalibr(),
    "openvins": openvins(),
    "basalt": basalt(),
    "vins": vins(),
    "kitti360": kitti360(),
    "kitti": kitti(),
    "middlebury": middlebury(),
    "camodocal": camodocal(),
    "ocamcalib": ocamcalib(),
    "ros": ros(),
    "ros-message": ros_message(),
    "euroc": euroc(),
    "matlab": matlab(),
    "matlab-fisheye": matlab_fisheyes(),
    "boofcv": boofcv(),
    "orbslam3": orbslam3(),
    "orbslam2": orbslam2(),
    "stella": stella(),
    "opencv-yaml": opencv(".yml"),
    "opencv-xml": opencv(".xml"),
    "opencv-json": opencv(".json"),
    "opencv-samples": opencv_samples(),
    "opencv-omnidir": opencv_omnidir(),
}
