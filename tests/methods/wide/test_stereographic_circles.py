"""stereographic-circles: conformal about the smallest cap, both images of a point on one circle."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.rigs_for_tests import points_before, rig


def circle_through(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float]:
    """Middle and radius of the circle through three points."""
    middle = np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])
    return middle, float(np.linalg.norm(a - middle))


@pytest.mark.parametrize("model", ["equidistant", "double-sphere"])
def test_corresponding_points_lie_on_one_circle_through_the_epipoles(model: str) -> None:
    pair = rig(model, centre_m=(0.1, 0.03, -0.02))
    rect = rb.rectify(pair, "stereographic-circles")
    towards = rect.left.R_rect_cam @ pair.centre_right_in_left
    epipoles, _ = rect.left.target.project([towards, -towards])
    _, px_left, px_right = points_before(pair, 60)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    for p, q in zip(left, right, strict=True):
        middle, radius = circle_through(*epipoles, p)
        assert np.linalg.norm(q - middle) == pytest.approx(radius, abs=1e-7 * radius)
    assert np.abs(left[:, 1] - right[:, 1]).max() > 0.5  # rows they are not
    assert rb.metrics.row_error(rect, px_left, px_right).columns()["row_error_max_px"] < 1e-7


def test_row_errors_are_distances_to_the_circle() -> None:
    pair = rig()
    rect = rb.rectify(pair, "stereographic-circles")
    towards = rect.left.R_rect_cam @ pair.centre_right_in_left
    epipoles, _ = rect.left.target.project([towards, -towards])
    _, px_left, px_right = points_before(pair, 60)
    px_right = px_right + np.random.default_rng(0).normal(0, 0.3, px_right.shape)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    errors = rb.metrics.row_error(rect, px_left, px_right).rectified_px
    for p, q, error in zip(left, right, errors, strict=True):
        middle, radius = circle_through(*epipoles, p)
        distance = abs(np.linalg.norm(q - middle) - radius)
        assert error == pytest.approx(distance, rel=0.05, abs=1e-3)


def test_in_source_pixels_its_row_errors_are_those_of_any_method_that_knows_the_pose() -> None:
    pair = rig()
    turn = Rotation.from_rotvec([2e-3, 1e-3, 2e-3]).as_matrix()
    believed = rb.Rig(pair.left, pair.right, turn @ pair.R_right_left, pair.t_right_left)
    _, px_left, px_right = points_before(pair)
    ours, theirs = (
        rb.metrics.row_error(rb.rectify(believed, method), px_left, px_right).source_px
        for method in ("stereographic-circles", "abraham")
    )
    both = np.isfinite(ours) & np.isfinite(theirs)
    assert np.median(ours[both]) > 0.1
    np.testing.assert_allclose(ours[both], theirs[both], rtol=0.03, atol=2e-3)


def test_another_frame_leaves_points_on_one_curve() -> None:
    pair = rig()
    squeezed = rb.rectify(pair, "stereographic-circles").windowed((10.0, 20.0), (300.0, 200.0), (900, 100))
    _, px_left, px_right = points_before(pair)
    errors = rb.metrics.row_error(squeezed, px_left, px_right).columns()
    assert errors["row_error_max_px"] < 1e-7
    assert errors["row_error_matches"] > 50


def test_it_is_conformal_and_its_scale_grows_with_the_angle() -> None:
    rect = rb.rectify(rig("kannala-brandt"), "stereographic-circles", focal_px=100.0)
    rays = rect.rig.left.unproject(rb.evaluation_pixels(rect.rig.left, 100))[0] @ rect.left.R_rect_cam.T
    J = rect.left.target.project_jacobian(rays)
    scales = 2 * 100.0 / (1 + rays[:, 2])
    np.testing.assert_allclose(J @ J.mT, (scales**2)[:, None, None] * np.eye(2), rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("name", ["bumblebee2", "t265", "lens-220"])
def test_no_other_middle_is_nearer_to_the_farthest_ray(name: str) -> None:
    pair = rb.load_rig(name).trimmed(rb.MARGIN_DEG)
    rect = rb.rectify(pair, "stereographic-circles")
    rays = np.concatenate(
        [
            warp.source.unproject(rb.evaluation_pixels(warp.source))[0] @ warp.R_rect_cam.T
            for warp in (rect.left, rect.right)
        ]
    )
    reach = rays[:, 2].min()
    rng = np.random.default_rng(0)
    for spread in (1.0, 0.1, 0.01, 0.001):
        others = [0, 0, 1] + spread * rng.normal(size=(500, 3))
        others /= np.linalg.norm(others, axis=1, keepdims=True)
        assert (others @ rays.T).min(axis=1).max() <= reach + 1e-9
