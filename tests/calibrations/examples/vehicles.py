"""Examples of cars and their simulators: NVIDIA's f-theta cameras, WoodScape, nuScenes, Argoverse."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from scipy.spatial.transform import Rotation

from rectbench import Camera, Rig
from tests.calibrations.calibration_files import K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples.made_up import (
    FOCAL,
    FOCAL1,
    FOCAL2,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    Example,
    rig,
)

CENTRE1, CENTRE2 = ({"cx": focal[2], "cy": focal[3]} for focal in (FOCAL1, FOCAL2))
BACKWARD1, BACKWARD2 = [0.0, 3.4e-3, 2.1e-7, 1.6e-9, -4e-13], [0.0, 3.5e-3, 1.9e-7, 1.5e-9, -3e-13]
FORWARD1, FORWARD2 = [0.0, 290.0, -3.0, 6.0, -4.0], [0.0, 288.0, -2.0, 5.0, -3.0]
CDE = [1.002, 3e-4, -2e-4]
R_FLU_CAMERA = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])


def plain(focal: list[float], size: tuple[int, int] = SIZE) -> Camera:
    return Camera("pinhole", size, dict(zip(FOCAL, focal, strict=True)))


def by_angle(centre: dict[str, float], forward: list[float]) -> Camera:
    """The lens of a radius in pixels by the powers of the angle."""
    about_90_deg = Polynomial(forward)(Polynomial([np.pi / 2, 1.0])).coef
    return Camera("ocam", SIZE, {**centre, "inverse_poly": about_90_deg})


def wxyz(T: np.ndarray) -> list[float]:
    x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat().tolist()
    return [w, x, y, z]


def drive() -> Example:
    """As DriveWorks has it, words and degrees; a correction turns and moves the right camera."""

    def sensor(name: str, properties: dict[str, str], T: np.ndarray, **correction: Any) -> dict[str, Any]:
        R = T[:3, :3] @ R_FLU_CAMERA.T
        if "correction_sensor_R_FLU" in correction:
            angles = correction["correction_sensor_R_FLU"]["roll-pitch-yaw"]
            R = R @ Rotation.from_euler("xyz", angles, degrees=True).as_matrix().T
        t = T[:3, 3] - correction.get("correction_rig_T", np.zeros(3))
        turn = Rotation.from_matrix(R).as_euler("xyz", degrees=True).tolist()
        lens = {"Model": "ftheta", "width": str(SIZE[0]), "height": str(SIZE[1])} | properties
        pose = {"roll-pitch-yaw": turn, "t": t.tolist()}
        return {"name": name, "protocol": "camera.virtual", "properties": lens} | {
            "nominalSensor2Rig_FLU": pose,
            **correction,
        }

    def words(numbers: list[float]) -> str:
        return " ".join(map(repr, numbers))

    left = {"cx": repr(FOCAL1[2] + 0.5), "cy": repr(FOCAL1[3] + 0.5), "bw-poly": words(BACKWARD1)}
    right = {"cx": repr(FOCAL2[2] + 0.5), "cy": repr(FOCAL2[3] + 0.5), "polynomial": words(FORWARD2)}
    right |= {"polynomial-type": "angle-to-pixeldistance"}
    correction = {
        "correction_sensor_R_FLU": {"roll-pitch-yaw": [-0.15, -0.01, 0.23]},
        "correction_rig_T": [0.08, 0.009, 0.01],
    }
    sensors = [
        {"name": "lidar:front", "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0, 0, 0], "t": [1, 0, 2]}},
        sensor("camera:left", left, T_BODY_LEFT),
        sensor("camera:right", right, T_BODY_RIGHT, **correction),
    ]
    cameras = (
        Camera("f-theta", SIZE, {**CENTRE1, "angle_poly": BACKWARD1[1:]}),
        by_angle(CENTRE2, FORWARD2),
    )
    return Example({"rig.json": json.dumps({"rig": {"sensors": sensors, "vehicle": {}}})}, rig(*cameras))


def nurec() -> Example:
    """As NuRec's rig_trajectories.json: both polynomials, of which the reference counts, and a stretch."""

    def entry(name: str, lens: dict[str, Any], T: np.ndarray) -> dict[str, Any]:
        parameters = {
            "resolution": list(SIZE),
            "shutter_type": "ROLLING_TOP_TO_BOTTOM",
            "external_distortion_parameters": None,
            **lens,
            "max_angle": 1.3,
            "linear_cde": CDE,
        }
        return {
            "sequence_id": "clip",
            "logical_sensor_name": name,
            "unique_sensor_idx": 0,
            "T_sensor_rig": T.tolist(),
            "camera_model": {"type": "ftheta", "parameters": parameters},
        }

    left = {
        "principal_point": FOCAL1[2:],
        "reference_poly": "PIXELDIST_TO_ANGLE",
        "pixeldist_to_angle_poly": BACKWARD1,
        "angle_to_pixeldist_poly": [0.0, 300.0],
    }
    right = {
        "principal_point": FOCAL2[2:],
        "reference_poly": "ANGLE_TO_PIXELDIST",
        "pixeldist_to_angle_poly": [0.0, 1 / 300],
        "angle_to_pixeldist_poly": FORWARD2,
    }
    content = {
        "rig_trajectories": [],
        "camera_calibrations": {
            "camera_left@clip": entry("camera_left", left, T_BODY_LEFT),
            "camera_right@clip": entry("camera_right", right, T_BODY_RIGHT),
        },
    }
    c, d, e = CDE
    affine = {"e": d / c, "d": e / c, "c": 1 / c}
    backward = [a / c**power for power, a in enumerate(BACKWARD1)]
    forward = [c * b for b in FORWARD2]
    edge = np.degrees(1.3)
    cameras = (
        Camera("f-theta", SIZE, {**CENTRE1, **affine, "angle_poly": backward[1:]}, edge),
        Camera("ocam", SIZE, {**by_angle(CENTRE2, forward).params, **affine}, edge),
    )
    return Example({"rig_trajectories.json": json.dumps(content)}, rig(*cameras))


ISAAC_METRES = 0.01


def isaac_file(lens: dict[str, Any], T_world_camera: np.ndarray) -> str:
    """As Replicator's BasicWriter saves a camera's parameters, in scene units of a centimetre."""
    T = np.linalg.inv(T_world_camera @ np.diag([1.0, -1.0, -1.0, 1.0]))
    T[:3, 3] /= ISAAC_METRES
    content = {
        "cameraAperture": [20.955, 15.29],
        "cameraApertureOffset": [0.0, 0.0],
        "cameraFocalLength": 24.0,
        "cameraFocusDistance": 400.0,
        "cameraNearFar": [1.0, 1000000.0],
        "cameraViewTransform": T.T.ravel().tolist(),
        "metersPerSceneUnit": ISAAC_METRES,
        "renderProductResolution": list(SIZE),
        **lens,
    }
    return json.dumps(content)


def isaac() -> Example:
    """A fisheye whose polynomial is that of an image twice as large, and a pinhole."""
    twice = [a / 2**power for power, a in enumerate(BACKWARD1)]
    fisheye = {
        "cameraModel": "fisheyePolynomial",
        "cameraFisheyeMaxFOV": 170.0,
        "cameraFisheyeNominalWidth": 2 * SIZE[0],
        "cameraFisheyeNominalHeight": 2 * SIZE[1],
        "cameraFisheyeOpticalCentre": [2 * (FOCAL1[2] + 0.5), 2 * (FOCAL1[3] + 0.5)],
        "cameraFisheyePolynomial": twice,
    }
    files = {
        "camera_params_left.json": isaac_file(fisheye, T_BODY_LEFT),
        "camera_params_right.json": isaac_file({"cameraModel": "pinhole"}, T_BODY_RIGHT),
    }
    focal = 24.0 / 20.955 * SIZE[0]
    cameras = (
        Camera("f-theta", SIZE, {**CENTRE1, "angle_poly": BACKWARD1[1:]}, max_angle_deg=85.0),
        plain([focal, focal, (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2]),
    )
    return Example(files, rig(*cameras))


def woodscape() -> Example:
    """As WoodScape's calibration files: offsets from the middle, a quaternion with w last."""

    def text(focal: list[float], poly: list[float], aspect: float, T: np.ndarray) -> str:
        w, *xyz = wxyz(T)
        lens = {
            "aspect_ratio": aspect,
            "cx_offset": focal[2] - (SIZE[0] - 1) / 2,
            "cy_offset": focal[3] - (SIZE[1] - 1) / 2,
            "height": float(SIZE[1]),
            **{f"k{power}": number for power, number in enumerate(poly) if power},
            "model": "radial_poly",
            "poly_order": 4,
            "width": float(SIZE[0]),
        }
        pose = {"quaternion": [*xyz, w], "translation": T[:3, 3].tolist()}
        return json.dumps({"extrinsic": pose, "intrinsic": lens, "name": "FV"}, indent=4)

    files = {
        "left.json": text(FOCAL1, FORWARD1, 1.01, T_BODY_LEFT),
        "right.json": text(FOCAL2, FORWARD2, 1.0, T_BODY_RIGHT),
    }
    left = by_angle(CENTRE1, FORWARD1)
    cameras = (Camera("ocam", SIZE, {**left.params, "c": 1.01}), by_angle(CENTRE2, FORWARD2))
    return Example(files, rig(*cameras))


NUSCENES = (1600, 900)


def nuscenes() -> Example:
    """As the tables of nuScenes, of which a lidar's record has no lens."""

    def record(token: str, K: list[Any], T: np.ndarray) -> dict[str, Any]:
        pose = {"translation": T[:3, 3].tolist(), "rotation": wxyz(T)}
        return {"token": f"c{token}", "sensor_token": f"s{token}", **pose, "camera_intrinsic": K}

    sensors = [
        {"token": f"s{place}", "channel": channel, "modality": "camera"}
        for place, channel in enumerate(("LIDAR_TOP", "CAM_LEFT", "CAM_RIGHT"))
    ]
    records = [
        record("0", [], np.eye(4)),
        record("1", K1.tolist(), T_BODY_LEFT),
        record("2", K2.tolist(), T_BODY_RIGHT),
    ]
    files = {"calibrated_sensor.json": json.dumps(records, indent=0), "sensor.json": json.dumps(sensors)}
    cameras = (plain(FOCAL1, NUSCENES), plain(FOCAL2, NUSCENES))
    return Example(files, Rig(*cameras, R_RIGHT_LEFT, T_RIGHT_LEFT), ("calibrated_sensor.json",))


def argoverse_one() -> Example:
    """As Argoverse 1's vehicle_calibration_info.json, whose images are undistorted."""

    def entry(name: str, focal: list[float], T: np.ndarray) -> dict[str, Any]:
        fx, fy, cx, cy = focal
        value = {
            "focal_length_x_px_": fx,
            "focal_length_y_px_": fy,
            "focal_center_x_px_": cx,
            "focal_center_y_px_": cy,
            "skew_": 0,
            "distortion_coefficients_": [-0.17, 0.12, -0.03],
            "vehicle_SE3_camera_": {
                "rotation": {"coefficients": wxyz(T)},
                "translation": T[:3, 3].tolist(),
            },
        }
        return {"key": f"image_raw_{name}", "value": value}

    content = {
        "camera_data_": [
            entry("ring_front_center", FOCAL2, np.eye(4)),
            entry("stereo_front_left", FOCAL1, T_BODY_LEFT),
            entry("stereo_front_right", FOCAL2, T_BODY_RIGHT),
        ],
        "vehicle_SE3_down_lidar_": {},
    }
    size = (2464, 2056)
    cameras = (plain(FOCAL1, size), plain(FOCAL2, size))
    files = {"vehicle_calibration_info.json": json.dumps(content)}
    asked = {"cameras": ["stereo_front_left", "stereo_front_right"]}
    return Example(files, Rig(*cameras, R_RIGHT_LEFT, T_RIGHT_LEFT), options=asked)


def argoverse_two() -> Example:
    """The tables of Argoverse 2 as pandas' to_json writes them: one as rows, one as columns."""
    names = ("ring_side_left", "ring_front_left")
    lenses = [
        {
            "sensor_name": name,
            **{f"{key}_px": number for key, number in zip(FOCAL, focal, strict=True)},
            **{"k1": -0.24, "k2": -0.21, "k3": 0.32, "height_px": SIZE[1], "width_px": SIZE[0]},
        }
        for name, focal in zip(names, (FOCAL1, FOCAL2), strict=True)
    ]
    rows = [
        {
            "sensor_name": name,
            **dict(zip(("qw", "qx", "qy", "qz"), wxyz(T), strict=True)),
            **dict(zip(("tx_m", "ty_m", "tz_m"), T[:3, 3].tolist(), strict=True)),
        }
        for name, T in (("up_lidar", np.eye(4)), (names[1], T_BODY_RIGHT), (names[0], T_BODY_LEFT))
    ]
    columns = {key: {str(place): row[key] for place, row in enumerate(rows)} for key in rows[0]}
    files = {"intrinsics.json": json.dumps(lenses), "egovehicle_SE3_sensor.json": json.dumps(columns)}
    return Example(files, rig(plain(FOCAL1), plain(FOCAL2)))


EXAMPLES: dict[str, Example] = {
    "drive": drive(),
    "nurec": nurec(),
    "isaac": isaac(),
    "woodscape": woodscape(),
    "nuscenes": nuscenes(),
    "argoverse": argoverse_one(),
    "argoverse-two": argoverse_two(),
}
