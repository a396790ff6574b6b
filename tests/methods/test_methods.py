"""What each of the five promises, and what it refuses."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.rigs_for_tests import aligned_rig, points_before, rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
ANY_MOTION = ("polar", "log-polar", "polar-optimal")
FROM_MATCHES = ("hartley", "fusiello")


@pytest.mark.parametrize("method", [m for m in (*METHODS, *ANY_MOTION) if m not in FROM_MATCHES])
def test_a_rig_that_sees_its_epipoles_is_rectified_but_for_what_is_about_them(method: str) -> None:
    forward = rig(centre_m=(0.02, 0.0, 0.3))
    rect = rb.rectify(forward, method=method)
    _, px_left, px_right = points_before(forward, 400)
    errors = rb.metrics.row_error(rect, px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-6
    assert errors["row_error_matches"] > 20
    epipole, _ = forward.left.project(forward.centre_right_in_left)
    assert np.isnan(rect.left.forward(epipole)).all()


@pytest.mark.parametrize("method", FROM_MATCHES)
def test_homographies_end_where_the_undistorted_view_shows_an_epipole(method: str) -> None:
    with pytest.raises(rb.Unsupported, match="an epipole lies in the undistorted view, which no homography"):
        rb.rectify(rig(centre_m=(0.02, 0.0, 0.3)), method=method)


@pytest.mark.parametrize("method", [*METHODS, *ANY_MOTION])
def test_the_same_problem_gives_the_same_digits(method: str) -> None:
    first, second = (rb.rectify(rig("unified"), method=method) for _ in range(2))
    np.testing.assert_array_equal(first.maps("left"), second.maps("left"))


@pytest.mark.parametrize("method", [*METHODS, *ANY_MOTION])
def test_a_vertical_rig_is_rectified_too(method: str) -> None:
    pair = rig(centre_m=(0.001, 0.12, 0.0), rotation_deg=(0.5, 0.4, -0.3), size=(320, 320), fov_deg=95)
    rect = rb.rectify(pair, method=method)
    _, px_left, px_right = points_before(pair, 200)
    errors = rb.metrics.row_error(rect, px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-4
    assert errors["row_error_matches"] > 40


@pytest.mark.parametrize("method", [*METHODS, *ANY_MOTION])
def test_two_different_lenses_are_rectified_together(method: str) -> None:
    one, other = rig("kannala-brandt").left, rig("double-sphere", size=(400, 300)).left
    pair = rb.Rig(one, other, np.eye(3), np.array([-0.1, 0.001, 0]))
    _, px_left, px_right = points_before(pair, 200)
    errors = rb.metrics.row_error(rb.rectify(pair, method=method), px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-4
    assert errors["row_error_matches"] > 40


@pytest.mark.parametrize("law", ["equidistant", "stereographic", "equisolid", "orthographic", "cylindrical"])
def test_abraham_has_each_lens_law_and_its_focal_length(law: str) -> None:
    pair = aligned_rig(480, 320, 120)
    rect = rb.rectify(pair, method="abraham", law=law, focal_px=200.0)
    gamma = np.radians(20)
    (u0, v0), (u1, v1) = rect.left.target.project([[0, 0, 1], [np.sin(gamma), 0, np.cos(gamma)]])[0]
    r = {
        "equidistant": gamma,
        "stereographic": 2 * np.tan(gamma / 2),
        "equisolid": 2 * np.sin(gamma / 2),
        "orthographic": np.sin(gamma),
        "cylindrical": np.tan(gamma),
    }[law]
    assert u1 - u0 == pytest.approx(200 * r)
    assert v1 == pytest.approx(v0)


@pytest.mark.parametrize("focal", ["centre-resolution", "min-distortion", "fov"])
def test_conventional_images_are_perspective(focal: str) -> None:
    rect = rb.rectify(aligned_rig(480, 320, 120), method="conventional", focal=focal, fov_deg=90.0)
    f = rect.notes["focal_px"]
    (u0, _), (u1, _) = rect.left.target.project([[0, 0, 1], [0.5, 0, 1]])[0]
    assert u1 - u0 == pytest.approx(0.5 * f)
    if focal == "fov":
        assert f == pytest.approx(240)


def test_min_distortion_is_the_least_over_focal_lengths() -> None:
    pair = aligned_rig(480, 320, 120)
    best = rb.rectify(pair, method="conventional", focal="min-distortion")
    score = rb.metrics.distortion(best, pair)
    assert score == pytest.approx(float(rb.metrics.distortion(best, pair, protocol="rescaled")), rel=1e-9)
    for fov_deg in (60.0, 100.0, 140.0, 160.0):
        other = rb.rectify(pair, method="conventional", focal="fov", fov_deg=fov_deg)
        assert score <= rb.metrics.distortion(other, pair)


def test_balance_goes_from_no_black_to_nothing_lost() -> None:
    pair = aligned_rig(480, 320, 110)
    tight = rb.rectify(pair, method="conventional", focal="balance", balance=0.0)
    wide = rb.rectify(pair, method="conventional", focal="balance", balance=1.0)
    assert rb.metrics.coverage(tight, pair)["valid_output"] > 0.99
    assert rb.metrics.coverage(wide, pair)["coverage_pixels"] == 1


def test_balance_on_a_lens_too_wide_for_a_plane_is_refused_with_the_reason() -> None:
    pair = aligned_rig(400, 400, 178, max_angle_deg=89.9)
    with pytest.raises(rb.Unsupported, match="too wide"):
        rb.rectify(pair, method="conventional", focal="balance", balance=1.0)


def test_fusiello_finds_the_focal_length_of_a_toed_in_pair() -> None:
    lens = rb.Camera("pinhole", (640, 480), {"fx": 520, "fy": 520, "cx": 319.5, "cy": 239.5})
    turned = rig(rotation_deg=(2, 8, 3)).R_right_left
    rect = rb.rectify(rb.Rig(lens, lens, turned, -turned @ [0.2, 0.01, 0.02]), method="fusiello")
    assert rect.notes["focal_px"] == pytest.approx(520, rel=1e-3)


def test_fusiello_says_when_the_matches_leave_the_focal_length_open() -> None:
    lens = rb.Camera("pinhole", (640, 480), {"fx": 9000, "fy": 9000, "cx": 319.5, "cy": 239.5})
    turned = rig(rotation_deg=(2, 8, 3)).R_right_left
    rect = rb.rectify(rb.Rig(lens, lens, turned, -turned @ [0.2, 0.01, 0.02]), method="fusiello")
    assert "ended at a view of 10°" in str(rect.notes["warning"])


def test_hartley_keeps_the_right_image_rigid_at_its_centre() -> None:
    lens = rb.Camera("pinhole", (640, 480), {"fx": 520, "fy": 520, "cx": 319.5, "cy": 239.5})
    turned = rig(rotation_deg=(1, 3, 2)).R_right_left
    rect = rb.rectify(rb.Rig(lens, lens, turned, -turned @ [0.2, 0.01, 0.02]), method="hartley")
    J = rect.right.jacobian([319.5, 239.5])
    np.testing.assert_allclose(J.T @ J, np.eye(2), atol=1e-9)


def test_methods_from_matches_need_eight() -> None:
    pair = rig()
    _, left, right = points_before(pair, 10)
    with pytest.raises(rb.Unsupported, match="expected 8 or more"):
        rb.rectify(pair, method="hartley", matches=(left[:5], right[:5]))


def test_methods_from_matches_do_not_look_at_the_pose() -> None:
    pair = rig("kannala-brandt")
    _, left, right = points_before(pair, 300)
    wrong = rb.Rig(pair.left, pair.right, np.eye(3), pair.t_right_left)
    for method in ("hartley", "fusiello"):
        maps = [rb.rectify(r, method=method, matches=(left, right)).maps("left") for r in (pair, wrong)]
        np.testing.assert_array_equal(*maps)


@pytest.mark.parametrize("seed", range(6))
def test_fusiello_never_turns_the_images_upside_down(seed: int) -> None:
    # A short baseline and a tilt: the images move more up and down than sideways.
    pair = rig(rotation_deg=(2.0, 0.3, 1.0), centre_m=(0.06, 0.001, 0.0))
    _, left, right = points_before(pair, 300, seed)
    noise = np.random.default_rng(seed).normal(0, 0.05, (2, *left.shape))
    rect = rb.rectify(pair, method="fusiello", matches=(left + noise[0], right + noise[1]))
    assert rb.metrics.order(rect, pair)["order_upright"] == 1


def test_fusiello_is_a_pair_of_rotations() -> None:
    pair = rig(rotation_deg=(2, 4, 3))
    rect = rb.rectify(pair, method="fusiello")
    true_left, true_right = rb.rectifying_rotations(pair)
    # Up to the turn about the baseline, which matches leave free, they are the rig's own.
    np.testing.assert_allclose(rect.R_rect_left[0], true_left[0], atol=1e-6)
    np.testing.assert_allclose(rect.R_rect_right[0], true_right[0], atol=1e-6)
    np.testing.assert_allclose(np.tril(rect.left.target.matrix, -1), 0, atol=1e-9)


def test_degenerate_matches_are_refused_at_once() -> None:
    pair = rig()
    same = np.full((30, 2), 150.0)
    with pytest.raises(rb.InvalidInput, match="same pixel or in one line"):
        rb.rectify(pair, method="hartley", matches=(same, same + 4))


def test_a_perspective_image_between_narrow_cameras_far_apart_is_refused() -> None:
    narrow = rb.Camera("equisolid", (357, 102), {"fx": 341, "fy": 346, "cx": 180, "cy": 50})
    wide = rb.Camera("orthographic", (280, 388), {"fx": 144, "fy": 142, "cx": 144, "cy": 195}, 76.9)
    turned = Rotation.from_rotvec([-1.247, -1.43, 0.392]).as_matrix()
    with pytest.raises(
        rb.Unsupported, match="of one of the views nothing lies on a perspective image of 357x"
    ):
        rb.rectify(rb.Rig(narrow, wide, turned, np.array([0.121, -0.123, 0.101])), method="conventional")


def test_polar_says_where_no_image_is_large_enough_to_keep_every_pixel() -> None:
    dot = rb.Camera("pinhole", (1590, 1200), {"fx": 1.6, "fy": 1.6, "cx": 794.5, "cy": 599.5}, 89.8)
    lens = rb.Camera("equidistant", (145, 160), {"fx": 48, "fy": 48, "cx": 72.5, "cy": 82}, 85)
    turned = Rotation.from_rotvec([-0.639, -0.099, -0.809]).as_matrix()
    with pytest.raises(rb.Unsupported, match="to lose no source pixel, the rectified image would be"):
        rb.rectify(rb.Rig(dot, lens, turned, np.array([-0.161, -0.05, -0.108])), method="polar")
