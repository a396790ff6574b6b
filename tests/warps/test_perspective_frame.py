"""Where a perspective rectification looks, and views that have nothing in common."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.plugins.rectifier import pose_problem
from rectbench.warps.view.overlap import overlap_share
from tests.rigs_for_tests import camera, rig


@pytest.mark.parametrize("name", rb.rig_names())
def test_a_rig_that_looks_ahead_keeps_its_frame_and_its_middle(name: str) -> None:
    pair = rb.load_rig(name)
    frame, rays = rb.PerspectiveFrame.of(pair.trimmed()), rb.centre_rays(pair)
    if np.array_equal(frame.R_rect_left, rb.rectifying_rotations(pair)[0]):
        np.testing.assert_array_equal(frame.middle, (rays[:, :2] / rays[:, 2:]).mean(axis=0))
    assert (frame.R_rect_left @ pair.centre_right_in_left)[0] == pytest.approx(pair.baseline_m)
    assert np.abs(frame.middle).max() < 0.5


@pytest.mark.parametrize("centre_m", [(0.0, 0.0, 0.2), (0.001, -0.002, -0.2), (0.02, 0.03, 0.2)])
def test_cameras_that_look_along_the_baseline_get_the_half_that_shows_most(
    centre_m: tuple[float, float, float],
) -> None:
    # Of a view that is wider than high most lies to its sides.
    pair = rig(rotation_deg=(0, 0, 0), centre_m=centre_m, size=(640, 200), fov_deg=150).trimmed()
    frame = rb.PerspectiveFrame.of(pair)
    side = frame.R_rect_left.T @ [0, 0, 1]
    assert abs(side[0]) > 0.9
    assert np.isfinite(frame.middle).all()
    rect = rb.rectify(pair, method="conventional")
    assert rb.metrics.coverage(rect, pair)["coverage_pixels"] > 0.15
    np.testing.assert_allclose(np.linalg.det(frame.R_rect_left), 1)


def test_the_middle_stays_where_the_image_can_be_used() -> None:
    pair = rig(rotation_deg=(0, 0, 0), centre_m=(0.03, 0.0, 0.2))
    assert np.abs(rb.PerspectiveFrame.of(pair).middle).max() <= np.tan(np.radians(60)) + 1e-12


def back_to_back() -> rb.Rig:
    lens = camera(fov_deg=100)
    R = Rotation.from_euler("y", 180, degrees=True).as_matrix()
    return rb.Rig(lens, lens, R, -R @ np.array([0.0, 0.0, -0.2]), name="back-to-back")


def test_two_views_with_nothing_in_common_are_unsupported_for_every_method() -> None:
    with pytest.raises(rb.Unsupported) as told:
        pose_problem(back_to_back())
    assert "back-to-back have nothing in common: their overlap is 0 %" in str(told.value)
    assert "180 degrees apart" in str(told.value)
    with pytest.raises(rb.Unsupported, match="nothing in common"):
        rb.best_method(back_to_back())


def test_cameras_that_only_see_what_is_near_together_have_an_overlap() -> None:
    # They look at each other's side, towards a place two baselines ahead.
    lens = camera(fov_deg=60, size=(320, 320))
    R_left_right = Rotation.from_euler("y", -70, degrees=True).as_matrix()
    pair = rb.Rig(lens, lens, R_left_right.T, -R_left_right.T @ np.array([0.4, 0.0, 0.0]))
    assert overlap_share(pair) > 0.1
    assert rb.rectify(pair, method="abraham").size[0] > 1


def test_a_sliver_of_overlap_is_an_overlap() -> None:
    lens = camera(fov_deg=90, size=(320, 320))
    R = Rotation.from_euler("y", -92.5, degrees=True).as_matrix()
    pair = rb.Rig(lens, lens, R, -R @ np.array([0.2, 0.0, 0.0]))
    assert 0 < overlap_share(pair, 50_000) < 0.05
    pose_problem(pair)
