"""Warps: inverse, derivative, lookup tables, resampling, triangulation."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings

import rectbench as rb
from rectbench import llvm
from rectbench.warps.lookup import tables
from tests.rigs_for_tests import points_before, rig, rigs

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=6)
@given(rig=rigs)
def test_source_to_rectified_to_source_closes(method: str, rig: rb.Rig) -> None:
    rect = rb.rectify(rig, method=method)
    for warp in (rect.left, rect.right):
        pixels = rb.evaluation_pixels(warp.source, 300)
        back = warp.inverse(warp.forward(pixels))
        mapped = np.isfinite(warp.forward(pixels)).all(axis=-1)
        assert mapped.mean() > 0.5
        assert np.abs(back - pixels)[mapped].max() < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_jacobian_is_the_derivative_of_forward(method: str) -> None:
    rect = rb.rectify(rig("kannala-brandt"), method=method)
    pixels = rb.evaluation_pixels(rect.left.source, 200)
    step = 1e-4
    du, dv = (
        (rect.left.forward(pixels + d) - rect.left.forward(pixels - d)) / (2 * step) for d in np.eye(2) * step
    )
    difference = np.stack([du, dv], axis=-1)
    J = rect.left.jacobian(pixels)
    both = np.isfinite(difference).all(axis=(1, 2)) & np.isfinite(J).all(axis=(1, 2))
    assert both.mean() > 0.5
    np.testing.assert_allclose(J[both], difference[both], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_lookup_tables_hold_the_exact_inverse(method: str) -> None:
    rect = rb.rectify(rig("double-sphere"), method=method)
    map_x, map_y = rect.maps("right")
    assert map_x.dtype == map_y.dtype == np.float32
    assert map_x.shape == (rect.size[1], rect.size[0])
    v, u = np.mgrid[0 : rect.size[1] : 7, 0 : rect.size[0] : 5]
    exact = rect.right.inverse(np.stack([u, v], -1))
    seen = np.isfinite(exact).all(axis=-1)
    assert np.abs(map_x[v, u] - exact[..., 0])[seen].max() < 1e-4
    assert np.abs(map_y[v, u] - exact[..., 1])[seen].max() < 1e-4
    assert (map_x[v, u][~seen] == tables.OUTSIDE).all()


@pytest.mark.parametrize("method", ["conventional", "local-homography"])
def test_lookup_tables_are_the_same_without_a_compiler(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rect = rb.rectify(rig(), method=method)
    compiled = rect.maps("left")
    monkeypatch.setattr(llvm, "available", lambda: False)
    for ours, theirs in zip(compiled, rect.maps("left"), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-4)


def test_perspective_tables_are_those_of_opencv() -> None:
    pair = rig("kannala-brandt")
    rect = rb.rectify(pair, method="conventional")
    p = pair.left.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1]])
    D = np.array([p[f"k{i}"] for i in range(1, 5)])
    theirs = cv2.fisheye.initUndistortRectifyMap(
        K, D, rect.R_rect_left, rect.left.target.matrix, rect.size, cv2.CV_32FC1
    )
    for ours, expected in zip(rect.maps("left"), theirs, strict=True):
        np.testing.assert_allclose(ours, expected, atol=1e-3)


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=6)
@given(rig=rigs)
def test_triangulation_undoes_projection(method: str, rig: rb.Rig) -> None:
    rect = rb.rectify(rig, method=method)
    points, px_left, px_right = points_before(rig, 60)
    rect_left, rect_right = rect.left.forward(px_left), rect.right.forward(px_right)
    kept = np.isfinite(rect_left + rect_right).all(axis=-1)
    found = rect.triangulate(rect_left, rect_left[:, 0] - rect_right[:, 0])[kept]
    # A homography fitted to matches is not exactly the rig's, so that its rows differ by a hair.
    tolerance = 1e-6 if method not in ("hartley", "fusiello") else 1e-2
    assert kept.any()
    assert (
        np.linalg.norm(found - points[kept], axis=1) / np.linalg.norm(points[kept], axis=1)
    ).max() < tolerance


def test_a_swapped_pair_triangulates_in_front_with_negative_disparity() -> None:
    swapped = rig(centre_m=(-0.12, 0.0, 0.0))
    rect = rb.rectify(swapped, method="abraham")
    points, px_left, px_right = points_before(swapped, 50)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    disparity = left[:, 0] - right[:, 0]
    assert (disparity < 0).all()
    np.testing.assert_allclose(rect.triangulate(left, disparity), points, rtol=1e-6)


def test_rays_that_do_not_meet_in_front_give_nan() -> None:
    rect = rb.rectify(rig(rotation_deg=(0, 0, 0)), method="abraham")
    assert np.isnan(rect.triangulate([100.0, 100.0], -3.0)).all()


def test_remap_puts_a_point_of_light_where_forward_says() -> None:
    pair = rig("equisolid")
    rect = rb.rectify(pair, method="local-homography")
    u, v = np.meshgrid(np.arange(480.0), np.arange(320.0))
    spot = np.array([200.3, 140.7])
    image = np.exp(-((u - spot[0]) ** 2 + (v - spot[1]) ** 2) / (2 * 3.0**2)).astype(np.float32)
    warped, _ = rect.remap(image, image)
    rows, columns = np.mgrid[: rect.size[1], : rect.size[0]]
    centroid = np.array([(warped * columns).sum(), (warped * rows).sum()]) / warped.sum()
    np.testing.assert_allclose(centroid, rect.left.forward(spot), atol=0.1)


def test_an_image_of_another_size_is_refused() -> None:
    rect = rb.rectify(rig(), method="abraham")
    with pytest.raises(rb.InvalidInput, match="the right image is 10x20 px; its camera has 480x320"):
        rect.remap(np.zeros((320, 480), np.uint8), np.zeros((20, 10), np.uint8))


def test_valid_marks_exactly_the_pixels_that_read_source_pixels() -> None:
    rect = rb.rectify(rig(), method="conventional", focal="fov", fov_deg=140.0)
    white = np.full((320, 480), 255, np.uint8)
    warped, _ = rect.remap(white, white)
    mask = rect.valid("left")
    assert 0.3 < mask.mean() < 1
    assert (warped[mask] == 255).all()
    assert (warped[~mask] < 255).mean() > 0.95


@pytest.mark.parametrize("R", [5 * np.eye(3), np.diag([1.0, 1, 0]), np.full((3, 3), np.nan), np.eye(2)])
def test_a_warp_turns_by_a_rotation_only(R: np.ndarray) -> None:
    target = rb.Perspective.from_focal(100, 50, 50)
    with pytest.raises(rb.InvalidInput, match="R_rect_cam"):
        rb.Warp(rig().left, R, target)


@pytest.mark.parametrize("size", [10, (float("nan"), 10), (0, 5), (40_000, 10), "ab"])
def test_a_size_that_makes_no_image_is_refused(size: object) -> None:
    rect = rb.rectify(rig())
    with pytest.raises(rb.InvalidInput):
        rb.Rectification(rect.rig, rect.left, rect.right, size)  # type: ignore[arg-type]


def test_notes_are_text_or_numbers() -> None:
    rect = rb.rectify(rig())
    kept = rb.Rectification(rect.rig, rect.left, rect.right, rect.size, {"a": np.float32(2), "b": "c"})
    assert kept.notes == {"a": 2.0, "b": "c"}
    with pytest.raises(rb.InvalidInput, match=r"notes\['x'\] is ndarray; expected text or a number"):
        rb.Rectification(rect.rig, rect.left, rect.right, rect.size, {"x": np.zeros(2)})  # type: ignore[dict-item]


def test_triangulation_wants_a_disparity_for_each_pixel() -> None:
    with pytest.raises(rb.InvalidInput, match="disparity_px"):
        rb.rectify(rig()).triangulate(np.zeros((5, 2)), np.zeros(4))
