"""Framing: what is asked is what one gets, and it is the same rectification."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rectbench as rb
from rectbench.warps.view.framing import Framing, focal_px, framed
from rectbench.warps.view.inscribed import largest_rectangle
from tests.rigs_for_tests import points_before, rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")


def rectified(method: str, model: str = "kannala-brandt") -> rb.Rectification:
    return rb.rectify(rig(model), method=method)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "framing",
    [
        Framing(crop="valid"),
        Framing(crop=(30.5, 20, 200, 150.25)),
        Framing(fov_deg=(60, 45), size=(320, 240)),
        Framing(coverage=0.8, pixels=50_000),
        Framing(focal_px=123.0, size=(301, 199)),
    ],
    ids=["valid", "crop", "fov", "coverage", "focal"],
)
def test_every_frame_shows_the_same_rectification(method: str, framing: Framing) -> None:
    rect = rectified(method)
    other = framed(rect, framing)
    _, px_left, px_right = points_before(rect.rig, 60)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    left_framed, right_framed = other.left.forward(px_left), other.right.forward(px_right)
    seen = np.isfinite(left).all(axis=1) & np.isfinite(right).all(axis=1)
    assert seen.sum() > 20
    left, right, left_framed, right_framed = (a[seen] for a in (left, right, left_framed, right_framed))
    scale = (left_framed[1] - left_framed[0]) / (left[1] - left[0])
    assert scale[0] == pytest.approx(scale[1], rel=1e-6)  # one scale along rows and columns
    np.testing.assert_allclose(left_framed - left_framed[0], scale[0] * (left - left[0]), atol=1e-6)
    np.testing.assert_allclose(left_framed - right_framed, scale[0] * (left - right), atol=1e-6)
    np.testing.assert_allclose(
        other.triangulate(left_framed, left_framed[:, 0] - right_framed[:, 0]),
        rect.triangulate(left, left[:, 0] - right[:, 0]),
        rtol=1e-5,
    )


@pytest.mark.parametrize("method", METHODS)
def test_a_valid_crop_shows_source_pixels_alone(method: str) -> None:
    rect = framed(rectified(method), Framing(crop="valid"))
    assert rect.valid("left").all()
    assert rect.valid("right").all()
    assert rb.metrics.coverage(rect, rect.rig)["coverage_pixels"] > 0.4


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("share", [0.3, 0.75, 0.95])
def test_the_share_that_is_asked_for_is_kept(method: str, share: float) -> None:
    rect = framed(rectified(method), Framing(coverage=share))
    assert rb.metrics.coverage(rect, rect.rig)["coverage_pixels"] == pytest.approx(share, abs=0.004)


@pytest.mark.parametrize("method", ["abraham", "local-homography"])
def test_full_coverage_keeps_every_pixel(method: str) -> None:
    rect = framed(rectified(method), Framing(coverage=1.0))
    assert rb.metrics.coverage(rect, rect.rig)["coverage_pixels"] == 1.0


def test_a_perspective_image_of_more_than_half_the_world_cannot_keep_all() -> None:
    camera = rb.Camera("equidistant", (400, 300), {"fx": 110, "fy": 110, "cx": 199.5, "cy": 149.5}, 100.0)
    wide = rb.Rig(camera, camera, np.eye(3), np.array([0, -0.1, 0]))
    rect = rb.rectify(wide.within(84.0), method="conventional")
    beyond = rb.Rectification(
        wide,
        rb.Warp(camera, rect.R_rect_left, rect.left.target),
        rb.Warp(camera, rect.R_rect_right, rect.right.target),
        rect.size,
    )
    with pytest.raises(rb.Unsupported, match="can keep"):
        framed(beyond, Framing(coverage=0.99))


@pytest.mark.parametrize("method", ["conventional", "abraham"])
def test_a_field_of_view_spans_its_angles(method: str) -> None:
    rect = framed(rectified(method), Framing(fov_deg=(80, 50), size=(800, 800)))
    width, height = rect.size
    # The wider of the two angles, 80 degrees, fills the frame's width.
    row = [[-0.5, (height - 1) / 2], [width - 0.5, (height - 1) / 2]]
    left, right = rect.left.target.unproject(row)[0]
    assert np.degrees(np.arccos(left @ right)) == pytest.approx(80, abs=1.5)
    middle = rect.left.target.unproject([(width - 1) / 2, (height - 1) / 2])[0]
    assert np.degrees(np.arccos(middle @ [0, 0, 1])) < 8


def test_the_focal_length_of_a_perspective_frame_is_the_one_asked_for() -> None:
    rect = framed(rectified("conventional"), Framing(focal_px=200.0))
    P = rect.left.target.matrix  # type: ignore[attr-defined]
    assert P[0, 0] == pytest.approx(200, rel=1e-9)
    assert P[1, 1] == pytest.approx(200, rel=1e-9)
    assert focal_px(rect) == pytest.approx(200, rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_the_source_resolution_is_matched_at_the_centre(method: str) -> None:
    rect = framed(rectified(method), Framing(focal_px="source"))
    assert focal_px(rect) == pytest.approx(rb.centre_resolution_px(rect.rig), rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_budget_of_pixels_is_kept_and_never_enlarges(method: str) -> None:
    rect = rectified(method)
    small = framed(rect, Framing(pixels=30_000))
    assert 29_000 < np.prod(small.size) < 31_000
    assert framed(rect, Framing(pixels=1e9)).size == rect.size


def test_the_size_that_is_asked_for_is_the_size() -> None:
    rect = rectified("abraham")
    assert framed(rect, Framing(size=(333, 111))).size == (333, 111)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"crop": "valid", "coverage": 0.5}, "crop and coverage both say what is shown"),
        ({"size": (100, 100), "pixels": 1e4}, "size and pixels"),
        ({"coverage": 0.0}, "coverage is 0.0"),
        ({"coverage": 1.2}, "coverage is 1.2"),
        ({"coverage": float("nan")}, "coverage is nan"),
        ({"fov_deg": (0, 40)}, "fov_deg is"),
        ({"fov_deg": 40}, "fov_deg is 40"),
        ({"size": (0, 40)}, "size is"),
        ({"size": (40000, 40)}, "size is"),
        ({"crop": (1, 2, 3)}, "crop is"),
        ({"focal_px": -1}, "focal_px is -1"),
        ({"focal_px": "centre"}, "focal_px is 'centre'"),
        ({"pixels": float("inf")}, "pixels is inf"),
    ],
)
def test_what_is_no_frame_is_refused(words: dict[str, object], message: str) -> None:
    with pytest.raises(rb.InvalidInput, match=message):
        Framing(**words)  # type: ignore[arg-type]


def test_a_frame_too_large_or_too_wide_is_refused() -> None:
    rect = rectified("conventional")
    with pytest.raises(rb.InvalidInput, match="megapixels"):
        framed(rect, Framing(focal_px=1e5))
    with pytest.raises(rb.Unsupported, match="epipoles"):
        framed(rect, Framing(fov_deg=(200, 60)))
    with pytest.raises(rb.Unsupported, match="does not reach"):
        framed(rectified("local-homography"), Framing(fov_deg=(60, 170)))
    with pytest.raises(rb.Unsupported, match="nothing is left"):
        framed(rect, Framing(crop=(10, 10, -5, 5)))


def area_of_largest_by_brute_force(mask: np.ndarray) -> int:
    sums = cv2.integral(mask.astype(np.uint8))
    height, width = mask.shape
    return max(
        (bottom - top) * (right - left)
        for top in range(height + 1)
        for bottom in range(top, height + 1)
        for left in range(width + 1)
        for right in range(left, width + 1)
        if sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
        == (bottom - top) * (right - left)
    )


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(1, 9), st.floats(0, 1))
def test_the_rectangle_is_the_largest_there_is(seed: int, height: int, width: int, share: float) -> None:
    mask = np.random.default_rng(seed).random((height, width)) < share
    box = largest_rectangle(mask)
    assert mask[box.top : box.bottom, box.left : box.right].all()
    assert box.area == area_of_largest_by_brute_force(mask)


def test_in_a_large_mask_the_rectangle_ends_where_valid_pixels_end() -> None:
    mask = np.zeros((1501, 1203), dtype=bool)
    mask[37:1401, 111:1177] = True
    assert largest_rectangle(mask) == (111, 37, 1177, 1401)


@pytest.mark.parametrize("size", [{"focal_px": 400.0}, {"size": (800, 300)}, {"pixels": 30_001}])
@pytest.mark.parametrize("method", ["abraham", "local-homography", "conventional"])
def test_a_valid_crop_stays_valid_at_another_size(method: str, size: dict[str, object]) -> None:
    rect = framed(rectified(method), Framing(crop="valid", **size))  # type: ignore[arg-type]
    assert rect.valid("left").all()
    assert rect.valid("right").all()
    assert size.get("size", rect.size) == rect.size


@given(st.floats(2, 1e6))
def test_a_budget_is_never_overdrawn(pixels: float) -> None:
    width, height = framed(rectified("abraham"), Framing(pixels=pixels)).size
    assert width * height <= pixels * (1 + 1e-6) or min(width, height) == 1


def test_what_is_narrower_than_a_cell_is_found_all_the_same() -> None:
    mask = np.zeros((2000, 2000), dtype=bool)
    mask[801:803, 100:1900] = True
    assert largest_rectangle(mask) == (100, 801, 1900, 803)
