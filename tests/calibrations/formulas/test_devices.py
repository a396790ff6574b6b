"""librealsense's, Project Aria's and facebook360_dep's formulas, written anew, against what is read."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.calibrations.examples import EXAMPLES
from tests.calibrations.formulas.agreement import (
    assert_agrees,
    content,
    rig_of,
    rotation_of_wxyz,
    transformation,
)


def realsense_streams(text: str, size: str) -> dict[str, tuple[list[float], list[float]]]:
    """fx, fy, ppx, ppy and the coefficients of each stream of that size."""
    found = {}
    for block in text.split(' Intrinsic of "')[1:]:
        if f"/ {size} /" in block and "PPX" in block:
            focal = [float(re.findall(rf"{key}: +\t(\S+)", block)[0]) for key in ("Fx", "Fy", "PPX", "PPY")]
            coefficients = [float(word) for word in re.findall(r"Coeffs: (.*)", block)[0].split()]
            found[block.partition('"')[0]] = (focal, coefficients)
    return found


def rs2_project(kind: str, focal: list[float], k: list[float], X: np.ndarray) -> np.ndarray:
    """rs2_project_point_to_pixel in librealsense's rsutil.h."""
    fx, fy, ppx, ppy = focal
    x, y = (X[:, :2] / X[:, 2:]).T
    if kind == "kannala-brandt":
        r = np.hypot(x, y)
        theta = np.arctan(r)
        t2 = theta * theta
        rd = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))
        x, y = x * rd / r, y * rd / r
    else:
        r2 = x * x + y * y
        f = 1 + k[0] * r2 + k[1] * r2 * r2 + k[4] * r2**3
        dx = x * f + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)
        dy = y * f + 2 * k[3] * x * y + k[2] * (r2 + 2 * y * y)
        x, y = dx, dy
    return np.stack([x * fx + ppx, y * fy + ppy], -1)


@pytest.mark.parametrize(
    ("name", "kind", "pair", "angle_deg"),
    [
        ("realsense", "kannala-brandt", ("Fisheye 1", "Fisheye 2"), 60.0),
        ("realsense-d400", "brown", ("Infrared 1", "Infrared 2"), 35.0),
    ],
)
def test_realsense(tmp_path: Path, name: str, kind: str, pair: tuple[str, str], angle_deg: float) -> None:
    text = str(next(iter(EXAMPLES[name].files.values())))
    (focal1, k1), (focal2, k2) = (realsense_streams(text, "848x800")[stream] for stream in pair)
    source, target, numbers = re.findall(
        rf'from "({"|".join(pair)})"\s+To\s+"({"|".join(pair)})" :\n Rotation Matrix:\n(.*?)\n\n',
        text.replace("\n\n Translation Vector:", "\n"),
        re.DOTALL,
    )[-1]
    values = np.array(numbers.split(), float)
    R, t = values[:9].reshape(3, 3), values[9:]

    def left(shared: np.ndarray) -> np.ndarray:
        return rs2_project(kind, focal1, k1, shared)

    def right(shared: np.ndarray) -> np.ndarray:
        # rs2_transform_point_to_point: to = R from + t
        own = shared @ R.T + t if source == pair[0] else (shared - t) @ R
        return rs2_project(kind, focal2, k2, own)

    assert {source, target} == set(pair)
    assert_agrees(rig_of(name, tmp_path), np.eye(4), left, right, angle_deg)


@pytest.mark.parametrize(
    ("name", "kind", "angle_deg"),
    [("realsense-json", "kannala-brandt", 60.0), ("realsense-json-plain", "brown", 35.0)],
)
def test_realsense_json(tmp_path: Path, name: str, kind: str, angle_deg: float) -> None:
    """rs2_extrinsics: nine numbers are the rotation's columns; to = R from + t."""
    file = content(name)
    if kind == "brown":
        one, two = (file[side]["intrinsics"] for side in ("left", "right"))
        R, t = np.array(file["extrinsics"]["rotation"]), np.array(file["extrinsics"]["translation"])
    else:
        one, two = file["intrinsics"].values()
        back = file["extrinsics"]["fisheye_2_to_fisheye_1"]
        R = np.reshape(back["rotation"], (3, 3))  # its rows are the columns of R_1_2
        t = -R @ back["translation"]

    def projection(lens: Any, R: np.ndarray, t: np.ndarray) -> Any:
        focal = [lens[key] for key in ("fx", "fy", "ppx", "ppy")]
        return lambda shared: rs2_project(kind, focal, lens["coeffs"], shared @ R.T + t)

    left, right = projection(one, np.eye(3), np.zeros(3)), projection(two, R, t)
    assert_agrees(rig_of(name, tmp_path), np.eye(4), left, right, angle_deg)


def fisheye624_pixel(params: list[float], X: np.ndarray) -> np.ndarray:
    """FisheyeRadTanThinPrism of projectaria_tools: radial, then tangential and thin-prism terms."""
    f, cx, cy, *rest = params
    k, (p0, p1), (s0, s1, s2, s3) = rest[:6], rest[6:8], rest[8:]
    ab = X[:, :2] / X[:, 2:]
    r = np.linalg.norm(ab, axis=1)
    th = np.arctan(r)
    radial = th * (1 + sum(number * th ** (2 * place + 2) for place, number in enumerate(k)))
    x, y = radial / r * ab.T
    q = x * x + y * y
    u = x + 2 * x * (x * p0 + y * p1) + p0 * q + s0 * q + s1 * q * q
    v = y + 2 * y * (x * p0 + y * p1) + p1 * q + s2 * q + s3 * q * q
    return np.stack([f * u + cx, f * v + cy], -1)


def test_aria(tmp_path: Path) -> None:
    entries = {entry["Label"]: entry for entry in content("aria")["CameraCalibrations"]}
    left, right = (entries[f"camera-slam-{side}"] for side in ("left", "right"))

    def pose(entry: Any) -> np.ndarray:
        w, xyz = entry["T_Device_Camera"]["UnitQuaternion"]
        return transformation(rotation_of_wxyz(w, *xyz), entry["T_Device_Camera"]["Translation"])

    def projection(entry: Any) -> Any:
        device_from_camera = pose(entry)

        def project(shared: np.ndarray) -> np.ndarray:
            own = (shared - device_from_camera[:3, 3]) @ device_from_camera[:3, :3]
            return fisheye624_pixel(entry["Projection"]["Params"], own)

        return project

    assert_agrees(rig_of("aria", tmp_path), pose(left), projection(left), projection(right), 60.0)


def test_facebook360(tmp_path: Path) -> None:
    """Camera.h: rows right, up and back; r + d0 r³ + ... of the angle; pixels from the corner."""
    entries = content("facebook360")["cameras"]

    def projection(entry: Any) -> Any:
        rows = np.array([entry["right"], entry["up"], np.negative(entry["forward"])])

        def project(shared: np.ndarray) -> np.ndarray:
            own = (shared - entry["origin"]) @ rows.T
            xy = np.linalg.norm(own[:, :2], axis=1, keepdims=True)
            r = np.arctan2(xy, -own[:, 2:])
            d0, d1, d2 = entry["distortion"]
            sensor = own[:, :2] / xy * (r + d0 * r**3 + d1 * r**5 + d2 * r**7)
            return sensor * entry["focal"] + entry["principal"] - 0.5

        return project

    first = entries[0]
    axes = np.transpose([first["right"], np.negative(first["up"]), first["forward"]])
    shared_from_left = transformation(axes, first["origin"])
    rig = rig_of("facebook360", tmp_path)
    assert_agrees(rig, shared_from_left, projection(entries[0]), projection(entries[1]), 60.0)
    assert rig.left.max_angle_deg == pytest.approx(np.degrees(entries[0]["fov"]))
