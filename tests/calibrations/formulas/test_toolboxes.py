"""What Python programs dump of OpenCV's calibrations projects as OpenCV does."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from tests.calibrations.examples import EXAMPLES
from tests.calibrations.formulas.agreement import assert_agrees, content, rig_of, transformation


def pinhole(K: Any, D: Any, R: Any, t: Any) -> Any:
    """OpenCV's projection of points that R and t take to the camera."""
    K, D, R, t = (np.array(value, dtype=float) for value in (K, D, R, t))
    project = cv2.fisheye.projectPoints if D.size == 4 else cv2.projectPoints
    rvec = cv2.Rodrigues(R)[0]
    return lambda shared: project(np.ascontiguousarray(shared)[:, None], rvec, t.ravel(), K, D.ravel())[0][
        :, 0
    ]


def test_simplestereo(tmp_path: Path) -> None:
    """Rigs of a board in millimetres: X_2 = R X_1 + T."""
    file = content("simplestereo")
    left = pinhole(file["intrinsic1"], file["distCoeffs1"], np.eye(3), np.zeros(3))
    right = pinhole(file["intrinsic2"], file["distCoeffs2"], file["R"], np.array(file["T"]) / 1000)
    assert_agrees(rig_of("simplestereo", tmp_path), np.eye(4), left, right, 35.0)


@pytest.mark.parametrize("name", ["multical", "multical-master"])
def test_multical(tmp_path: Path, name: str) -> None:
    """`projected`: the camera's pose takes points of the rig to the camera."""
    file = content(name)
    cameras, poses = list(file["cameras"].values()), list(file["camera_poses"].values())
    left, right = (
        pinhole(camera["K"], camera["dist"], pose["R"], pose["T"])
        for camera, pose in zip(cameras, poses, strict=True)
    )
    shared_from_left = np.linalg.inv(transformation(poses[0]["R"], poses[0]["T"]))
    assert_agrees(rig_of(name, tmp_path), shared_from_left, left, right, 35.0)


def test_sections_left_and_right(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    file = yaml.safe_load(EXAMPLES["left-right"].files["stereo.yaml"])

    def projection(side: str) -> Any:
        fx, fy, cx, cy = file[side]["intrinsics"]
        T = np.array(file[side]["T"])
        K = [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]
        return pinhole(K, file[side]["distortion_coeffs"], T[:3, :3], T[:3, 3])

    rig = rig_of("left-right", tmp_path)
    assert_agrees(rig, np.eye(4), projection("left"), projection("right"), 35.0)
    assert "right.T: taken to take points of the frame that both share to the camera" in caplog.text
