"""The rectified frame: both cameras turned so that the baseline is the x axis."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, rig, rigs


@given(rigs)
def test_both_rotations_lay_the_baseline_on_x(rig: rb.Rig) -> None:
    R_rect_left, R_rect_right = rb.rectifying_rotations(rig)
    centre = R_rect_left @ rig.centre_right_in_left
    np.testing.assert_allclose(centre, [rig.baseline_m, 0, 0], atol=1e-12)
    np.testing.assert_allclose(R_rect_right @ rig.R_right_left, R_rect_left, atol=1e-12)
    for R in (R_rect_left, R_rect_right):
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1)


def test_the_rotations_are_those_of_opencv_stereo_rectify() -> None:
    pair = rig()
    K = np.array([[300.0, 0, 240], [0, 300, 160], [0, 0, 1]])
    R1, R2, *_ = cv2.stereoRectify(
        K, None, K, None, (480, 320), pair.R_right_left, pair.t_right_left[:, None]
    )
    R_rect_left, R_rect_right = rb.rectifying_rotations(pair)
    np.testing.assert_allclose(R_rect_left, R1, atol=1e-9)
    np.testing.assert_allclose(R_rect_right, R2, atol=1e-9)


def test_a_pair_given_right_camera_first_is_not_turned_upside_down() -> None:
    swapped = rig(centre_m=(-0.12, 0.0, 0.0), rotation_deg=(0, 0, 0))
    R_rect_left, _ = rb.rectifying_rotations(swapped)
    np.testing.assert_allclose(R_rect_left, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("y", [0.2, -0.2])
def test_a_vertical_rig_is_rolled_by_a_quarter_turn(y: float) -> None:
    R_rect_left, _ = rb.rectifying_rotations(rig(centre_m=(0.0, y, 0.0), rotation_deg=(0, 0, 0)))
    assert np.degrees(Rotation.from_matrix(R_rect_left).magnitude()) == pytest.approx(90)
    np.testing.assert_allclose(R_rect_left[2], [0, 0, 1], atol=1e-12)


@pytest.mark.parametrize(
    "centre_m", [(-0.002, 0.064, 0.002), (-0.002, -0.064, 0.0), (-0.05, 0.06, 0.0), (-0.01, 0.0, 0.1)]
)
def test_of_a_vertical_a_slanted_or_a_forward_rig_disparity_is_positive(
    centre_m: tuple[float, float, float],
) -> None:
    turned = rig(centre_m=centre_m, rotation_deg=(1, -2, 0.5))
    R_rect_left, _ = rb.rectifying_rotations(turned)
    assert (R_rect_left @ turned.centre_right_in_left)[0] == pytest.approx(turned.baseline_m)


def test_an_epipole_in_the_view_is_refused_with_its_pixel() -> None:
    forward = rig(centre_m=(0.02, 0.0, 0.2))
    with pytest.raises(rb.Unsupported, match=r"epipole .* lies in the left view, at pixel \(\d+, \d+\)"):
        rb.refuse_epipole_in_view(forward)


def test_an_epipole_on_the_very_edge_of_the_image_circle_is_no_epipole_in_view() -> None:
    rb.refuse_epipole_in_view(aligned_rig(320, 320, 180, max_angle_deg=90))


def test_an_epipole_just_inside_the_image_circle_is_refused() -> None:
    with pytest.raises(rb.Unsupported):
        rb.refuse_epipole_in_view(aligned_rig(420, 420, 200, max_angle_deg=92))


def test_centre_resolution_is_the_focal_length_of_a_fisheye() -> None:
    lens = rb.Camera("equidistant", (400, 400), {"fx": 150, "fy": 150, "cx": 200, "cy": 200})
    assert rb.centre_resolution_px(rb.Rig(lens, lens, np.eye(3), [-1, 0, 0])) == pytest.approx(150, rel=1e-12)


def test_an_image_circle_takes_an_epipole_out_of_the_view() -> None:
    wide = aligned_rig(420, 420, 200)
    with pytest.raises(rb.Unsupported, match="state its image circle"):
        rb.refuse_epipole_in_view(wide)
    rb.refuse_epipole_in_view(wide.within(85))
