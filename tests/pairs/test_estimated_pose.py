"""A report whose poses come from the images: estimated once a pair, shared by all methods, never invented."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.experiments.execution.cells import DESK, problem_of
from rectbench.experiments.planning import make_plan
from rectbench.pairs.opening import open_pair
from rectbench.runs.making import run
from rectbench.store.store import Store
from tests.experiments.fakes import small_report, write_scene

SMALL: dict[str, Any] = {
    "rigs": ("t265",),
    "motions": ("sideways",),
    "poses": ("estimated",),
    "methods": ("abraham", "hartley"),
    "image_width": 320,
    "metrics": ("row_error", "distortion"),
}


@pytest.fixture
def wall(tmp_path: Path) -> str:
    return write_scene(tmp_path, "wall")


def report(scene: str) -> rb.Report:
    return small_report(**SMALL, scenes=(scene,))


def test_all_methods_share_the_pose_their_images_tell(tmp_path: Path, wall: str) -> None:
    table = run(report(wall), tmp_path / "out", jobs=1)
    assert table["status"].tolist() == ["ok", "ok"]
    assert table["pose_rotation_error_deg"].nunique() == 1
    assert table["pose_rotation_error_deg"].iloc[0] < 0.2
    assert table["pose_direction_error_deg"].iloc[0] < 2.0
    assert table["pose_inliers"].iloc[0] <= table["pose_matches"].iloc[0]
    assert (table["row_error_mean_px"] < 1).all()


def test_an_estimate_reads_back_as_it_was_made(wall: str, store: Store) -> None:
    task = make_plan(report(wall)).tasks[0]
    made = open_pair(task.pair, store).estimate
    read = open_pair(task.pair, store).estimate
    assert made is not read
    for name in ("R_right_left", "direction_right_left", "covariance"):
        np.testing.assert_array_equal(getattr(made, name), getattr(read, name))
    np.testing.assert_array_equal(np.stack(made.inliers), np.stack(read.inliers))
    assert (made.given, made.noise_px, made.motion) == (read.given, read.noise_px, read.motion)
    assert dict(made.seconds) == dict(read.seconds)


def test_the_believed_rig_has_the_true_baselines_length_alone(wall: str, store: Store) -> None:
    task = make_plan(report(wall)).tasks[0]
    pair = open_pair(task.pair, store)
    true, believed = pair.rig, pair.believed_rig(task.cell.pose)
    assert believed.baseline_m == pytest.approx(true.baseline_m, rel=1e-12)
    assert (believed.R_right_left != true.R_right_left).any()
    assert believed.left == true.left


def test_methods_that_work_from_matches_get_those_of_the_estimate(wall: str, store: Store) -> None:
    task = make_plan(report(wall)).tasks[1]
    pair = open_pair(task.pair, store)
    assert problem_of(task, pair).known_matches is pair.estimate.inliers


def test_a_pair_without_a_pose_is_rows_with_a_reason(tmp_path: Path) -> None:
    blank = Path(write_scene(tmp_path, "blank"))
    grey = "rb.Material(np.full((4, 4, 3), 0.5, np.float32))"
    blank.write_text(blank.read_text().replace("rb.Material(texels)", grey))
    for _ in range(2):  # measured, then from the store
        table = run(report(str(blank)), tmp_path / "out", jobs=1)
        assert table["status"].tolist() == ["unsupported"] * 2
        assert table["reason"].str.contains("expected at least 8").all()
        DESK.clear()
