"""The relative pose against an independent implementation: PoseLib's RANSAC (Larsson and contributors)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.matching import PoseEstimate, relative_pose
from tests.matching.test_relative_pose import noisy_matches

poselib = pytest.importorskip("poselib", reason="the oracle of relative poses, in the extra `test`")

LENS = rb.Camera("pinhole", (640, 480), {"fx": 520, "fy": 525, "cx": 322.0, "cy": 236.5})
DICT = {"model": "PINHOLE", "width": 640, "height": 480, "params": [520, 525, 322.0, 236.5]}
MOTIONS = {
    "sideways": ((1.0, -2.0, 0.7), (0.12, 0.006, -0.004)),
    "forward": ((0.5, 1.0, -2.0), (0.01, 0.02, 0.12)),
    "turning": ((4.0, -12.0, 3.0), (0.12, -0.03, 0.05)),
}


def pinholes(motion: str) -> rb.Rig:
    rotation_deg, centre_m = MOTIONS[motion]
    R = Rotation.from_rotvec(np.radians(rotation_deg)).as_matrix()
    return rb.Rig(LENS, LENS, R, -R @ np.array(centre_m), name=motion)


def by_poselib(rig: rb.Rig, matches: rb.Matches) -> rb.Rig:
    """The rig in PoseLib's pose."""
    options = {"max_epipolar_error": 1.5, "min_iterations": 1000, "seed": 1}
    pose, _ = poselib.estimate_relative_pose(matches.left, matches.right, DICT, DICT, options, {})
    t = pose.t / np.linalg.norm(pose.t) * rig.baseline_m
    return rb.Rig(LENS, LENS, Rotation.from_matrix(pose.R).as_matrix(), t)


def errors_deg(found: PoseEstimate, oracle: rb.Rig, rig: rb.Rig) -> np.ndarray:
    """Of both from the truth, and between them: rotation and direction [3, 2], degrees."""
    theirs = found.difference_deg(oracle)
    turn = Rotation.from_matrix(oracle.R_right_left @ rig.R_right_left.T).magnitude()
    across = np.cross(oracle.t_right_left, rig.t_right_left) / rig.baseline_m**2
    return np.array(
        [
            found.difference_deg(rig),
            np.degrees([turn, np.arcsin(np.linalg.norm(across))]),
            theirs,
        ]
    )


@pytest.mark.parametrize("motion", MOTIONS)
def test_without_noise_both_find_one_pose(motion: str) -> None:
    rig = pinholes(motion)
    matches = noisy_matches(rig, 0.0)
    _, _, apart = errors_deg(relative_pose(LENS, LENS, matches), by_poselib(rig, matches), rig)
    assert apart.max() < 1e-4


@pytest.mark.parametrize("motion", MOTIONS)
def test_among_wrong_matches_we_are_as_near_to_the_truth_as_it_is(motion: str) -> None:
    rig, errors = pinholes(motion), []
    for seed in range(4):
        matches = noisy_matches(rig, 0.4, outliers=0.3, seed=seed)
        errors.append(errors_deg(relative_pose(LENS, LENS, matches), by_poselib(rig, matches), rig))
    ours, theirs, apart = np.sqrt(np.mean(np.square(errors), axis=0))
    assert (ours < 1.25 * theirs + 0.01).all()
    assert (apart < 2.5 * theirs + 0.05).all()
