"""The image circle of a fisheye: as a mask or a black rim shows it, and where neither does, not at all."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.pairs.finding.image_circle import angle_of_mask_deg, angle_of_rim_deg, image_circle
from rectbench.pairs.finding.names import FilePair
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


RIG = rb.Rig(LENS, LENS, np.eye(3), np.array([-0.1, 0, 0]))


def shown(folder: Path, name: str, circle_deg: float, seed: int = 0) -> Path:
    cv2.imwrite(str(folder / name), photograph(circle_deg, seed=seed))
    return folder / name


def mask(folder: Path, name: str, circle_deg: float) -> Path:
    cv2.imwrite(str(folder / name), np.where(angles_deg() < circle_deg, 255, 0).astype(np.uint8))
    return folder / name


def pair(folder: Path, *circles_deg: float) -> FilePair:
    name = f"{circles_deg[0]:g}"
    left, right = (
        shown(folder, f"{name}-{i}.png", circle_deg, i) for i, circle_deg in enumerate(circles_deg)
    )
    return FilePair(name, left, right)


def test_the_narrower_rim_of_both_lenses_counts_and_all_pairs_at_once(tmp_path: Path) -> None:
    pairs = [pair(tmp_path, 60, 64), pair(tmp_path, 83, 78)]
    circle = image_circle(RIG, pairs, [])
    assert circle is not None
    assert circle.angle_deg == pytest.approx(78, abs=1.01)
    assert circle.told.endswith("° from their axes, by the black rim of its images")
    assert circle.masks == ()


def test_a_mask_goes_before_the_rim_and_each_side_may_have_its_own(tmp_path: Path) -> None:
    pairs = [pair(tmp_path, 80, 80)]
    one = mask(tmp_path, "mask.png", 70)
    circle = image_circle(RIG, pairs, [one])
    assert circle is not None
    assert (round(circle.angle_deg), circle.evidence, circle.masks) == (70, "by mask.png", (one,))
    both = [mask(tmp_path, "mask_left.png", 75), mask(tmp_path, "mask_right.png", 72)]
    circle = image_circle(RIG, pairs, both)
    assert circle is not None
    assert (round(circle.angle_deg), circle.evidence) == (72, "by mask_left.png and mask_right.png")


def test_masks_of_another_size_and_of_a_rectified_pair_are_none_of_the_lens(tmp_path: Path) -> None:
    pairs = [pair(tmp_path, 80, 80)]
    small, rectified = tmp_path / "small_mask.png", mask(tmp_path, "left_mask.png", 60)
    cv2.imwrite(str(small), np.zeros((20, 20), np.uint8))
    (tmp_path / "rectified.yaml").touch()
    circle = image_circle(RIG, pairs, [small, rectified])
    assert circle is not None
    assert circle.angle_deg == pytest.approx(80, abs=1.01)


def test_a_stated_circle_stands(tmp_path: Path) -> None:
    assert image_circle(RIG.within(90), [pair(tmp_path, 60, 60)], [mask(tmp_path, "mask.png", 50)]) is None


def test_images_that_cannot_be_read_show_no_circle(tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"no image")
    broken = FilePair("broken", tmp_path / "broken.png", tmp_path / "gone.png")
    assert image_circle(RIG, [broken], [tmp_path / "broken.png"]) is None
