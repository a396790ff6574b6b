"""The picture of a rig without photographs: its lines are source pixels, its dots stand on one row."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.applications import pixel_grid
from rectbench.applications.pixel_grid import FAR_RGB, INK_RGB, far_directions, grid_image, grid_preview
from tests.rigs_for_tests import camera, rig

RIGS = {
    "turned": rig("equidistant", (8, 12, 30), size=(640, 480), fov_deg=130),
    "circle": rig("kannala-brandt", size=(800, 800), fov_deg=190).within(75),
    "two lenses": rb.Rig(
        camera("equidistant", (960, 640)), camera("equisolid", (600, 520)), np.eye(3), np.array([-0.1, 0, 0])
    ),
}


def decoded(png: bytes) -> np.ndarray:
    image = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return image[..., ::-1]


def halves(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    width = (image.shape[1] - 8) // 2
    return image[:, :width], image[:, -width:]


def dots(image: np.ndarray) -> np.ndarray:
    """The middles [N, 2] of what has the colour of far points."""
    marked = (np.abs(image.astype(int) - FAR_RGB).max(axis=-1) < 40).astype(np.uint8)
    joined = cv2.morphologyEx(marked, cv2.MORPH_CLOSE, np.ones((5, 5)))  # scan lines cross some
    _, _, stats, middles = cv2.connectedComponentsWithStats(joined)
    return middles[1:][stats[1:, cv2.CC_STAT_AREA] > 12]


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("method", ["local-homography", "abraham"])
def test_the_same_far_points_stand_on_one_row_of_both_images(name: str, method: str) -> None:
    rect = rb.rectify(RIGS[name], method)
    image = decoded(grid_preview(rect))
    # A dot is a patch of directions, round on its own sensor, so that its middle is a little off its point's.
    left, right = map(dots, halves(image))
    far = far_directions(RIGS[name].left, pixel_grid.ring_step_deg(RIGS[name].left))
    both = [RIGS[name].left.project(far), RIGS[name].right.project(far @ RIGS[name].R_right_left.T)]
    rows = [
        warp.forward(np.where(ok[:, None], px, np.nan))[:, 1]
        for (px, ok), warp in zip(both, (rect.left, rect.right), strict=True)
    ]
    assert len(left) > 15
    assert len(right) > 15
    caption = len(image) - rect.size[1]
    for middles, expected in zip((left, right), rows, strict=True):
        off = np.abs(middles[:, 1, None] - caption - expected[None]).min(
            axis=1, where=np.isfinite(expected), initial=99
        )
        assert np.median(off) < 1.0
        assert (off < 6).mean() > 0.8  # those at the rim are cut off


def test_lines_are_drawn_at_their_pixels() -> None:
    lens = camera("equidistant", (300, 200))
    image = grid_image(rb.Rig(lens, lens, np.eye(3), [-0.1, 0, 0]), "right", 900).astype(int)
    pitch, (fine, strong) = pixel_grid.pitch_px(lens), INK_RGB["right"]
    assert pitch == 20
    for pixel, colour in ((40, fine), (60, fine), (100, strong), (200, strong)):
        column = image[:, 3 * pixel + 1]  # of three pixels of the drawing the middle one
        assert (np.abs(column - colour).max(axis=-1) < 12).mean() > 0.6
        beside = image[:, 3 * (pixel + pitch // 2) + 1]
        assert (np.abs(beside - colour).max(axis=-1) < 12).mean() < 0.1


def test_what_a_lens_does_not_show_is_blind_in_both_pictures() -> None:
    circled = RIGS["circle"]
    image = grid_image(circled, "left", 1600)
    seen = circled.left.unproject(circled.left.pixel_grid())[1]
    drawn = image[1::2, 1::2]
    assert (
        drawn[~cv2.dilate(seen.astype(np.uint8), np.ones((9, 9))).astype(bool)] == pixel_grid.BLIND_RGB
    ).all()
    rect = rb.rectify(circled, "abraham")
    shown, _ = halves(decoded(grid_preview(rect))[-rect.size[1] :])
    blind = (shown == pixel_grid.BLIND_RGB).all(axis=-1)
    assert not blind[cv2.erode(rect.valid("left").astype(np.uint8), np.ones((9, 9))).astype(bool)].any()
    assert blind[~rect.valid("left")].mean() > 0.9  # all but the scan lines


@pytest.mark.parametrize(
    ("size", "fov_deg", "pitch_px", "step_deg"),
    [
        ((64, 48), 20, 5, 5),
        ((848, 800), 160, 50, 30),
        ((1920, 1080), 60, 100, 10),
        ((8000, 6000), 220, 500, 30),
    ],
)
def test_lines_and_circles_are_at_round_numbers(
    size: tuple[int, int], fov_deg: float, pitch_px: int, step_deg: int
) -> None:
    lens = camera("equidistant", size, fov_deg).scaled(1.0)
    assert pixel_grid.pitch_px(lens) == pitch_px
    assert pixel_grid.ring_step_deg(lens) == step_deg


def test_a_small_preview_has_no_caption_that_nobody_could_read() -> None:
    rect = rb.rectify(rig("equidistant", size=(96, 64)), "abraham")
    assert len(decoded(grid_preview(rect))) == rect.size[1]
    large = rb.rectify(rig("equidistant", size=(640, 480)), "abraham")
    assert len(decoded(grid_preview(large))) > large.size[1]
