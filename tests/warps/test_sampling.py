"""Evaluation pixels: about 500, evenly, inside the image circle; the outline bounds the view."""

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, rig


@pytest.mark.parametrize("size", [(1920, 1080), (640, 480), (500, 2000), (848, 800)])
def test_about_500_pixels_cover_the_image_evenly(size: tuple[int, int]) -> None:
    lens = rb.Camera("equidistant", size, {"fx": 400, "fy": 400, "cx": size[0] / 2, "cy": size[1] / 2})
    pixels = rb.evaluation_pixels(lens)
    assert 475 <= len(pixels) <= 525
    across, down = len(np.unique(pixels[:, 0])), len(np.unique(pixels[:, 1]))
    assert across * down == len(pixels)
    assert size[0] / across == pytest.approx(size[1] / down, rel=0.1)
    np.testing.assert_allclose(pixels.mean(axis=0), (np.array(size) - 1) / 2)


def test_pixels_out_of_the_image_circle_are_left_out_and_made_up_for() -> None:
    lens = aligned_rig(1280, 1280, 180, max_angle_deg=90).left
    pixels = rb.evaluation_pixels(lens)
    assert 450 <= len(pixels) <= 550
    assert np.linalg.norm(pixels - 639.5, axis=1).max() <= 640


@pytest.mark.parametrize("circle_deg", [None, 55.0])
def test_view_angles_bound_those_of_every_pixel(circle_deg: float | None) -> None:
    pair = rig("kannala-brandt")
    lens = rb.Camera(pair.left.model, pair.left.size, pair.left.params, circle_deg)
    pair = rb.Rig(lens, lens, pair.R_right_left, pair.t_right_left)
    bounds = rb.view_angles(pair)
    R_rect_left, _ = rb.rectifying_rotations(pair)
    x, y, z = np.moveaxis(lens.unproject(lens.pixel_grid())[0] @ R_rect_left.T, -1, 0)
    gamma, beta = np.atan2(x, np.hypot(y, z)), np.atan2(y, z)
    for values, (low, high) in ((gamma, bounds.gamma_left), (beta, bounds.beta)):
        assert low <= np.nanmin(values)
        assert np.nanmax(values) <= high
    span = np.nanmax(gamma) - np.nanmin(gamma)
    assert bounds.gamma_left.high - bounds.gamma_left.low < 1.02 * span


@pytest.mark.parametrize("circle_deg", [None, 58.0])
@pytest.mark.parametrize("margin_deg", [7.0, 25.0])
def test_the_extremes_are_those_of_a_grid_of_sixteenths_of_a_pixel(
    circle_deg: float | None, margin_deg: float
) -> None:
    # A lens whose angles rise ever faster towards its rim, with its epipoles beside the image.
    lens = rb.Camera("orthographic", (52, 93), {"fx": 30, "fy": 31, "cx": 27, "cy": 46}, circle_deg)
    pair = rb.Rig(lens, lens, np.eye(3), np.array([0.02, 0.2, -0.12])).trimmed(margin_deg)
    bounds = rb.view_angles(pair)
    u, v = (np.arange(16 * side + 1) / 16 - 0.5 for side in lens.size)
    rays, seen = pair.left.unproject(np.stack(np.meshgrid(u, v), axis=-1))
    R_rect_left, _ = rb.rectifying_rotations(pair)
    x, y, z = np.moveaxis(rays[seen] @ R_rect_left.T, -1, 0)
    gamma, beta = np.degrees(np.atan2(x, np.hypot(y, z))), np.degrees(np.atan2(y, z))
    for values, (low, high) in ((gamma, bounds.gamma_left), (beta, bounds.beta)):
        assert 0 <= values.min() - np.degrees(low) < 0.7
        assert 0 <= np.degrees(high) - values.max() < 0.7


def test_a_view_that_holds_an_epipole_has_all_angles_about_it() -> None:
    lens = aligned_rig(400, 400, 120).left
    ahead = rb.view_angles(rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0.0, -0.2])))
    assert ahead.gamma_left.high == np.pi / 2
    assert tuple(ahead.beta) == (-np.pi, np.pi)
