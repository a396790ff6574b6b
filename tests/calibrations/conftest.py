"""Rigs and calibration files that the tests of this folder start from."""

from __future__ import annotations

import numpy as np
import pytest

from rectbench import Camera, Rig
from tests.calibrations.calibration_files import R_RIGHT_LEFT, T_RIGHT_LEFT


@pytest.fixture
def rig() -> Rig:
    fisheye = {"fx": 285.7, "fy": 286.8, "cx": 420.1, "cy": 403.4, "k1": -0.0066, "k2": 0.047}
    pinhole = {"fx": 461.6, "fy": 460.2, "cx": 362.7, "cy": 246.0, "k1": -0.277, "k2": 0.067, "p1": 1e-5}
    left = Camera("kannala-brandt", (848, 800), fisheye, max_angle_deg=80)
    right = Camera("pinhole", (752, 480), pinhole)
    return Rig(left, right, R_RIGHT_LEFT, T_RIGHT_LEFT, name="mixed")


@pytest.fixture(scope="session")
def camchain() -> str:
    rows = "\n".join(
        f"  - {row}" for row in np.vstack([np.c_[R_RIGHT_LEFT, T_RIGHT_LEFT], [0, 0, 0, 1]]).tolist()
    )
    return f"""\
cam0:
  camera_model: pinhole
  distortion_model: radtan
  distortion_coeffs: [-0.27695497, 0.06712482, 0.00087538, 1.1556e-04]
  intrinsics: [461.629, 460.152, 362.680, 246.049]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
{rows}
  camera_model: omni
  distortion_model: none
  intrinsics: [0.80065662, 833.006, 830.345, 373.850, 253.749]
  resolution: [752, 480]
"""
