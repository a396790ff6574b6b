"""Plane sweeping: its maps are the homographies of planes, its depths the true ones, through any lens."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.matching.dense.correlation import NOISE_GREY, WINDOW, correlation, most_alike
from rectbench.matching.dense.plane_sweep import on_the_right
from rectbench.metrics.unrectified.plane_sweep import PlaneSweep
from tests.matching.sphere_room import sphere_pair, sphere_truth
from tests.matching.test_matchers import Pair
from tests.rigs_for_tests import rig

AHEAD = [(0.0, 0.0, 1.0)]
LENS = rb.Camera("pinhole", (120, 80), {"fx": 90, "fy": 90, "cx": 59.5, "cy": 39.5})
ROOMS = {
    "pinholes": rb.Rig(LENS, LENS, np.eye(3), np.array([-0.1, 0, 0])),
    "fisheyes": rig("equidistant", size=(120, 80)),
    "fisheyes of 185°": rig("equidistant", size=(110, 110), fov_deg=185),
    "one above the other": rig("kannala-brandt", size=(120, 80), centre_m=(0.005, 0.12, 0.0)),
}


@cache
def depth_errors(name: str, ahead: bool = False) -> np.ndarray:
    """|depth / true depth - 1| of the pixels that both cameras see; NaN without a depth."""
    room = ROOMS[name]
    truth, pair = sphere_truth(room), sphere_pair(room)
    given = {"directions": AHEAD} if ahead else {}
    depth = rb.plane_sweep(room, pair.left, pair.right, **given).depth  # type: ignore[arg-type]
    errors: np.ndarray = np.abs(depth / truth.depth_left - 1)[truth.visible_left]
    return errors


def test_of_pinhole_images_a_plane_is_a_homography() -> None:
    R, t, n, d = cv2.Rodrigues(np.array([0.02, -0.05, 0.03]))[0], np.array([-0.1, 0.01, 0.02]), AHEAD[0], 1.7
    pinholes = rb.Rig(LENS, LENS, R, t)
    pixels = LENS.pixel_grid().reshape(-1, 2)
    rays, _ = LENS.unproject(pixels)
    px, seen = on_the_right(pinholes, rays, rays @ n / d)
    K = np.array([[90, 0, 59.5], [0, 90, 39.5], [0, 0, 1]])
    H = K @ (R + np.outer(t, n) / d) @ np.linalg.inv(K)  # Hartley and Zisserman, 13.1, for n·X = d
    expected = cv2.perspectiveTransform(pixels[None], H)[0]
    np.testing.assert_allclose(px[seen], expected[seen], atol=1e-9)
    assert seen.mean() > 0.7


@pytest.mark.parametrize("name", ROOMS)
def test_through_any_lens_nearly_all_depths_are_found_and_true(name: str) -> None:
    errors = depth_errors(name)
    assert np.isfinite(errors).mean() > 0.9
    assert np.nanmedian(errors) < 0.02
    assert (errors < 0.05).mean() > 0.85


def test_beside_a_wide_lens_planes_ahead_alone_find_little() -> None:
    ahead, around = depth_errors("fisheyes of 185°", ahead=True), depth_errors("fisheyes of 185°")
    assert np.isfinite(ahead).mean() < 0.6 * np.isfinite(around).mean()


def test_the_ground_is_found_best_by_planes_that_lie_as_it_does() -> None:
    lens = rb.Camera("pinhole", (120, 80), {"fx": 70, "fy": 70, "cx": 59.5, "cy": -10.5})
    looking_down = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    height_m, grain = 0.5, np.random.default_rng(0).integers(0, 256, (600, 600), np.uint8)
    texture = cv2.normalize(cv2.GaussianBlur(grain, (0, 0), 1.2), None, 0, 255, cv2.NORM_MINMAX)  # type: ignore[call-overload]
    rays, _ = lens.unproject(lens.pixel_grid())
    depth = height_m / rays[..., 1]

    def image(x_m: float) -> np.ndarray:
        ground = rays * depth[..., None] + [x_m, 0, 0]
        u, v = (ground[..., i].astype(np.float32) * 60 + 250 for i in (0, 2))
        return cv2.remap(texture, u, v, cv2.INTER_LINEAR)

    errors = {}
    for direction in ((0, 0, 1), (0, 1, 0)):
        swept = rb.plane_sweep(looking_down, image(0.0), image(0.1), directions=[direction])
        errors[direction] = np.abs(swept.depth / depth - 1)[rays[..., 1] > 0.3]
    tilted, lying = errors[0, 0, 1], errors[0, 1, 0]
    found = np.isfinite(tilted) & np.isfinite(lying)
    assert found.sum() > 100
    assert np.median(lying[found]) < 0.7 * np.median(tilted[found])


def test_the_correlation_of_windows_is_that_of_numpy() -> None:
    rng = np.random.default_rng(1)
    first, second = (rng.uniform(0, 255, (20, 25)).astype(np.float32) for _ in range(2))
    half, (v, u) = WINDOW // 2, (9, 12)
    a, b = (i[v - half : v + half + 1, u - half : u + half + 1].ravel() for i in (first, second))
    covariance = np.cov(a, b, bias=True) + NOISE_GREY**2 * np.eye(2)
    expected = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert correlation(first, second)[v, u] == pytest.approx(expected, abs=1e-4)


def test_the_best_of_hypotheses_is_found_between_them_and_none_at_an_end() -> None:
    peaks = np.array([[2.3, 4.0, -0.7, 9.4]])
    scores = (np.asarray(0.9 - 0.01 * (i - peaks) ** 2, np.float32) for i in range(9))
    place, score = most_alike(scores, peaks.shape)
    np.testing.assert_allclose(place, [[2.3, 4.0, np.nan, np.nan]], atol=1e-3)
    assert score[0, 1] == pytest.approx(0.9)


def test_a_larger_image_is_swept_at_the_pixels_asked_for_and_asked_at_its_own() -> None:
    room = ROOMS["fisheyes"]
    pair = sphere_pair(room)
    swept = rb.plane_sweep(room, pair.left, pair.right, pixels=2_400, directions=AHEAD)
    assert swept.rig.left.size == (60, 40)
    assert swept.at([119.0, 79.0], (120, 80)) == pytest.approx(float(swept.depth[39, 59]), nan_ok=True)
    assert swept.at([60.0, 40.0], (120, 80)) == pytest.approx(float(swept.depth[20, 30]))


def test_blank_images_have_no_depth() -> None:
    blank = np.full((80, 120), 90, np.uint8)
    assert np.isnan(rb.plane_sweep(ROOMS["fisheyes"], blank, blank, directions=AHEAD).depth).all()


@pytest.mark.parametrize(
    ("wrong", "fault"),
    [
        ({"directions": [(0, 0, 0)]}, "expected normals"),
        ({"directions": [(0, 1)]}, "expected normals"),
        ({"pixels": 0}, "expected a number above 0"),
        ({"nearest_baselines": -1.0}, "expected a number above 0"),
    ],
)
def test_what_makes_no_sense_is_refused(wrong: dict[str, object], fault: str) -> None:
    blank = np.zeros((80, 120), np.uint8)
    with pytest.raises(rb.InvalidInput, match=fault):
        rb.plane_sweep(ROOMS["fisheyes"], blank, blank, **wrong)  # type: ignore[arg-type]
    with pytest.raises(rb.InvalidInput, match="the right image is 10x20 px; its camera has 120x80"):
        rb.plane_sweep(ROOMS["fisheyes"], blank, np.zeros((20, 10), np.uint8))


def test_a_report_tells_what_rectification_gains_over_a_sweep() -> None:
    pair = Pair()

    def row(method: str, **options: object) -> dict[str, float]:
        case = rb.Case(rb.rectify(pair.rig, method, **options), pair, matcher="ncc")  # type: ignore[arg-type]
        return PlaneSweep().compute(case)

    whole, narrow = row("abraham"), row("conventional", focal="fov", fov_deg=50)
    assert whole["sweep_completeness"] == narrow["sweep_completeness"] > 0.85
    assert abs(whole["rectification_gain"]) < 0.1
    assert narrow["rectification_gain"] < -0.3  # what is cut off is not found
