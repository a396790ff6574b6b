"""equirectangular: longitude and latitude, and a row error that is the difference of latitudes."""

import numpy as np

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, points_before, rig


def test_pixels_are_longitude_and_latitude() -> None:
    rect = rb.rectify(aligned_rig(480, 320, 150), "equirectangular", focal_px=200.0)
    assert rect.size == (628, 628)
    rays = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.5, 0.5, np.sqrt(0.5)]])
    pixels = rect.left.target.project(rays)[0]
    expected = 200 * np.array([[0.0, 0.0], [np.pi / 4, 0.0], [np.arctan(np.sqrt(0.5)), np.pi / 6]])
    np.testing.assert_allclose(pixels, 313.5 + expected, atol=1e-9)


def test_its_row_error_is_the_difference_of_latitudes() -> None:
    pair = rig("double-sphere")
    rect = rb.rectify(pair, "equirectangular")
    points, px_left, px_right = points_before(pair)
    in_left = points @ rect.R_rect_left.T
    in_right = pair.right_from_left(points) @ rect.R_rect_right.T
    np.testing.assert_allclose(in_left[:, 1:], in_right[:, 1:], atol=1e-12)  # the baseline is x
    latitudes = [np.arcsin(p[:, 1] / np.linalg.norm(p, axis=1)) for p in (in_left, in_right)]
    expected = rect.notes["focal_px"] * np.abs(latitudes[0] - latitudes[1])
    found = rb.metrics.row_error(rect, px_left, px_right).rectified_px
    shown = np.isfinite(found)
    assert shown.sum() > 200
    np.testing.assert_allclose(found[shown], expected[shown], atol=1e-7)
    assert np.quantile(expected, 0.95) > 1


def test_it_says_that_it_is_a_control() -> None:
    pair = rig()
    rect = rb.rectify(pair, "equirectangular")
    found = rb.metrics.row_misfit(rect, rb.Delivered.of(rect, rb.ScoredView.of(pair)), pair)
    assert not found.rectifies
    assert "rows are bent by" in found.reason
