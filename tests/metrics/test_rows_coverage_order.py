"""Row error, coverage and order: a perfect rectifier, a known tilt, a known crop."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, points_before, rig, rigs

CALIBRATED = ("conventional", "abraham", "local-homography")


@pytest.mark.parametrize("method", CALIBRATED)
@settings(max_examples=6)
@given(rig=rigs)
def test_with_the_exact_pose_calibrated_methods_have_no_row_error(method: str, rig: rb.Rig) -> None:
    _, px_left, px_right = points_before(rig, 200)
    errors = rb.metrics.row_error(rb.rectify(rig, method=method), px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-6
    assert errors["row_error_below_1px"] == 1
    assert errors["row_error_matches"] > 20


@pytest.mark.parametrize("method", ["hartley", "fusiello"])
def test_with_exact_matches_uncalibrated_methods_have_next_to_no_row_error(method: str) -> None:
    pair = rig("kannala-brandt")
    _, px_left, px_right = points_before(pair, 400)
    errors = rb.metrics.row_error(rb.rectify(pair, method=method), px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-4


def test_a_known_tilt_gives_its_row_error() -> None:
    pair = aligned_rig(480, 320, 100)
    tilt = np.radians(0.5)
    nod = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    rect = rb.rectify(pair, method="abraham")
    nodding = rb.Warp(pair.right, nod @ rect.right.R_rect_cam, rect.right.target)
    tilted = rb.Rectification(pair, rect.left, nodding, rect.size)
    _, px_left, px_right = points_before(pair, 300)
    errors = rb.metrics.row_error(tilted, px_left, px_right)
    focal = pair.left.params["fx"]
    # v̂ = f β and the nod adds its angle to every β.
    np.testing.assert_allclose(errors.rectified_px[np.isfinite(errors.rectified_px)], focal * tilt, rtol=1e-9)


def test_shrinking_the_image_shrinks_the_error_in_rectified_pixels_only() -> None:
    true, believed = rig(), rig(rotation_deg=(1.2, -2.0, 0.7))
    _, px_left, px_right = points_before(true, 300)
    large = rb.metrics.row_error(rb.rectify(believed, method="abraham"), px_left, px_right).columns()
    half = {"focal_px": rb.centre_resolution_px(believed) / 2}
    small = rb.metrics.row_error(rb.rectify(believed, method="abraham", **half), px_left, px_right).columns()
    assert small["row_error_mean_px"] == pytest.approx(large["row_error_mean_px"] / 2, rel=0.02)
    assert small["row_error_source_mean_px"] == pytest.approx(large["row_error_source_mean_px"], rel=0.02)


def test_no_match_in_the_frame_scores_nan_not_zero() -> None:
    pair = rig()
    columns = rb.metrics.row_error(
        rb.rectify(pair), np.full((3, 2), np.nan), np.full((3, 2), np.nan)
    ).columns()
    assert columns["row_error_matches"] == 0
    assert math.isnan(columns["row_error_mean_px"])
    assert math.isnan(columns["row_error_below_1px"])


@pytest.mark.parametrize("method", ["abraham", "local-homography"])
@settings(max_examples=6)
@given(rig=rigs)
def test_fisheye_methods_keep_the_whole_view(method: str, rig: rb.Rig) -> None:
    shares = rb.metrics.coverage(rb.rectify(rig, method=method), rig)
    assert shares["coverage_pixels"] == 1
    assert shares["coverage_solid_angle"] == pytest.approx(1)
    assert shares["coverage_overlap"] == 1


def test_coverage_of_a_perspective_crop_is_its_share_of_the_view() -> None:
    pair = aligned_rig(480, 320, 120)
    rect = rb.rectify(pair, method="conventional", focal="fov", fov_deg=60)
    shares = rb.metrics.coverage(rect, pair)
    rays, _ = pair.left.unproject(pair.left.pixel_grid())
    x, y, z = np.moveaxis(rays, -1, 0)
    focal = rect.notes["focal_px"]
    shown = (np.abs(focal * x / z) <= 240) & (np.abs(focal * y / z) <= 160) & (z > 0)
    assert shares["coverage_pixels"] == pytest.approx(shown.mean(), abs=0.004)
    assert 0.15 < shares["coverage_solid_angle"] < shares["coverage_pixels"] + 0.1
    assert shares["valid_output"] == pytest.approx(1, abs=0.01)
    assert shares["output_pixels_per_source_pixel"] == 1


@pytest.mark.parametrize("method", CALIBRATED)
@settings(max_examples=6)
@given(rig=rigs)
def test_order_is_kept_and_the_inverse_closes(method: str, rig: rb.Rig) -> None:
    result = rb.metrics.order(rb.rectify(rig, method=method), rig)
    assert result["order_du_dgamma_min"] > 0
    assert result["order_dv_dbeta_min"] > 0
    assert result["order_upright"] == 1
    assert result["closure_px"] < 1e-6


def test_the_slope_along_rows_is_that_of_the_profile() -> None:
    pair = aligned_rig(480, 320, 120)
    result = rb.metrics.order(rb.rectify(pair, method="abraham"), pair)
    focal = rb.centre_resolution_px(pair)
    assert result["order_du_dgamma_min"] == pytest.approx(focal, rel=1e-6)
    assert result["order_dv_dbeta_min"] == pytest.approx(focal, rel=1e-6)


def test_a_mirrored_image_is_not_upright() -> None:
    pair = aligned_rig(480, 320, 100)
    rect = rb.rectify(pair, method="conventional")
    flip = np.diag([-1.0, 1, 1]) @ rect.left.target.matrix + np.outer([rect.size[0] - 1, 0, 0], [0, 0, 1])
    mirrored = rb.Warp(pair.left, rect.R_rect_left, rb.Perspective(flip))
    result = rb.metrics.order(rb.Rectification(pair, mirrored, rect.right, rect.size), pair)
    assert result["order_upright"] == pytest.approx(0.5, abs=0.05)
    assert result["order_du_dgamma_min"] < 0


def test_an_image_upside_down_is_not_upright_though_its_determinant_is_positive() -> None:
    pair = aligned_rig(480, 320, 100)
    rect = rb.rectify(pair, method="conventional")
    half_turn = np.diag([-1.0, -1.0, 1.0])
    turned = [rb.Warp(w.source, half_turn @ w.R_rect_cam, w.target) for w in (rect.left, rect.right)]
    result = rb.metrics.order(rb.Rectification(pair, turned[0], turned[1], rect.size), pair)
    assert result["order_upright"] == 0
