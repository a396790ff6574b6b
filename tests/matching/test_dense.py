"""Dense disparity: right where the truth is known, silent where nothing can be known."""

from __future__ import annotations

import logging
from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.matching import MATCHERS, Disparity, dense_disparity
from rectbench.matching.dense import disparity as dense
from rectbench.registry import registry
from tests.matching.sphere_room import sphere_pair, true_disparity
from tests.rigs_for_tests import rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
SIZE = {"size": (240, 160)}


def small_rig(**kwargs: object) -> rb.Rig:
    return rig("equidistant", **SIZE, **kwargs)  # type: ignore[arg-type]


RIGS = {
    "left camera first": small_rig(),
    "right camera first": small_rig(centre_m=(-0.12, 0.0, 0.0)),
    "toed in": small_rig(rotation_deg=(0.5, 9.0, 0.3)),
    "vertical": small_rig(centre_m=(0.005, 0.12, 0.0)),
}


@cache
def pair_of(name: str) -> rb.StereoPair:
    return sphere_pair(RIGS[name])


def errors(found: Disparity) -> tuple[np.ndarray, np.ndarray]:
    """|found - true| where both exist, and the mask of the pixels that both images show."""
    truth = true_disparity(found.rect).px
    return np.abs(found.px - truth)[np.isfinite(truth) & np.isfinite(found.px)], np.isfinite(truth)


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("method", METHODS)
def test_the_search_range_holds_every_disparity_and_little_more(method: str, name: str) -> None:
    rect = rb.rectify(RIGS[name], method=method)
    truth = true_disparity(rect).px
    lowest, highest = dense.shared_disparities(rect, nearest_baselines=6.0)
    # The sphere of 14 baselines reaches from 9.6 to 18.4 of them.
    assert lowest - 0.5 <= np.nanmin(truth)
    assert np.nanmax(truth) <= highest + 0.5
    assert highest - lowest < 0.5 * rect.size[0]


def test_disparities_of_a_pair_in_the_other_order_are_negative() -> None:
    rect = rb.rectify(RIGS["right camera first"], method="abraham")
    lowest, highest = dense.shared_disparities(rect, nearest_baselines=6.0)
    assert lowest < -10
    assert highest < 1


@pytest.mark.parametrize("name", RIGS)
@pytest.mark.parametrize("method", ["conventional", "local-homography"])
def test_the_disparity_found_is_the_true_one(method: str, name: str) -> None:
    pair = pair_of(name)
    found = dense_disparity(rb.rectify(RIGS[name], method=method), pair.left, pair.right)
    error, shown = errors(found)
    assert np.median(error) < 0.15
    assert np.quantile(error, 0.95) < 1.0
    assert error.size > 0.9 * shown.sum()


@pytest.mark.parametrize("matcher", registry(MATCHERS).names())
def test_every_matcher_of_the_registry_finds_it(matcher: str) -> None:
    pair = pair_of("left camera first")
    rect = rb.rectify(RIGS["left camera first"], method="abraham")
    error, shown = errors(dense_disparity(rect, pair.left, pair.right, matcher=matcher))
    assert np.median(error) < 0.2
    assert error.size > 0.8 * shown.sum()


def test_pixels_beside_the_border_are_matched_too() -> None:
    pinhole = rb.Camera("pinhole", (240, 160), {"fx": 200, "fy": 200, "cx": 119.5, "cy": 79.5})
    side_by_side = rb.Rig(pinhole, pinhole, np.eye(3), np.array([-0.1, 0, 0]))
    pair = sphere_pair(side_by_side)
    found = dense_disparity(rb.rectify(side_by_side, "conventional"), pair.left, pair.right)
    shown = np.isfinite(true_disparity(found.rect).px)
    assert found.searched_px[1] > 50
    # In the left image the right one begins where the disparity lets it: OpenCV would leave out 50 columns.
    first = np.argmax(shown, axis=1).max() + 1
    assert first < 40
    for columns in (slice(first, first + 5), slice(-5, None)):
        assert np.isfinite(found.px[10:-10, columns]).mean() > 0.8


def test_what_shows_nothing_has_no_disparity() -> None:
    pair = pair_of("left camera first")
    wide = rb.rectify(RIGS["left camera first"], method="conventional", focal="fov", fov_deg=150.0)
    found = dense_disparity(wide, pair.left, pair.right)
    outside = ~wide.valid("left")
    assert outside.mean() > 0.1
    assert np.isnan(found.px[outside]).all()
    target = np.arange(wide.size[0]) - found.px
    exist = np.isfinite(found.px)
    row = np.nonzero(exist)[0]
    near = cv2.dilate(wide.valid("right").astype(np.uint8), np.ones((1, 7), np.uint8)) > 0
    assert near[row, np.clip(np.rint(target[exist]).astype(int), 0, wide.size[0] - 1)].all()


def test_a_matcher_of_ones_own_gets_pictures_and_range_and_is_believed_where_it_agrees() -> None:
    pair = pair_of("left camera first")
    rect = rb.rectify(RIGS["left camera first"], method="abraham")
    asked: list[tuple[int, int]] = []

    def everywhere_seven(left: np.ndarray, right: np.ndarray, lowest: int, highest: int) -> np.ndarray:
        assert left.shape == right.shape == (rect.size[1], rect.size[0], 3)
        assert left.dtype == right.dtype == np.uint8
        asked.append((lowest, highest))
        return np.full(left.shape[:2], 7.0)

    found = dense_disparity(rect, pair.left, pair.right, matcher=everywhere_seven)
    assert asked == [found.searched_px] * 2
    assert np.isfinite(found.px).sum() > 0.9 * rect.valid("left").sum()
    np.testing.assert_allclose(found.px[np.isfinite(found.px)], 7.0, atol=1e-3)


def test_what_the_two_images_contradict_is_given_up() -> None:
    pair = pair_of("left camera first")
    rect = rb.rectify(RIGS["left camera first"], method="abraham")
    answers = iter((5.0, 12.0))

    def contradicts_itself(left: np.ndarray, *_: object) -> np.ndarray:
        return np.full(left.shape[:2], next(answers))

    found = dense_disparity(rect, pair.left, pair.right, matcher=contradicts_itself)
    assert np.isnan(found.px).all()


@pytest.mark.parametrize(
    "answer", [np.zeros((3, 4)), np.zeros(()), np.full((3, 4), "a"), None, np.zeros((3, 4), complex)]
)
def test_a_matcher_that_gives_something_else_is_named(answer: object) -> None:
    pair = pair_of("left camera first")
    rect = rb.rectify(RIGS["left camera first"], method="abraham")
    with pytest.raises(rb.InvalidResult, match=r"the matcher gave .* expected disparities"):
        dense_disparity(rect, pair.left, pair.right, matcher=lambda *_: answer)  # type: ignore[arg-type,return-value]


def test_an_unknown_matcher_is_told_with_the_nearest_names() -> None:
    rect, black = rb.rectify(RIGS["left camera first"]), np.zeros((160, 240, 3), np.uint8)
    with pytest.raises(rb.UnknownName, match=r"unknown matcher 'sgmb'; did you mean .*sgbm"):
        dense_disparity(rect, black, black, matcher="sgmb")
    with pytest.raises(rb.UnknownName, match="unknown matcher"):
        dense_disparity(rect, black, black, matcher=["sgbm"])  # type: ignore[arg-type]


def test_images_of_another_size_are_refused() -> None:
    rect = rb.rectify(RIGS["left camera first"])
    with pytest.raises(rb.InvalidInput, match="the right image is 10x20 px; its camera has 240x160"):
        dense_disparity(rect, np.zeros((160, 240), np.uint8), np.zeros((20, 10), np.uint8))


@pytest.mark.parametrize("wrong", [{"pixels": 0}, {"nearest_baselines": -1.0}, {"pixels": "many"}])
def test_numbers_that_make_no_sense_are_refused(wrong: dict[str, object]) -> None:
    rect, black = rb.rectify(RIGS["left camera first"]), np.zeros((160, 240), np.uint8)
    with pytest.raises(rb.InvalidInput, match="expected a number above 0"):
        dense_disparity(rect, black, black, **wrong)  # type: ignore[arg-type]


def test_blank_images_and_tiny_ones_end_without_a_fault() -> None:
    rect = rb.rectify(RIGS["left camera first"])
    blank = np.full((160, 240), 90, np.uint8)
    assert dense_disparity(rect, blank, blank).px.shape == (rect.size[1], rect.size[0])
    tiny = dense_disparity(rect, blank, blank, pixels=20)
    assert tiny.px.size < 40


def test_views_that_share_nothing_have_no_disparity() -> None:
    narrow = rb.Camera("pinhole", (120, 80), {"fx": 200, "fy": 200, "cx": 59.5, "cy": 39.5})
    apart = rb.Rig(narrow, narrow, cv2.Rodrigues(np.array([0, np.pi / 3, 0]))[0], np.array([-0.1, 0, 0]))
    noise = np.random.default_rng(0).integers(0, 255, (80, 120), np.uint8)
    found = dense_disparity(rb.rectify(apart, "abraham"), noise, noise)
    assert np.isnan(found.px).all()


def test_a_large_image_is_matched_at_the_pixels_asked_for() -> None:
    pair = pair_of("left camera first")
    found = dense_disparity(
        rb.rectify(RIGS["left camera first"], "abraham"), pair.left, pair.right, pixels=15e3
    )
    width, height = found.rect.size
    assert width * height == pytest.approx(15e3, rel=0.02)
    assert np.median(errors(found)[0]) < 0.2


def test_a_search_too_wide_is_done_on_a_smaller_image_and_said(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(dense, "WIDEST_SEARCH_PX", 20.0)
    pair = pair_of("left camera first")
    rect = rb.rectify(RIGS["left camera first"], "abraham")
    with caplog.at_level(logging.WARNING):
        found = dense_disparity(rect, pair.left, pair.right)
    assert found.rect.size[0] < rect.size[0]
    assert found.searched_px[1] - found.searched_px[0] <= 26
    assert "too many to search" in caplog.text
    assert np.median(errors(found)[0]) < 0.3


@pytest.mark.parametrize("kind", ["grey", "alpha", "16 bits", "float"])
def test_pictures_of_any_depth_and_channels_do(kind: str) -> None:
    rect = rb.rectify(RIGS["left camera first"], "abraham")
    pair = pair_of("left camera first")
    convert = {
        "grey": lambda image: image.mean(axis=2).astype(np.uint8),
        "alpha": lambda image: np.dstack([image, np.full(image.shape[:2], 255, np.uint8)]),
        "16 bits": lambda image: image.astype(np.uint16) * 16,
        "float": lambda image: image / 255.0,
    }[kind]
    error, shown = errors(dense_disparity(rect, convert(pair.left), convert(pair.right)))
    assert np.median(error) < 0.15
    assert error.size > 0.9 * shown.sum()


def test_without_the_filter_of_opencv_contrib_it_says_what_is_missing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr(cv2, "ximgproc")
    rect, blank = rb.rectify(RIGS["left camera first"]), np.zeros((160, 240), np.uint8)
    with pytest.raises(rb.Unavailable, match="opencv-contrib"):
        dense_disparity(rect, blank, blank)


def test_between_pixels_a_surface_is_blended_and_an_edge_is_not() -> None:
    rect = replace(rb.rectify(RIGS["left camera first"], "abraham"), size=(4, 2))
    px = np.array([[1.0, 1.5, 30.0, np.nan], [2.0, 2.5, 31.0, np.nan]], np.float32)
    found = Disparity(rect, px, np.zeros((2, 4, 3), np.uint8))
    places = [[0.5, 0.0], [0.0, 0.5], [1.4, 0.0], [1.6, 0.0], [2.4, 0.2], [2.6, 0.2], [-0.4, -0.4], [9, 9]]
    expected = [1.25, 1.5, 1.5, 30.0, 30.0, np.nan, 1.0, np.nan]
    np.testing.assert_allclose(found.at(places), expected)
    assert found.at([0.5, 0.5]) == pytest.approx(1.75)


@pytest.mark.parametrize("threads", [2, 3])
def test_disparities_do_not_depend_on_the_number_of_threads(threads: int) -> None:
    usual, found = cv2.getNumThreads(), []
    rect, pair = rb.rectify(RIGS["toed in"], method="abraham"), pair_of("toed in")
    try:
        for count in (1, threads):
            cv2.setNumThreads(count)
            found.append(dense_disparity(rect, pair.left, pair.right).px)
    finally:
        cv2.setNumThreads(usual)
    np.testing.assert_array_equal(*found)
