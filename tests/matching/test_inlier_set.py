"""The inlier set of an essential matrix: no pose has more, no bound is too low, no start matters."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench.errors import UnknownName
from rectbench.matching import relative_pose
from rectbench.matching.pose import inlier_set
from rectbench.matching.pose.epipolar import Pose, RayMatches, essential
from rectbench.matching.pose.inlier_set import Boxes, Terms, most_inliers
from tests.matching.test_relative_pose import noisy_matches
from tests.rigs_for_tests import rig

RIG = rig("equidistant", fov_deg=150.0)
LIMIT_PX = 1.5
NO_TURN = Pose(np.eye(3), np.array([0.0, 1.0, 0.0]))
"""As far from the truth as a start can be that knows nothing."""


def rays(count: int = 20, outliers: float = 0.3, seed: int = 0) -> RayMatches:
    matches, _ = RayMatches.of(RIG.left, RIG.right, noisy_matches(RIG, 0.3, outliers, seed, count))
    return matches


def inliers(pose: Pose, matches: RayMatches) -> int:
    """By the definition, in double precision: the angle of the right ray to the epipolar plane."""
    planes = np.cross(pose.t, matches.left @ pose.R.T)
    sines = np.abs((planes * matches.right).sum(axis=1)) / np.linalg.norm(planes, axis=1)
    return int((np.arcsin(sines) <= LIMIT_PX * matches.rad_per_px).sum())


def test_from_a_start_that_knows_nothing_it_finds_what_no_other_pose_betters() -> None:
    matches, rng = rays(), np.random.default_rng(0)
    found = most_inliers(matches, LIMIT_PX, NO_TURN, within_deg=10.0)
    assert found.inliers == found.bound == inliers(found.pose, matches)
    true = Pose(RIG.R_right_left, RIG.t_right_left / RIG.baseline_m)
    rivals = [true.moved(rng.normal(0, scale, 5)) for scale in (1e-4, 1e-3, 1e-2) for _ in range(500)]
    best = max(inliers(rival, matches) for rival in [true, *rivals])
    assert inliers(NO_TURN, matches) < 0.5 * best <= 0.5 * found.inliers


def test_where_it_starts_changes_nothing_but_the_time() -> None:
    matches = rays(seed=3)
    true = Pose(RIG.R_right_left, RIG.t_right_left / RIG.baseline_m)
    counts = {most_inliers(matches, LIMIT_PX, start, within_deg=10.0).inliers for start in (NO_TURN, true)}
    assert len(counts) == 1


@pytest.mark.parametrize("size", [0.3, 0.05, 0.005])
def test_no_pose_in_a_box_has_more_inliers_than_the_boxs_bound(size: float) -> None:
    matches, rng = rays(60, seed=1), np.random.default_rng(2)
    true_turn = Rotation.from_matrix(RIG.R_right_left).as_rotvec()
    t = RIG.t_right_left / RIG.baseline_m * np.sign(RIG.t_right_left[2])  # the half sphere that the disk is
    true_place = t[:2] / np.linalg.norm(t[:2]) * math.acos(t[2])
    count = 40
    boxes = Boxes(
        true_turn + rng.normal(0, size, (count, 3)),
        np.full(count, size),
        true_place + rng.normal(0, size, (count, 2)),
        np.full(count, size),
    )
    bounds = Terms.of(matches, LIMIT_PX).scores(boxes).bounds
    for turn, place, bound in zip(boxes.turns, boxes.places, bounds, strict=True):
        turns = turn + rng.uniform(-size, size, (50, 3))
        places = place + rng.uniform(-size, size, (50, 2))
        turns[0] = np.clip(true_turn, turn - size, turn + size)
        places[0] = np.clip(true_place, place - size, place + size)
        inside = Boxes(turns, np.zeros(50), places, np.zeros(50))
        poses = (Pose(*both) for both in zip(inside.rotations, inside.directions, strict=True))
        assert max(inliers(pose, matches) for pose in poses) <= bound


def test_the_parts_of_a_box_fill_it() -> None:
    box = Boxes(np.array([[0.1, -0.2, 0.3]]), np.array([0.2]), np.array([[0.5, 0.1]]), np.array([0.4]))
    turns, places = box.turns_split(), box.places_split()
    assert len(turns) == 8
    assert len(places) == 4
    assert (8 * turns.half_turns**3).sum() == pytest.approx(8 * 0.2**3)
    assert (np.abs(turns.turns - box.turns) <= box.half_turns - turns.half_turns[0] + 1e-12).all()
    assert (np.abs(places.places - box.places) <= box.half_places - places.half_places[0] + 1e-12).all()


def test_the_four_readings_of_an_essential_matrix_have_the_same_inliers() -> None:
    matches = rays(40)
    terms = Terms.of(matches, LIMIT_PX)
    pose = Pose(RIG.R_right_left, RIG.t_right_left / RIG.baseline_m)
    twisted = Pose((2 * np.outer(pose.t, pose.t) - np.eye(3)) @ pose.R, -pose.t)
    assert np.allclose(np.abs(essential(twisted)), np.abs(essential(pose)))
    assert terms.inliers(twisted) == terms.inliers(pose) == inliers(pose, matches)


def test_a_search_that_is_cut_off_tells_what_it_left_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inlier_set, "MOST_BOXES", 100)
    found = most_inliers(rays(), LIMIT_PX, NO_TURN)
    assert found.inliers < found.bound


def test_as_a_search_for_the_relative_pose_it_finds_the_true_one_among_wrong_matches(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(inlier_set, "WITHIN_DEG", 8.0)
    monkeypatch.setattr(inlier_set, "MOST_MATCHES", 30)
    matches = noisy_matches(RIG, 0.2, outliers=0.4, count=120)
    found = relative_pose(RIG.left, RIG.right, matches, search="inlier-set")
    rotation_deg, direction_deg = found.difference_deg(RIG)
    assert rotation_deg < 5 * found.rotation_sigma_deg
    assert direction_deg < 5 * found.direction_sigma_deg


def test_a_search_that_there_is_not_is_told_with_the_nearest_name() -> None:
    with pytest.raises(UnknownName, match=r"unknown search 'ransack'; did you mean .*ransac"):
        relative_pose(RIG.left, RIG.right, noisy_matches(RIG), search="ransack")
