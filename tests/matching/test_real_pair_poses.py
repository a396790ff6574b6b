"""Real pairs: the images tell the calibrated pose, as far as a calibration lasts."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from tests.rigs.test_real_pairs import PAIRS


def read(folder: Path, *names: str) -> list[np.ndarray]:
    return [cv2.imread(str(folder / name), cv2.IMREAD_UNCHANGED) for name in names]


@pytest.mark.parametrize(("name", "left", "right"), [pair[:3] for pair in PAIRS], ids=[p[1] for p in PAIRS])
def test_the_pose_is_the_calibrated_one(real_data: Path, name: str, left: str, right: str) -> None:
    rig = rb.load_rig(name)
    found = rb.estimate_pose(read(real_data, left, right), rig)
    rotation_deg, direction_deg = found.difference_deg(rig)
    assert rotation_deg < 0.4
    assert direction_deg < 1.5
    assert found.noise_px < 0.3
    assert found.note == ""


def test_images_of_two_places_tell_no_pose(real_data: Path) -> None:
    images = read(real_data, "pairs/t265/fs1.png", "pairs/t265/robot2.png")
    with pytest.raises(rb.PoseNotFound, match="overlap"):
        rb.estimate_pose(images, rb.load_rig("t265"))
