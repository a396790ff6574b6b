"""What is scored of a view that is trimmed about the epipoles."""

import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics import coverage
from rectbench.rigs.poses import PoseNoise, perturb
from rectbench.scored import Delivered, ScoredView, SeenView, check_agreement
from rectbench.scored.differences import differences
from tests.rigs_for_tests import rig

FORWARD = rig(rotation_deg=(2.0, -3.0, 1.0), centre_m=(0.03, 0.01, 0.3), fov_deg=150)
SIDEWAYS = rig(rotation_deg=(2.0, -3.0, 1.0), centre_m=(0.3, 0.01, 0.02), fov_deg=195, size=(400, 400))


def off_deg(pair: rb.Rig, pixels: np.ndarray) -> np.ndarray:
    """Angles [N] of the left source pixels [N, 2] from the baseline's line."""
    towards = pair.centre_right_in_left / pair.baseline_m
    return np.degrees(np.arccos(np.clip(np.abs(pair.left.unproject(pixels)[0] @ towards), 0, 1)))


@pytest.mark.parametrize("margin_deg", [3.0, 7.0, 12.0])
def test_nothing_is_scored_within_the_margin_and_a_degree_more(margin_deg: float) -> None:
    view = ScoredView.of(FORWARD, margin_deg=margin_deg)
    off = off_deg(FORWARD, view.left.pixels)
    assert margin_deg + 1 <= off.min() < margin_deg + 1.5
    epipole, _ = FORWARD.left.project(FORWARD.centre_right_in_left)
    assert not view.left.within(epipole, 1.0)


def test_a_narrow_margin_is_scored_with_a_narrow_seam() -> None:
    assert off_deg(FORWARD, ScoredView.of(FORWARD, margin_deg=0.5).left.pixels).min() < 1.5


@pytest.mark.parametrize("pair", [FORWARD, SIDEWAYS], ids=["forward", "sideways"])
@pytest.mark.parametrize("method", ["abraham", "local-homography"])
def test_a_method_that_was_told_a_pose_a_degree_off_shows_all_that_is_scored(
    pair: rb.Rig, method: str
) -> None:
    view = ScoredView.of(pair)
    for seed in range(3):
        believed = perturb(pair, PoseNoise(rotation_deg=0.3, direction_deg=0.6), seed)
        found = Delivered.of(rb.rectify(believed, method=method), view)
        assert found.keeps(1.0)


@pytest.mark.parametrize("pair", [FORWARD, SIDEWAYS], ids=["forward", "sideways"])
@pytest.mark.parametrize("method", ["abraham", "local-homography", "conventional"])
def test_what_is_said_of_a_map_with_a_seam_is_one_map(pair: rb.Rig, method: str) -> None:
    rect, view = rb.rectify(pair, method=method), ScoredView.of(pair)
    found = Delivered.of(rect, view)
    check_agreement(rect, found)
    if found.keeps(1.0):
        areas = [side.shares(1.0).sum() for side in (found.left, found.right)]
        np.testing.assert_allclose(areas, 1.0, atol=0.01)


@pytest.mark.parametrize("pair", [FORWARD, SIDEWAYS], ids=["forward", "sideways"])
def test_the_score_is_that_of_exact_derivatives_outside_the_cones(pair: rb.Rig) -> None:
    rect, view = rb.rectify(pair, method="abraham"), ScoredView.of(pair)
    J = np.concatenate([rect.warp(side).jacobian(view.side(side).pixels) for side in ("left", "right")])
    expected = float(np.std(np.log(np.linalg.svd(J, compute_uv=False))))
    assert Delivered.of(rect, view).log_distortion(1.0) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("method", ["local-homography", "polar-optimal"])
def test_at_the_seam_a_derivative_is_that_of_its_own_side(method: str) -> None:
    rect = rb.rectify(FORWARD, method=method)
    assert rect.turn_px is not None
    columns = np.linspace(0.2, 0.8, 50) * rect.size[0]
    for row in (-0.499, rect.turn_px - 0.501):  # both sides of β = ±180°, a thousandth of a row away
        pixels = rect.left.inverse(np.stack([columns, np.full(50, row)], axis=-1))
        pixels = pixels[np.isfinite(pixels).all(axis=1)]
        assert len(pixels) > 10
        _, J = differences(rect.left, pixels, 5e-3, rect.turn_px)
        np.testing.assert_allclose(J, rect.left.jacobian(pixels), rtol=1e-3, atol=1e-3)


def test_coverage_counts_what_was_trimmed_against_the_whole_lens() -> None:
    kept = coverage(rb.rectify(FORWARD, method="abraham", margin_deg=10), FORWARD)
    pixels = SeenView.of(FORWARD.trimmed(10)).left.pixels
    within = float((off_deg(FORWARD, pixels) < 10).mean())
    assert kept["trimmed"] == pytest.approx(within, rel=0.02)
    assert kept["coverage_pixels"] == pytest.approx(1 - kept["trimmed"], abs=1e-9)
    assert kept["coverage_overlap"] < 1


def test_where_nothing_is_trimmed_no_column_says_so() -> None:
    pair = rb.load_rig("t265")
    assert "trimmed" not in coverage(rb.rectify(pair, method="abraham"), pair)


def test_distortion_takes_the_untrimmed_rig() -> None:
    rect = rb.rectify(FORWARD, method="abraham")
    found = rb.metrics.distortion(rect, FORWARD)
    assert found == rb.metrics.distortion(rect, FORWARD.trimmed())
    epipole, _ = FORWARD.left.project(FORWARD.centre_right_in_left)
    ahead = rb.metrics.distortion(rect, FORWARD, pixels=[epipole, [60.0, 60.0]])
    assert np.isnan(ahead.per_pixel["left"][0])
    assert np.isfinite(ahead)


def test_an_epipole_that_crosses_the_edge_changes_everything_by_little() -> None:
    lens = rb.Camera("equidistant", (320, 240), {"fx": 115, "fy": 115, "cx": 159.5, "cy": 119.5})
    found, trimmed = [], []
    for angle in np.radians(np.arange(0.0, 32.0)):  # from the side towards the front: at 10° into the view
        pair = rb.Rig(lens, lens, np.eye(3), -0.1 * np.array([np.cos(angle), 0.0, np.sin(angle)]))
        angular, plane = (rb.rectify(pair, method=method) for method in ("abraham", "conventional"))
        kept = coverage(angular, pair)
        trimmed.append(kept.get("trimmed", 0.0))
        found.append(
            [
                kept["coverage_pixels"],
                coverage(plane, pair)["coverage_pixels"],
                Delivered.of(angular, ScoredView.of(pair)).log_distortion(0.95),
                np.log(np.prod(angular.size)),
            ]
        )
    assert trimmed[0] == 0 < trimmed[-1]
    steps = np.abs(np.diff(found, axis=0)).max(axis=0)
    assert (steps < [0.003, 0.003, 0.005, 0.12]).all()
