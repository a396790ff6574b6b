"""The image circle of a fisheye: as a mask or a black rim shows it, and where neither does, not at all."""

from __future__ import annotations

import numpy as np
import pytest

from rectbench.pairs.finding.image_circle import angle_of_mask_deg, angle_of_rim_deg
from tests.rigs_for_tests import camera

LENS = camera("equidistant", (300, 300), 190.0)


def angles_deg() -> np.ndarray:
    rays, _ = LENS.unproject(LENS.pixel_grid())
    return np.degrees(np.arctan2(np.hypot(rays[..., 0], rays[..., 1]), rays[..., 2]))


def photograph(circle_deg: float, brightness: float = 120.0, seed: int = 0) -> np.ndarray:
    """Noise within the circle, black with a little noise beyond it."""
    rng = np.random.default_rng(seed)
    shown = np.where(angles_deg() < circle_deg, rng.uniform(0.2, 1, (300, 300)) * brightness, 0)
    return np.clip(shown + rng.normal(14, 2, (300, 300)), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("circle_deg", [60.0, 75.0, 90.0])
def test_the_rim_is_where_the_picture_ends(circle_deg: float) -> None:
    assert angle_of_rim_deg(LENS, [photograph(circle_deg)]) == pytest.approx(circle_deg, abs=1.01)


@pytest.mark.parametrize("circle_deg", [60.0, 80.5])
def test_a_mask_ends_where_most_of_its_pixels_do(circle_deg: float) -> None:
    mask = np.where(angles_deg() < circle_deg, 255, 0).astype(np.uint8)
    assert angle_of_mask_deg(LENS, mask) == pytest.approx(circle_deg, abs=1.01)


def test_a_dark_room_has_no_rim() -> None:
    assert angle_of_rim_deg(LENS, [photograph(75.0, brightness=15.0)]) is None


def test_a_picture_to_the_corners_has_no_rim() -> None:
    assert angle_of_rim_deg(LENS, [photograph(200.0)]) is None
    assert angle_of_mask_deg(LENS, np.full((300, 300), 255, np.uint8)) is None


def test_a_dark_floor_in_one_image_is_no_rim_while_another_is_light_there() -> None:
    images = [photograph(60.0), photograph(85.0, seed=1)]
    assert angle_of_rim_deg(LENS, images) == pytest.approx(85.0, abs=1.01)


def test_a_lamp_beyond_the_rim_does_not_move_it() -> None:
    image = photograph(75.0)
    image[angles_deg() > 100] = np.where(np.arange((angles_deg() > 100).sum()) % 40, 14, 255)
    assert angle_of_rim_deg(LENS, [image]) == pytest.approx(75.0, abs=1.01)


def test_a_narrow_lens_has_no_circle() -> None:
    lens = camera("equidistant", (64, 48), 6.0)
    assert angle_of_rim_deg(lens, [np.zeros((48, 64), np.uint8)]) is None
