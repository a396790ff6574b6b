"""The paper's own measures: row error on rectified images, the view at source size, depth over sizes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics.paper.reconstruction_sizes import MEGAPIXELS, ReconstructionSizes, sized
from rectbench.metrics.paper.row_error_rectified_features import RectifiedFeatureRowError
from rectbench.metrics.paper.view_at_source_size import ViewAtSourceSize, share_in_window
from tests.rigs_for_tests import aligned_rig

SIZE = WIDTH, HEIGHT = 320, 240
SHIFT = 8
LENS = rb.Camera("pinhole", SIZE, {"fx": 240, "fy": 240, "cx": 159.5, "cy": 119.5})
WALL = rb.Rig(LENS, LENS, np.eye(3), np.array([-0.1, 0, 0]))
DEPTH = 240 * 0.1 / SHIFT


@dataclass
class Wall:
    """A printed wall across the view of two pinholes side by side, `SHIFT` pixels of disparity away."""

    rig: rb.Rig = field(default_factory=lambda: WALL)
    knows_truth: bool = True
    scored_view: rb.ScoredView = field(default_factory=lambda: rb.ScoredView.of(WALL))

    @property
    def images(self) -> rb.StereoPair:
        noise = np.random.default_rng(0).integers(0, 256, (HEIGHT, WIDTH + SHIFT), np.uint8)
        print_ = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)  # type: ignore[call-overload]
        left, right = (np.repeat(part[..., None], 3, 2) for part in (print_[:, :WIDTH], print_[:, SHIFT:]))
        return rb.StereoPair(left, right)

    @property
    def truth(self) -> rb.Truth:
        depth = DEPTH / LENS.unproject(LENS.pixel_grid())[0][..., 2]
        seen = np.ones((HEIGHT, WIDTH), bool)
        bare = rb.Truth(WALL, depth, depth, seen, seen)
        return replace(bare, visible_left=np.isfinite(bare.px_right_of_left[..., 0]))


def case(rect: rb.Rectification, pair: Any = None) -> rb.Case:
    return rb.Case(rect, pair or Wall(rig=rect.rig, scored_view=rb.ScoredView.of(rect.rig)))


def nodding(angle_deg: float) -> rb.Rectification:
    """The wall rectified by a pose whose right camera nods by that much."""
    a = np.radians(angle_deg)
    nod = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    believed = rb.Rig(LENS, LENS, nod, WALL.t_right_left)
    return rb.rectify(believed, "abraham")


def test_features_on_rectified_images_of_the_right_pose_lie_on_rows() -> None:
    row = RectifiedFeatureRowError().compute(rb.Case(rb.rectify(WALL, "abraham"), Wall()))
    assert row["row_error_rectified_features_mean_px"] < 0.15
    assert row["row_error_rectified_features_matches"] > 100


def test_a_pose_that_nods_shows_in_them_by_its_angle() -> None:
    row = RectifiedFeatureRowError().compute(rb.Case(nodding(0.3), Wall()))
    expected = 240 * np.radians(0.3)
    assert row["row_error_rectified_features_mean_px"] == pytest.approx(expected, rel=0.15)
    assert row["row_error_rectified_features_source_mean_px"] == pytest.approx(expected, rel=0.15)


def test_a_smaller_image_has_a_smaller_row_error_and_the_same_in_source_pixels() -> None:
    large, small = (
        RectifiedFeatureRowError().compute(rb.Case(nodding(0.5).scaled(factor), Wall()))
        for factor in (1.0, 0.6)
    )
    keys = "row_error_rectified_features_mean_px", "row_error_rectified_features_source_mean_px"
    assert small[keys[0]] == pytest.approx(0.6 * large[keys[0]], rel=0.15)
    assert small[keys[1]] == pytest.approx(large[keys[1]], rel=0.15)


def test_a_window_keeps_what_brute_force_finds() -> None:
    rng = np.random.default_rng(3)
    sides = [rng.normal(0, 40, (300, 2)), rng.normal(5, 50, (300, 2))]
    best = 0.0
    rows = np.concatenate(sides)[:, 1]
    for top in np.linspace(rows.min(), rows.max() - 60, 400):
        total = 0.0
        for side in sides:
            inside = side[(side[:, 1] >= top) & (side[:, 1] <= top + 60), 0]
            total += max(
                np.mean(
                    (side[:, 1] >= top)
                    & (side[:, 1] <= top + 60)
                    & (side[:, 0] >= u)
                    & (side[:, 0] <= u + 90)
                )
                for u in inside
            )
        best = max(best, total / 2)
    assert share_in_window(sides, (90, 60)) == pytest.approx(best, abs=0.01)


def test_the_source_itself_keeps_all_of_its_view_and_no_scaling_changes_that() -> None:
    still = rb.rectify(WALL, "conventional")
    for factor in (0.5, 1.0, 2.0):
        assert ViewAtSourceSize().compute(case(still.scaled(factor)))["view_at_source_size"] > 0.99


def test_a_perspective_image_of_a_fisheye_loses_what_its_stretched_rim_pushes_out() -> None:
    rig = aligned_rig(400, 400, 150)
    kept = {
        method: ViewAtSourceSize().compute(case(rb.rectify(rig, method)))["view_at_source_size"]
        for method in ("conventional", "abraham")
    }
    x, y, z = rig.left.unproject(rig.left.pixel_grid().reshape(-1, 2))[0].T
    half = 200 / rig.left.params["fx"]
    inside = (z > 0) & (np.abs(x) <= half * z) & (np.abs(y) <= half * z)
    assert kept["conventional"] == pytest.approx(inside.mean(), abs=0.01)
    assert kept["abraham"] > kept["conventional"] + 0.2


@pytest.mark.parametrize("method", ["abraham", "conventional"])
def test_the_matched_image_shows_the_source_in_as_many_pixels_as_stated(method: str) -> None:
    rig = aligned_rig(400, 300, 120)
    for megapixels, rect, frame_pixels in sized(rb.rectify(rig, method)):
        matched = rect.scaled(np.sqrt(frame_pixels / (rect.size[0] * rect.size[1])))
        assert matched.valid("left").sum() == pytest.approx(1e6 * megapixels, rel=0.03)


def test_a_wall_is_found_whatever_the_size_and_a_view_that_is_cut_off_has_no_number() -> None:
    found = ReconstructionSizes().compute(rb.Case(rb.rectify(WALL, "abraham"), Wall()))
    assert len(found) == 2 * 3 * len(MEGAPIXELS)
    assert min(value for key, value in found.items() if "_50_" in key) > 0.95
    cut = rb.framed(rb.rectify(WALL, "abraham"), rb.Framing(coverage=0.85))
    assert {
        key.split("_at_")[0].rsplit("_")[-1] for key in ReconstructionSizes().compute(rb.Case(cut, Wall()))
    } == {
        "50",
        "75",
    }
