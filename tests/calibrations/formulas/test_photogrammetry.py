"""Metashape's, OpenMVG's, AliceVision's and nerfstudio's formulas, written anew, against what is read."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest

from tests.calibrations.examples import EXAMPLES
from tests.calibrations.formulas.agreement import assert_agrees, content, rig_of, transformation


def metashape_pixel(sensor: ElementTree.Element, X: np.ndarray) -> np.ndarray:
    """Appendix "Camera models" of Metashape's manual; its pixels are half a pixel further."""
    calibration = sensor.findall("calibration")[1]
    n = {child.tag: float(child.text or 0) for child in calibration if child.tag != "resolution"}
    f, cx, cy, b1, b2, k1, k2, k3, k4, p1, p2 = (
        n.get(key, 0.0) for key in ("f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2")
    )
    resolution = calibration.find("resolution")
    assert resolution is not None
    w, h = (int(resolution.get(side, "0")) for side in ("width", "height"))
    x, y = (X[:, :2] / X[:, 2:]).T
    if calibration.get("type") == "fisheye":
        r0 = np.hypot(x, y)
        x, y = x * np.arctan(r0) / r0, y * np.arctan(r0) / r0
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3 + k4 * r2**4
    xd = x * radial + p1 * (r2 + 2 * x * x) + 2 * p2 * x * y
    yd = y * radial + p2 * (r2 + 2 * y * y) + 2 * p1 * x * y
    return np.stack([w * 0.5 + cx + xd * (f + b1) + yd * b2, h * 0.5 + cy + yd * f], -1) - 0.5


@pytest.mark.parametrize(("name", "angle_deg"), [("metashape", 35.0), ("metashape-fisheye", 60.0)])
def test_metashape(tmp_path: Path, name: str, angle_deg: float) -> None:
    text = EXAMPLES[name].files["cameras.xml"]
    chunk = ElementTree.fromstring(text).find("chunk")
    assert chunk is not None
    scale = float(chunk.findtext("components/component/transform/scale", "1"))
    sensors = chunk.findall("sensors/sensor")
    poses = [
        np.array(camera.findtext("transform", "").split(), float).reshape(4, 4)
        for camera in chunk.iter("camera")
        if camera.find("transform") is not None
    ]

    def projection(number: int) -> Any:
        def project(shared: np.ndarray) -> np.ndarray:
            in_chunk = np.c_[shared / scale, np.ones(len(shared))]
            return metashape_pixel(sensors[number], (in_chunk @ np.linalg.inv(poses[number]).T)[:, :3])

        return project

    shared_from_left = poses[0].copy()
    shared_from_left[:3, 3] *= scale
    assert_agrees(rig_of(name, tmp_path), shared_from_left, projection(0), projection(1), angle_deg)


def opencv_pixel(lens: dict[str, Any], names: tuple[str, ...], X: np.ndarray) -> np.ndarray:
    """nerfstudio hands its lens to OpenCV, with half a pixel taken off the centre."""
    K = np.array([[lens["fl_x"], 0, lens["cx"] - 0.5], [0, lens["fl_y"], lens["cy"] - 0.5], [0, 0, 1]])
    D = np.array([lens.get(name, 0.0) for name in names], float)
    project = cv2.fisheye.projectPoints if len(D) == 4 and "k4" in names else cv2.projectPoints
    pixels, _ = project(X[:, None], np.zeros(3), np.zeros(3), K, D)
    return np.asarray(pixels)[:, 0]


@pytest.mark.parametrize(
    ("name", "names"),
    [("transforms", ("k1", "k2", "k3", "k4")), ("transforms-ngp", ("k1", "k2", "p1", "p2", "k3"))],
)
def test_transforms(tmp_path: Path, name: str, names: tuple[str, ...]) -> None:
    document = content(name)
    poses = [np.array(frame["transform_matrix"]) for frame in document["frames"]]

    def projection(number: int) -> Any:
        def project(shared: np.ndarray) -> np.ndarray:
            own = (shared - poses[number][:3, 3]) @ poses[number][:3, :3]
            # y up and z back: the camera looks along its -z
            return opencv_pixel({**document, **document["frames"][number]}, names, own * [1, -1, -1])

        return project

    shared_from_left = transformation(poses[0][:3, :3] * [1, -1, -1], poses[0][:3, 3])
    assert_agrees(rig_of(name, tmp_path), shared_from_left, projection(0), projection(1), 35.0)


def test_instant_ngp_s_f_theta_rays(tmp_path: Path) -> None:
    """Of pixels: f_theta_undistortion takes the place from the principal point, in pixels, to a ray."""
    document, rig = content("transforms-f-theta"), rig_of("transforms-f-theta", tmp_path)
    pixels = np.random.default_rng(2).uniform([150, 150], [700, 650], (100, 2))
    x, y = (pixels + 0.5 - [document["cx"], document["cy"]]).T
    norm = np.hypot(x, y)
    alpha = sum(document[f"ftheta_p{power}"] * norm**power for power in range(5))
    expected = np.stack([np.sin(alpha) * x / norm, np.sin(alpha) * y / norm, np.cos(alpha)], -1)
    np.testing.assert_allclose(rig.left.unproject(pixels)[0], expected, atol=1e-12)


def openmvg_data(entry: Any) -> dict[str, Any]:
    """The object of a cereal pointer, its bases' members beside its own."""
    data = dict(entry["value"]["ptr_wrapper"]["data"])
    while "value0" in data:
        data |= data.pop("value0")
    return data


def test_openmvg(tmp_path: Path) -> None:
    """Camera_Pinhole_Fisheye.hpp on Pose3: R (X - C), then the angle's polynomial, then f and the centre."""
    document = content("openmvg")
    lenses = [openmvg_data(entry) for entry in document["intrinsics"]]
    poses = [entry["value"] for entry in document["extrinsics"]]

    def projection(number: int) -> Any:
        def project(shared: np.ndarray) -> np.ndarray:
            X = (shared - poses[number]["center"]) @ np.transpose(poses[number]["rotation"])
            p = X[:, :2] / X[:, 2:]
            r = np.linalg.norm(p, axis=1, keepdims=True)
            theta = np.arctan(r)
            k1, k2, k3, k4 = lenses[number]["fisheye"]
            bent = theta + k1 * theta**3 + k2 * theta**5 + k3 * theta**7 + k4 * theta**9
            return lenses[number]["focal_length"] * p * bent / r + lenses[number]["principal_point"]

        return project

    R, C = np.array(poses[0]["rotation"]), np.array(poses[0]["center"])
    assert_agrees(rig_of("openmvg", tmp_path), transformation(R.T, C), projection(0), projection(1), 60.0)


def alicevision_R_C(pose: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Eigen stores a matrix column by column, and saveMatrix writes it as it is stored."""
    R = np.array(pose["rotation"], float).reshape(3, 3, order="F")
    return R, np.array(pose["center"], float)


def test_alicevision(tmp_path: Path) -> None:
    """jsonIO.cpp, IntrinsicScaleOffset.cpp and DistortionBrown.cpp of version 1.2.5 and later."""
    document = content("alicevision")
    poses = [alicevision_R_C(entry["pose"]["transform"]) for entry in document["poses"]]

    def projection(number: int) -> Any:
        lens = document["intrinsics"][number]
        w, h = int(lens["width"]), int(lens["height"])
        fx = float(lens["focalLength"]) / float(lens["sensorWidth"]) * w
        fy = fx * float(lens["pixelRatio"])
        ox, oy = (float(word) for word in lens["principalPoint"])
        k1, k2, k3, t1, t2 = (float(word) for word in lens["distortionParams"])
        R, C = poses[number]

        def project(shared: np.ndarray) -> np.ndarray:
            X = (shared - C) @ R.T
            x, y = (X[:, :2] / X[:, 2:]).T
            r2 = x * x + y * y
            k = k1 * r2 + k2 * r2**2 + k3 * r2**3
            xd = x + x * k + t2 * (r2 + 2 * x * x) + 2 * t1 * x * y
            yd = y + y * k + t1 * (r2 + 2 * y * y) + 2 * t2 * x * y
            return np.stack([fx * xd + ox + w / 2, fy * yd + oy + h / 2], -1)

        return project

    R, C = poses[0]
    assert_agrees(rig_of("alicevision", tmp_path), transformation(R.T, C), projection(0), projection(1), 35.0)


def test_alicevision_s_rigs(tmp_path: Path) -> None:
    """A view stands at sub-pose times rig pose; fisheye4 and fisheye1 bend the pinhole's radius."""
    document = content("alicevision-rig")
    R_rig, C_rig = alicevision_R_C(document["poses"][0]["pose"]["transform"])
    inner = [alicevision_R_C(entry["pose"]) for entry in document["rigs"][0]["subPoses"]]

    def bent(kind: str, numbers: list[float], r: np.ndarray) -> np.ndarray:
        if kind == "fisheye1":
            return np.arctan(2 * r * np.tan(numbers[0] / 2)) / numbers[0]
        theta = np.arctan(r)
        return theta + sum(k * theta ** (2 * n + 3) for n, k in enumerate(numbers))

    def projection(number: int) -> Any:
        lens = document["intrinsics"][number]
        R, C = inner[number]

        def project(shared: np.ndarray) -> np.ndarray:
            X = ((shared - C_rig) @ R_rig.T - C) @ R.T
            p = X[:, :2] / X[:, 2:]
            r = np.linalg.norm(p, axis=1, keepdims=True)
            plane = p * bent(lens["type"], lens["distortionParams"], r) / r
            return lens["pxFocalLength"] * plane + lens["principalPoint"]

        return project

    R, C = inner[0]
    shared_from_left = transformation(R_rig.T, C_rig) @ transformation(R.T, C)
    assert_agrees(rig_of("alicevision-rig", tmp_path), shared_from_left, projection(0), projection(1), 50.0)
