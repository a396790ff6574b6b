"""Rigs and calibration files that the tests of this folder start from."""

from __future__ import annotations

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
