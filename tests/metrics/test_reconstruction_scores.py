"""Reconstruction scores: the truth scores full marks, a known error scores itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rectbench as rb
from rectbench.matching import Disparity
from rectbench.warps.rectification import in_frame
from tests.matching.sphere_room import sphere_truth, true_disparity
from tests.rigs_for_tests import LENSES, aligned_rig, rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
RINGS = ("0_20deg", "20_40deg", "40_60deg", "60_90deg")


def shown_share(rect: rb.Rectification, truth: rb.Truth) -> float:
    """Share of the pixels that both cameras see that also land in both rectified images."""
    v, u = np.nonzero(truth.visible_left)
    left = rect.left.forward(np.stack([u, v], axis=-1))
    right = rect.right.forward(truth.px_right_of_left[v, u])
    return float((in_frame(left, rect.size) & in_frame(right, rect.size)).mean())


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("method", METHODS)
def test_the_true_disparity_scores_full_marks(method: str, lens: str) -> None:
    room = rig(lens, size=(160, 120))
    truth, rect = sphere_truth(room), rb.rectify(room, method=method)
    scores = rb.metrics.reconstruction_scores(rb.Reconstruction(true_disparity(rect)), truth)
    shown = shown_share(rect, truth)
    # Pixels by the rim of the rectified image have no neighbours to read their disparity from.
    for column in ("reconstruction_density", "reconstruction_completeness"):
        assert shown - 0.06 < scores[column] < shown + 1e-3
    for limit in (1, 2, 4):
        assert scores[f"dense_bad_{limit}px"] == pytest.approx(1 - scores["reconstruction_density"], abs=1e-9)
    assert scores["dense_epe_px"] < 0.02
    assert scores["depth_error_median"] < 2e-3
    assert scores["depth_error_p95"] < 1e-2


def flat_wall(distance_baselines: float) -> tuple[rb.Rig, rb.Truth, rb.Rectification, float]:
    """Pinholes side by side before a wall, whose rectified images are the images themselves."""
    lens = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    rays = lens.unproject(lens.pixel_grid())[0]
    depth = 0.1 * distance_baselines / rays[..., 2]
    bare = rb.Truth(pair, depth, depth, np.ones((120, 160), bool), np.ones((120, 160), bool))
    visible = np.isfinite(bare.px_right_of_left[..., 0])
    rect = rb.rectify(pair, "conventional", focal="fov", fov_deg=np.degrees(2 * np.arctan(80 / 120)))
    return pair, replace(bare, visible_left=visible), rect, 120 / distance_baselines


@pytest.mark.parametrize("error_px", [0.5, -1.5, 3.0])
def test_a_constant_error_of_disparity_scores_itself(error_px: float) -> None:
    _, truth, rect, disparity = flat_wall(distance_baselines=6.0)
    px = np.full((120, 160), disparity + error_px, np.float32)
    found = rb.Reconstruction(Disparity(rect, px, np.zeros((120, 160, 3), np.uint8)))
    scores = rb.metrics.reconstruction_scores(found, truth)
    assert scores["dense_epe_px"] == pytest.approx(abs(error_px), abs=1e-6)
    for limit in (1, 2, 4):
        assert scores[f"dense_bad_{limit}px"] == float(abs(error_px) > limit)
    relative = abs(disparity / (disparity + error_px) - 1)
    assert scores["depth_error_median"] == pytest.approx(relative, abs=1e-6)
    assert scores["depth_error_p95"] == pytest.approx(relative, abs=1e-6)
    assert scores["reconstruction_completeness"] == float(relative <= 0.05)
    assert scores["reconstruction_density"] == 1.0


def test_pixels_without_a_disparity_are_bad_and_not_in_the_mean() -> None:
    _, truth, rect, disparity = flat_wall(distance_baselines=6.0)
    px = np.full((120, 160), disparity, np.float32)
    px[60:] = np.nan
    found = rb.Reconstruction(Disparity(rect, px, np.zeros((120, 160, 3), np.uint8)))
    scores = rb.metrics.reconstruction_scores(found, truth)
    assert scores["reconstruction_density"] == scores["reconstruction_completeness"] == 0.5
    assert scores["dense_bad_1px"] == scores["dense_bad_4px"] == 0.5
    assert scores["dense_epe_px"] == pytest.approx(0, abs=1e-6)


def test_what_a_method_cuts_off_counts_against_it_in_its_ring() -> None:
    wide = aligned_rig(160, 120, fov_deg=150.0)
    truth = sphere_truth(wide)
    cut = rb.rectify(wide, "conventional", focal="fov", fov_deg=80.0)
    scores = rb.metrics.reconstruction_scores(rb.Reconstruction(true_disparity(cut)), truth)
    rings = [scores[f"reconstruction_completeness_{ring}"] for ring in RINGS]
    assert rings[0] > 0.95
    assert rings[3] == 0
    assert scores["reconstruction_completeness"] < 0.5


def test_rings_that_a_lens_has_not_are_nan() -> None:
    _, truth, rect, disparity = flat_wall(distance_baselines=6.0)
    px = np.full((120, 160), disparity, np.float32)
    found = rb.Reconstruction(Disparity(rect, px, np.zeros((120, 160, 3), np.uint8)))
    scores = rb.metrics.reconstruction_scores(found, truth)
    assert scores["reconstruction_completeness_20_40deg"] == 1.0
    assert np.isnan(scores["reconstruction_completeness_60_90deg"])


def test_nothing_found_and_nothing_to_find_are_told_apart() -> None:
    _, truth, rect, _ = flat_wall(distance_baselines=6.0)
    px = np.full((120, 160), np.nan, np.float32)
    nothing = rb.Reconstruction(Disparity(rect, px, np.zeros((120, 160, 3), np.uint8)))
    scores = rb.metrics.reconstruction_scores(nothing, truth)
    assert scores["reconstruction_density"] == 0
    assert scores["dense_bad_4px"] == 1
    assert np.isnan(scores["dense_epe_px"])
    unseen = replace(truth, visible_left=np.zeros((120, 160), bool))
    assert all(np.isnan(v) for v in rb.metrics.reconstruction_scores(nothing, unseen).values())


def test_the_truth_of_other_cameras_is_refused() -> None:
    _, _, rect, _ = flat_wall(distance_baselines=6.0)
    found = rb.Reconstruction(true_disparity(rect))
    with pytest.raises(rb.InvalidInput, match="of 160x120 px images, the truth of 100x80"):
        rb.metrics.reconstruction_scores(found, sphere_truth(rig(size=(100, 80))))
