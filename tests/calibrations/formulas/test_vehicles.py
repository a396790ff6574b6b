"""DriveWorks', NuRec's, Isaac Sim's, WoodScape's and the data sets' formulas, against what is read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from tests.calibrations.formulas.agreement import (
    assert_agrees,
    content,
    rig_of,
    rotation_of_wxyz,
    transformation,
)


def polynomial(coefficients: list[float], x: Any) -> Any:
    return sum(a * x**power for power, a in enumerate(coefficients))


def distance(theta: np.ndarray, poly: list[float], by_distance: bool) -> np.ndarray:
    """Pixels from the centre of rays at these angles; a polynomial in the distance is solved for it."""
    if not by_distance:
        return np.asarray(polynomial(poly, theta))
    roots = [brentq(lambda r, t=t: polynomial(poly, r) - t, 0, 900, xtol=1e-12) for t in theta]
    return np.array(roots)


def f_theta_pixel(
    X: np.ndarray, poly: list[float], by_distance: bool, centre: Any, cde: Any = (1, 0, 0)
) -> np.ndarray:
    """The radius along the ray's direction, stretched by [c d; e 1], about the centre."""
    xy = np.linalg.norm(X[:, :2], axis=1)
    x, y = X[:, :2].T / xy * distance(np.arctan2(xy, X[:, 2]), poly, by_distance)
    c, d, e = cde
    return np.stack([c * x + d * y, e * x + y], -1) + centre


def own(shared: np.ndarray, T_shared_camera: np.ndarray) -> np.ndarray:
    return (shared - T_shared_camera[:3, 3]) @ T_shared_camera[:3, :3]


def test_drive(tmp_path: Path) -> None:
    """x forward, y left, z up; the ray of a pixel goes through pixel + 0.5 - cx."""
    _, left, right = content("drive")["rig"]["sensors"]

    def pose(sensor: Any) -> np.ndarray:
        nominal = sensor["nominalSensor2Rig_FLU"]
        turn = sensor.get("correction_sensor_R_FLU", {"roll-pitch-yaw": [0, 0, 0]})["roll-pitch-yaw"]
        t = np.add(nominal["t"], sensor.get("correction_rig_T", [0, 0, 0]))
        rotations = []
        for roll, pitch, yaw in (nominal["roll-pitch-yaw"], turn):
            parts = [
                Rotation.from_rotvec(np.radians(angle) * axis)
                for angle, axis in zip((roll, pitch, yaw), np.eye(3), strict=True)
            ]
            rotations.append((parts[2] * parts[1] * parts[0]).as_matrix())
        camera_axes = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # right, down, forward in the sensor's
        return transformation(rotations[0] @ rotations[1] @ camera_axes, t)

    def projection(sensor: Any, key: str, by_distance: bool) -> Any:
        lens = sensor["properties"]
        poly = [float(word) for word in lens[key].split()]
        centre = [float(lens["cx"]) - 0.5, float(lens["cy"]) - 0.5]
        return lambda shared: f_theta_pixel(own(shared, pose(sensor)), poly, by_distance, centre)

    rig = rig_of("drive", tmp_path)
    assert_agrees(
        rig, pose(left), projection(left, "bw-poly", True), projection(right, "polynomial", False), 55.0
    )


def test_nurec(tmp_path: Path) -> None:
    """FThetaCameraModel of 3DGUT: the reference polynomial, linear_cde, pixels from a pixel's centre."""
    left, right = content("nurec")["camera_calibrations"].values()

    def projection(entry: Any, key: str) -> Any:
        lens = entry["camera_model"]["parameters"]
        T = np.array(entry["T_sensor_rig"])
        by_distance = lens["reference_poly"] == "PIXELDIST_TO_ANGLE"
        arguments = (lens[key], by_distance, lens["principal_point"], lens["linear_cde"])
        return lambda shared: f_theta_pixel(own(shared, T), *arguments)

    assert_agrees(
        rig_of("nurec", tmp_path),
        np.array(left["T_sensor_rig"]),
        projection(left, "pixeldist_to_angle_poly"),
        projection(right, "angle_to_pixeldist_poly"),
        55.0,
    )


def test_isaac(tmp_path: Path) -> None:
    """Rows times the view transform; the fisheye's polynomial is of pixels of its nominal image."""
    left = content("isaac", "camera_params_left.json")
    right = content("isaac", "camera_params_right.json")
    metres, (width, height) = left["metersPerSceneUnit"], left["renderProductResolution"]

    def in_camera(file: Any, shared: np.ndarray) -> np.ndarray:
        rows = np.c_[shared / metres, np.ones(len(shared))] @ np.reshape(file["cameraViewTransform"], (4, 4))
        return rows[:, :3] * [1, -1, -1] * metres

    def fisheye(shared: np.ndarray) -> np.ndarray:
        nominal = f_theta_pixel(
            in_camera(left, shared), left["cameraFisheyePolynomial"], True, left["cameraFisheyeOpticalCentre"]
        )
        return nominal * width / left["cameraFisheyeNominalWidth"] - 0.5

    def pinhole(shared: np.ndarray) -> np.ndarray:
        X = in_camera(right, shared)
        focal = right["cameraFocalLength"] / right["cameraAperture"][0] * width
        return X[:, :2] / X[:, 2:] * focal + np.array([width, height]) / 2 - 0.5

    view = np.reshape(left["cameraViewTransform"], (4, 4))
    scene_from_camera = np.linalg.inv(view.T) @ np.diag([1, -1, -1, 1])
    shared_from_left = transformation(scene_from_camera[:3, :3], metres * scene_from_camera[:3, 3])
    assert_agrees(rig_of("isaac", tmp_path), shared_from_left, fisheye, pinhole, 55.0)


def test_woodscape(tmp_path: Path) -> None:
    """projection.py: the radius by the angle's powers, the aspect on v, offsets from the middle less half."""
    left, right = (content("woodscape", f"{side}.json") for side in ("left", "right"))

    def pose(file: Any) -> np.ndarray:
        x, y, z, w = file["extrinsic"]["quaternion"]
        return transformation(rotation_of_wxyz(w, x, y, z), file["extrinsic"]["translation"])

    def projection(file: Any) -> Any:
        lens = file["intrinsic"]
        poly = [0.0, *(lens[f"k{power}"] for power in range(1, 5))]

        def project(shared: np.ndarray) -> np.ndarray:
            plane = f_theta_pixel(own(shared, pose(file)), poly, False, [0, 0])
            size = np.array([lens["width"], lens["height"]])
            offsets = [lens["cx_offset"], lens["cy_offset"]]
            return plane * [1, lens["aspect_ratio"]] + 0.5 * size + offsets - 0.5

        return project

    assert_agrees(rig_of("woodscape", tmp_path), pose(left), projection(left), projection(right), 70.0)


def pinhole_pixel(X: np.ndarray, fx: float, fy: float, cx: float, cy: float) -> np.ndarray:
    return X[:, :2] / X[:, 2:] * [fx, fy] + [cx, cy]


def test_nuscenes(tmp_path: Path) -> None:
    """The devkit: points of the vehicle less the translation, turned back, then K."""
    _, left, right = content("nuscenes", "calibrated_sensor.json")

    def pose(record: Any) -> np.ndarray:
        return transformation(rotation_of_wxyz(*record["rotation"]), record["translation"])

    def projection(record: Any) -> Any:
        (fx, _, cx), (_, fy, cy), _ = record["camera_intrinsic"]
        return lambda shared: pinhole_pixel(own(shared, pose(record)), fx, fy, cx, cy)

    rig = rig_of("nuscenes", tmp_path)
    assert_agrees(rig, pose(left), projection(left), projection(right), 35.0)
    assert rig.left.size == (1600, 900)


@pytest.mark.parametrize("name", ["argoverse", "argoverse-two"])
def test_argoverse(tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture) -> None:
    """Calibration of both: the camera's pose in the vehicle, K without distortion."""
    if name == "argoverse":
        values = [entry["value"] for entry in content(name)["camera_data_"][1:]]
        axes = [f"focal_{what}_{axis}_px_" for what in ("length", "center") for axis in "xy"]
        lenses = [[value[key] for key in axes] for value in values]
        poses = [
            transformation(
                rotation_of_wxyz(*value["vehicle_SE3_camera_"]["rotation"]["coefficients"]),
                value["vehicle_SE3_camera_"]["translation"],
            )
            for value in values
        ]
    else:
        rows, columns = content(name), content(name, "egovehicle_SE3_sensor.json")
        lenses = [[row[f"{key}_px"] for key in ("fx", "fy", "cx", "cy")] for row in rows]
        places = {sensor: place for place, sensor in columns["sensor_name"].items()}
        keys = [places[row["sensor_name"]] for row in rows]
        poses = [
            transformation(
                rotation_of_wxyz(*(columns[f"q{part}"][key] for part in "wxyz")),
                [columns[f"t{axis}_m"][key] for axis in "xyz"],
            )
            for key in keys
        ]
    left, right = (
        lambda shared, T=T, lens=lens: pinhole_pixel(own(shared, T), *lens)
        for T, lens in zip(poses, lenses, strict=True)
    )
    assert_agrees(rig_of(name, tmp_path), poses[0], left, right, 35.0)
    assert "left out, as Argoverse's images are undistorted" in caplog.text
