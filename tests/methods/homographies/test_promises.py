"""What all global homographies promise, and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from tests.methods.homographies.pinholes import homographies, pinholes, rectified
from tests.rigs_for_tests import points_before, rig

EXACT = {
    "loop-zhang": 1e-9,
    "lafiosca-ceccaroni": 1e-9,
    "gluckman-nayar": 1e-9,
    "fusiello-trucco-verri": 1e-9,
    "opencv-stereo-rectify": 1e-9,
    "opencv-uncalibrated": 1e-6,
    "three-step": 1e-6,
    "usr-cgd": 1e-6,
}
"""Methods whose rows correspond, and to how many pixels: the last two search for the geometry."""
NEARLY = ("dsr", "s2p-affine")
"""Methods whose rows correspond where the cameras look the same way, or where the view is narrow."""
COLUMNS_BY_MATCHES = ("opencv-uncalibrated", "s2p-affine")
"""Methods that stretch the columns of one image by how far away the matches are."""
FROM_POSE = ("lafiosca-ceccaroni", "fusiello-trucco-verri", "opencv-stereo-rectify")
ONE_ABOVE_THE_OTHER_REFUSED = ("opencv-stereo-rectify", "dsr")


def largest_row_error_px(rect: rb.Rectification, pair: rb.Rig) -> float:
    _, px_left, px_right = points_before(pair, 300, seed=5)
    errors = rb.metrics.row_error(rect, px_left, px_right).columns()
    assert errors["row_error_matches"] > 40
    return float(errors["row_error_max_px"])


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("centre_m", [(0.2, 0.01, 0.02), (-0.2, 0.01, 0.02)], ids=["left", "right-first"])
def test_rows_correspond_after_a_known_tilt(method: str, centre_m: tuple[float, float, float]) -> None:
    pair = pinholes(centre_m=centre_m)
    rect = rectified(pair, method)
    assert largest_row_error_px(rect, pair) < EXACT[method]
    assert rb.metrics.order(rect, pair)["order_upright"] == 1


@pytest.mark.parametrize("method", [*EXACT, *NEARLY])
def test_a_rectified_pair_stays_as_it_is(method: str) -> None:
    for H in homographies(rectified(pinholes((0.0, 0.0, 0.0), (0.2, 0.0, 0.0)), method)):
        np.testing.assert_allclose(H[1:], np.eye(3)[1:], atol=1e-6)
        if method not in COLUMNS_BY_MATCHES:
            np.testing.assert_allclose(H[0, :2], [1, 0], atol=1e-6)  # the shift of columns is free


@pytest.mark.parametrize("method", [*EXACT, *NEARLY])
def test_the_same_matches_give_the_same_digits(method: str) -> None:
    first, second = (rectified(pinholes((0.1, 0.1, 3.0), (0.2, 0.01, 0.0)), method) for _ in range(2))
    np.testing.assert_array_equal(first.maps("left"), second.maps("left"))


@pytest.mark.parametrize("method", [m for m in (*EXACT, "s2p-affine") if m != "opencv-stereo-rectify"])
def test_cameras_one_above_the_other_are_rectified_too(method: str) -> None:
    pair = rig(centre_m=(0.001, 0.12, 0.0), rotation_deg=(0.5, 0.4, -0.3), size=(320, 320), fov_deg=95)
    rect = rectified(pair, method)
    assert largest_row_error_px(rect, pair) < EXACT.get(method, 6)


@pytest.mark.parametrize("method", ONE_ABOVE_THE_OTHER_REFUSED)
def test_cameras_one_above_the_other_are_refused_with_the_reason(method: str) -> None:
    pair = rig(centre_m=(0.001, 0.12, 0.0), rotation_deg=(0.5, 0.4, -0.3), size=(320, 320), fov_deg=95)
    with pytest.raises(rb.Unsupported, match=r"expected cameras .*(side by side|along the rows)"):
        rectified(pair, method)


@pytest.mark.parametrize("method", EXACT)
def test_two_different_fisheye_lenses_are_rectified_together(method: str) -> None:
    one, other = rig("kannala-brandt").left, rig("double-sphere", size=(400, 300)).left
    pair = rb.Rig(one, other, np.eye(3), np.array([-0.1, 0.001, 0]))
    assert largest_row_error_px(rectified(pair, method), pair) < 1e-4


@pytest.mark.parametrize("method", [*EXACT, *NEARLY])
def test_an_epipole_in_the_undistorted_view_ends_it(method: str) -> None:
    with pytest.raises(rb.Unsupported, match="an epipole lies in the undistorted view, which no homography"):
        rb.rectify(rig(centre_m=(0.02, 0.0, 0.3)), method=method)


@pytest.mark.parametrize("method", [m for m in (*EXACT, *NEARLY) if m not in FROM_POSE])
def test_methods_from_matches_do_not_look_at_the_pose(method: str) -> None:
    pair = pinholes((0.5, 1.0, 0.5))
    _, left, right = points_before(pair, 200)
    wrong = rb.Rig(pair.left, pair.right, np.eye(3), pair.t_right_left)
    maps = [rb.rectify(r, method=method, matches=(left, right)).maps("left") for r in (pair, wrong)]
    np.testing.assert_array_equal(*maps)


@pytest.mark.parametrize("method", FROM_POSE)
def test_methods_from_the_pose_need_no_matches(method: str) -> None:
    _, left, right = points_before(pinholes(), 200)
    with_few = rb.rectify(pinholes(), method=method, matches=(left[:3], right[:3]))
    np.testing.assert_array_equal(with_few.maps("left"), rectified(pinholes(), method).maps("left"))
