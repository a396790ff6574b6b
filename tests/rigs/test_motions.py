from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import Rig, load_rig
from rectbench.rigs import MOTIONS

SEEDS = range(25)


def angle_deg(R: np.ndarray) -> float:
    return float(np.degrees(Rotation.from_matrix(R).magnitude()))


def test_as_calibrated_is_the_rig_itself(rig: Rig) -> None:
    assert MOTIONS["as-calibrated"].apply(rig, 3) is rig


@pytest.mark.parametrize("name", ["sideways", "wide", "toed-in", "rolled"])
def test_the_right_camera_stands_to_the_right(rig: Rig, name: str) -> None:
    for seed in SEEDS:
        centre = MOTIONS[name].apply(rig, seed).centre_right_in_left
        assert centre[0] > 0.99 * np.linalg.norm(centre)


@pytest.mark.parametrize(("name", "factor"), [("sideways", 1), ("wide", 3), ("toed-in", 1), ("rolled", 1)])
def test_the_baseline_is_as_stated(rig: Rig, name: str, factor: float) -> None:
    assert MOTIONS[name].apply(rig, 1).baseline_m == pytest.approx(factor * rig.baseline_m, rel=1e-12)


def test_wide_stays_within_bounds_and_never_narrows(rig: Rig) -> None:
    for baseline, expected in [(0.9, 1.5), (4.0, 4.0)]:
        moved = MOTIONS["wide"].apply(dataclasses.replace(rig, t_right_left=[-baseline, 0, 0]), 0)
        assert moved.baseline_m == pytest.approx(expected, rel=1e-12)


def test_sideways_turns_and_shifts_a_little(rig: Rig) -> None:
    turns = []
    for seed in SEEDS:
        moved = MOTIONS["sideways"].apply(rig, seed)
        turns.append(angle_deg(moved.R_right_left))
        off_axis = moved.centre_right_in_left[1:] / moved.centre_right_in_left[0]
        assert np.abs(off_axis).max() <= 0.03
    assert 0.1 < min(turns) < max(turns) <= 2 * np.sqrt(3)


def test_toed_in_cameras_look_at_one_point_ahead(rig: Rig) -> None:
    for seed in SEEDS:
        moved = MOTIONS["toed-in"].apply(rig, seed)
        axis_right_in_left = moved.R_right_left.T @ [0, 0, 1]
        assert np.degrees(np.arctan2(-axis_right_in_left[0], axis_right_in_left[2])) == pytest.approx(
            6, abs=0.6
        )


def test_rolled_turns_about_the_axis(rig: Rig) -> None:
    for seed in SEEDS:
        moved = MOTIONS["rolled"].apply(rig, seed)
        assert angle_deg(moved.R_right_left) == pytest.approx(10, abs=1)
        assert (moved.R_right_left.T @ [0, 0, 1])[2] > np.cos(np.radians(0.9))


@pytest.mark.parametrize(
    ("name", "direction"),
    [
        ("forward", (0, 0, 1)),
        ("backward", (0, 0, -1)),
        ("diagonal", (np.sqrt(0.5), 0, np.sqrt(0.5))),
        ("vertical", (0, 1, 0)),
    ],
)
def test_the_right_camera_stands_where_the_motion_says(
    rig: Rig, name: str, direction: tuple[float, float, float]
) -> None:
    for seed in SEEDS:
        moved = MOTIONS[name].apply(rig, seed)
        np.testing.assert_allclose(
            moved.centre_right_in_left, rig.baseline_m * np.array(direction), atol=1e-12
        )
        assert angle_deg(moved.R_right_left) < 0.9


@pytest.mark.parametrize("angle", [30, 60, 90])
def test_cameras_apart_look_so_far_apart_and_outwards(rig: Rig, angle: int) -> None:
    for seed in SEEDS:
        moved = MOTIONS[f"apart-{angle}"].apply(rig, seed)
        x, y, z = moved.R_right_left.T @ [0, 0, 1]  # the right axis in the left frame
        assert np.degrees(np.arctan2(x, z)) == pytest.approx(angle, abs=0.8)
        assert abs(y) < 0.02
        np.testing.assert_allclose(moved.centre_right_in_left, [rig.baseline_m, 0, 0], atol=1e-12)


@pytest.mark.parametrize("name", [name for name in MOTIONS if name != "as-calibrated"])
def test_the_seed_alone_decides(rig: Rig, name: str) -> None:
    motion = MOTIONS[name]
    assert motion.apply(rig, 5) == motion.apply(rig, 5)
    assert motion.apply(rig, 5) != motion.apply(rig, 6)
    other = motion.apply(load_rig("t265"), 5)
    np.testing.assert_allclose(other.R_right_left, motion.apply(rig, 5).R_right_left, atol=1e-14)


def test_the_draw_is_the_same_on_every_machine(rig: Rig) -> None:
    R = MOTIONS["sideways"].apply(rig, 0).R_right_left
    expected = [-1.3255459429254093, -0.3948516243175208, 0.9771135840990662]
    np.testing.assert_allclose(Rotation.from_matrix(R).as_rotvec(degrees=True), expected, atol=1e-9)
