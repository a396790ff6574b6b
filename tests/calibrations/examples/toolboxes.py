"""Examples of what calibration toolboxes write: OpenCV, MATLAB, OCamCalib, BoofCV, anipose, MC-Calib."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rectbench import Camera
from tests.calibrations.calibration_files import (
    D1,
    D2,
    IMAGE,
    INTRINSICS,
    K1,
    K2,
    POSE,
    R_RIGHT_LEFT,
    T_RIGHT_LEFT,
    WHOLE_RIG,
    opencv_file,
)
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    PINHOLES,
    RADTAN1,
    RADTAN2,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    T_RL,
    UNIFIEDS,
    XI1,
    XI2,
    Example,
    matrix_block,
    rectification,
    rig,
)

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


def boofcv_four() -> Example:
    """With a fourth radial coefficient, of r⁸, as its calibration of wide lenses estimates it."""
    content = yaml.safe_load(boofcv().files["stereo.yaml"])
    rig = PINHOLES
    for side, k4 in (("left", -0.0003), ("right", 0.0002)):
        content[side]["radial_tangential"]["radial"] += [0.009, k4]
        params = {**getattr(rig, side).params, "k3": 0.009, "k4": k4}
        params = {n: v for n, v in params.items() if n in (*FOCAL, "k1", "k2", "k3", "k4", "p1", "p2")}
        rig = replace(rig, **{side: Camera("radial-tangential", SIZE, params)})
    return Example({"stereo.yaml": yaml.safe_dump(content)}, rig, options={"unit": "mm"})


def opencv(suffix: str) -> Example:
    return Example({f"stereo{suffix}": opencv_file(suffix, **WHOLE_RIG)}, FISHEYES)


def opencv_samples() -> Example:
    """samples/cpp/stereo_calib.cpp: no image size, a file for the pose, here with squares in millimetres."""
    R1, R2, P1, P2 = rectification()
    P2[0, 3] *= 1000
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


def opencv_left_right() -> Example:
    """As people write it from Python: K_left, D_left and so on, a list for each row."""
    content = {
        **{f"K_{side}": K.tolist() for side, K in (("left", K1), ("right", K2))},
        **{f"dist_{side}": [[*D, 0.0]] for side, D in (("left", RADTAN1), ("right", RADTAN2))},
        "R": R_RIGHT_LEFT.tolist(),
        "T": T_RIGHT_LEFT[:, None].tolist(),
        "image_size": list(SIZE),
        "reprojection_error": 0.65,
    }
    return Example({"stereo_calibration.json": json.dumps(content, indent=4)}, PINHOLES)


def opencv_sections() -> Example:
    """As people write it from Python: a section a camera, one for the pose, here in millimetres."""
    content = {
        "image_width": SIZE[0],
        "image_height": SIZE[1],
        **{
            f"{side}_camera": {"camera_matrix": K.tolist(), "distortion_coefficients": [D]}
            for side, K, D in (("right", K2, RADTAN2), ("left", K1, RADTAN1))
        },
        "stereo": {
            "rotation_matrix": R_RIGHT_LEFT.tolist(),
            "translation_vector": (1000 * T_RIGHT_LEFT[:, None]).tolist(),
        },
    }
    return Example({"stereo_calib.yaml": yaml.safe_dump(content)}, PINHOLES, options={"unit": "mm"})


def opencv_from_zero() -> Example:
    """Cameras 0 and 1: what is called 1 is the right one."""
    content = {"model": "fisheye", "K0": K1, "D0": D1, "K1": K2, "D1": D2, **POSE, **IMAGE}
    return Example({"stereo.yml": opencv_file(**content)}, FISHEYES)


T_WORLD_LEFT, T_WORLD_RIGHT = T_BODY_LEFT, T_BODY_RIGHT


def anipose() -> Example:
    """As anipose's calibration.toml, in millimetres, with the right camera first."""

    def table(number: int, name: str, K: np.ndarray, D: np.ndarray, T_world_camera: np.ndarray) -> str:
        T = np.linalg.inv(T_world_camera)
        return (
            f'[cam_{number}]\nname = "{name}"\nsize = [ {SIZE[0]}, {SIZE[1]},]\nmatrix = {K.tolist()}\n'
            f"distortions = [ {', '.join(map(str, D.ravel().tolist()))},]\n"
            f"rotation = {Rotation.from_matrix(T[:3, :3]).as_rotvec().tolist()}\n"
            f"translation = {(1000 * T[:3, 3]).tolist()}\nfisheye = true\n\n"
        )

    text = table(0, "B", K2, D2, T_WORLD_RIGHT) + table(1, "A", K1, D1, T_WORLD_LEFT)
    text += "[metadata]\nadjusted = false\nerror = 0.26297020272610133\n"
    return Example({"calibration.toml": text}, FISHEYES, options={"unit": "mm", "cameras": ["A", "B"]})


def caliscope() -> Example:
    """As caliscope's camera_array.toml: the tables under `cameras`."""
    tables = [
        f"[cameras.{port}]\nport = {port}\nsize = {list(SIZE)}\nmatrix = {K.tolist()}\n"
        f"distortions = {[*D, 0.0]}\ntranslation = {T[:3, 3].tolist()}\n"
        f"rotation = {Rotation.from_matrix(T[:3, :3]).as_rotvec().tolist()}\nignore = false\n"
        for port, K, D, T in (
            (0, K1, RADTAN1, np.linalg.inv(T_WORLD_LEFT)),
            (1, K2, RADTAN2, np.linalg.inv(T_WORLD_RIGHT)),
        )
    ]
    return Example({"camera_array.toml": "\n".join(tables)}, PINHOLES)


def mccalib() -> Example:
    """As MC-Calib's calibrated_cameras_data.yml: sections of cv::FileStorage."""
    text = "%YAML:1.0\n---\nnb_camera: 2\n"
    for number, K, D, T in ((0, K1, D1, T_WORLD_LEFT), (1, K2, D2, T_WORLD_RIGHT)):
        matrices = matrix_block("camera_matrix", K) + matrix_block("distortion_vector", D)
        matrices += "distortion_type: 1\ncamera_group: 0\n"
        matrices += f"img_width: {SIZE[0]}\nimg_height: {SIZE[1]}\n" + matrix_block("camera_pose_matrix", T)
        text += f"camera_{number}:\n" + "".join(f"   {line}\n" for line in matrices.splitlines())
    return Example({"calibrated_cameras_data.yml": text}, FISHEYES)


def easymocap() -> Example:
    """As EasyMocap's intri.yml and extri.yml."""
    names = '%YAML:1.0\n---\nnames:\n   - "1"\n   - "2"\n'
    intrinsics = extrinsics = names
    for name, K, D, T_world_camera in (("1", K1, RADTAN1, T_WORLD_LEFT), ("2", K2, RADTAN2, T_WORLD_RIGHT)):
        T = np.linalg.inv(T_world_camera)
        rotation = Rotation.from_matrix(T[:3, :3]).as_rotvec()
        intrinsics += matrix_block(f"K_{name}", K) + matrix_block(f"dist_{name}", np.array([[*D, 0.0]]))
        extrinsics += matrix_block(f"R_{name}", rotation[:, None]) + matrix_block(f"Rot_{name}", T[:3, :3])
        extrinsics += matrix_block(f"T_{name}", T[:3, 3:])
    files = {"intri.yml": intrinsics, "extri.yml": extrinsics}
    return Example(files, PINHOLES, ("extri.yml",), {"size": SIZE})


EXAMPLES: dict[str, Example] = {
    "ocamcalib": ocamcalib(),
    "matlab": matlab(),
    "matlab-fisheye": matlab_fisheyes(),
    "boofcv": boofcv(),
    "boofcv-four": boofcv_four(),
    "opencv-yaml": opencv(".yml"),
    "opencv-xml": opencv(".xml"),
    "opencv-json": opencv(".json"),
    "opencv-samples": opencv_samples(),
    "opencv-omnidir": opencv_omnidir(),
    "opencv-left-right": opencv_left_right(),
    "opencv-sections": opencv_sections(),
    "opencv-from-zero": opencv_from_zero(),
    "anipose": anipose(),
    "anipose-caliscope": caliscope(),
    "mccalib": mccalib(),
    "easymocap": easymocap(),
}
