"""The covariance of a rig: what is none is refused, sizes mean what they say, draws scatter as told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench import InvalidInput, Rig, RigCovariance, UnknownName
from rectbench.rigs import PoseNoise, perturb
from rectbench.rigs.covariance import POSE, moved
from tests import rigs_for_tests
from tests.matching.box_room import pair_of


def pose_step(believed: Rig, other: Rig) -> np.ndarray:
    """The six pose parameters [6] from one rig to another."""
    turn = Rotation.from_matrix(other.R_right_left @ believed.R_right_left.T).as_rotvec()
    return np.concatenate([turn, other.t_right_left - believed.t_right_left])


def test_sizes_make_the_covariance_of_the_bench_s_own_pose_noise(rig: Rig) -> None:
    noise = PoseNoise(rotation_deg=0.02, direction_deg=0.1)
    steps = np.array([pose_step(rig, perturb(rig, noise, seed)) for seed in range(3000)])
    covariance = RigCovariance.from_sigmas(rig, rotation_deg=0.02, direction_deg=0.1).over(POSE)
    scale = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(
        steps.T @ steps / len(steps) / np.outer(scale, scale), covariance / np.outer(scale, scale), atol=0.06
    )


def test_the_baseline_s_length_is_unsure_along_the_baseline_alone(rig: Rig) -> None:
    covariance = RigCovariance.from_sigmas(rig, baseline_m=1e-3).over(POSE)
    along = rig.t_right_left / rig.baseline_m
    np.testing.assert_allclose(covariance[3:, 3:], 1e-6 * np.outer(along, along), atol=1e-20)


def test_focal_lengths_keep_the_pixels_shape_and_centres_go_each_their_way(rig: Rig) -> None:
    covariance = RigCovariance.from_sigmas(rig, focal_px=2.0, centre_px=0.5)
    fx, fy = (rig.left.params[name] for name in ("fx", "fy"))
    pair = covariance.over(("left.fx", "left.fy"))
    np.testing.assert_allclose(pair, 4.0 * np.outer([1, fy / fx], [1, fy / fx]))
    np.testing.assert_allclose(covariance.over(("right.cx", "right.cy", "left.cx")), 0.25 * np.eye(3))
    assert covariance.sigma("left.fx") == 2.0
    assert covariance.sigma("left.k1") == 0.0
    assert "pose.rx" not in covariance.uncertain


def test_draws_scatter_as_a_singular_covariance_says(rig: Rig) -> None:
    names = ("pose.ry", "pose.tz", "right.k1")
    root = np.array([[1e-3, 0], [2e-4, 1e-4], [0, 1e-3]])
    covariance = RigCovariance(names, root @ root.T)
    rng = np.random.default_rng(0)
    drawn = [covariance.draw(rig, rng) for _ in range(1000)]
    steps = np.array(
        [[*pose_step(rig, one)[[1, 5]], one.right.params["k1"] - rig.right.params["k1"]] for one in drawn]
    )
    scale = np.sqrt(np.diag(covariance.matrix))
    np.testing.assert_allclose(
        np.cov(steps.T) / np.outer(scale, scale), covariance.matrix / np.outer(scale, scale), atol=0.1
    )
    assert all(one.left == rig.left for one in drawn)


def test_a_moved_rig_has_moved_by_what_was_said(rig: Rig) -> None:
    step = {"pose.rx": 0.01, "pose.rz": -0.02, "pose.ty": 0.003, "left.cx": 1.5}
    other = moved(rig, step)
    np.testing.assert_allclose(pose_step(rig, other), [0.01, 0, -0.02, 0, 0.003, 0], atol=1e-12)
    assert other.left.params["cx"] == rig.left.params["cx"] + 1.5
    assert moved(rig, {}) == rig


def test_covariances_of_some_of_the_same_parameters_add() -> None:
    a = RigCovariance(("pose.rx", "left.fx"), [[1, 0.5], [0.5, 2]], "a")
    b = RigCovariance(("left.fx", "left.fy"), [[3, 1], [1, 4]], "b")
    both = a + b
    assert (both.parameters, both.source) == (("pose.rx", "left.fx", "left.fy"), "a + b")
    np.testing.assert_array_equal(both.matrix, [[1, 0.5, 0], [0.5, 5, 1], [0, 1, 4]])


def test_an_estimated_pose_scatters_about_the_truth_as_its_covariance_says() -> None:
    room = rigs_for_tests.rig("kannala-brandt", size=(480, 360))
    estimate = rb.estimate_pose(pair_of(room), room)
    covariance = estimate.rig_covariance(room).over(POSE)
    step = pose_step(estimate.rig(room), room)
    # In the five directions that images tell, by the covariance's own scale.
    variances, axes = np.linalg.eigh(covariance)
    assert variances[0] < 1e-6 * variances[1]
    chi_square = ((axes.T @ step)[1:] ** 2 / variances[1:]).sum()
    assert 0.5 < chi_square < 20


@pytest.mark.parametrize(
    ("names", "matrix", "message"),
    [
        (("pose.rx", "pose.rx"), np.eye(2), "pose.rx is there twice"),
        (("pose.qx",), [[1]], "unknown parameter of a rig 'pose.qx'"),
        (("middle.fx",), [[1]], "unknown parameter of a rig 'middle.fx'"),
        (("left",), [[1]], "unknown parameter of a rig 'left'"),
        (("left.fx",), np.eye(2), r"shape \(2, 2\); expected 1x1"),
        (("left.fx",), [["wide"]], "no array of numbers"),
        (("left.fx",), [[np.nan]], "NaN or infinity"),
        (("left.fx",), [[-1]], "the variance of left.fx is -1"),
        (("left.fx", "left.k4"), [[1, 1e-5], [2e-5, 1e-8]], "left.fx and left.k4 is 1e-05 and 2e-05"),
        (("left.fx", "left.k4"), [[1, 2e-4], [2e-4, 1e-8]], "an eigenvalue below 0"),
        (("left.fx", "left.fy"), [[0, 1], [1, 1]], "an eigenvalue below 0"),
    ],
)
def test_what_is_no_covariance_is_refused(names: tuple[str, ...], matrix: object, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        RigCovariance(names, matrix)


@pytest.mark.parametrize(
    ("sizes", "message"),
    [
        ({"rotation_deg": -1}, "rotation_deg is -1; expected a number from 0 on"),
        ({"direction_deg": np.nan}, "direction_deg is nan"),
        ({"rotation_deg": 180}, "expected degrees below 180"),
        ({"parameters": {"left.k1": "much"}}, "left.k1 is 'much'"),
    ],
)
def test_sizes_that_are_none_are_refused(rig: Rig, sizes: dict, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        RigCovariance.from_sigmas(rig, **sizes)


def test_a_parameter_of_another_lens_is_refused(rig: Rig) -> None:
    with pytest.raises(UnknownName, match=r"parameter of the left lens \(kannala-brandt\) 'p1'"):
        RigCovariance.from_sigmas(rig, parameters={"left.p1": 0.1})
    with pytest.raises(UnknownName, match="unknown parameter of a rig"):
        moved(rig, {"pose.yaw": 0.1})


def test_a_focal_length_of_a_lens_without_one_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"focal_px is 1, but the left lens \(ocam\) has no fx and fy"):
        RigCovariance.from_sigmas(rb.load_rig("ocam"), focal_px=1)


def test_what_is_saved_is_read_again_to_the_last_bit(rig: Rig, tmp_path: Path) -> None:
    covariance = RigCovariance.from_sigmas(rig, rotation_deg=0.1, direction_deg=0.3, focal_px=1 / 3)
    covariance.save(tmp_path / "covariance.yaml")
    found = rb.load_covariance(tmp_path / "covariance.yaml", rig)
    assert (found.parameters, found.source) == (covariance.parameters, covariance.source)
    np.testing.assert_array_equal(found.matrix, covariance.matrix)
