"""The pose from matches: right for any lens and motion, honest about its error, else refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.matching import PoseEstimate, relative_pose
from rectbench.matching.pose.bundle import adjusted
from rectbench.matching.pose.epipolar import Pose, RayMatches, tangents
from tests.rigs_for_tests import points_before, rig, rigs

WIDE = rig("equidistant", fov_deg=230.0, size=(500, 500))


def noisy_matches(
    rig: rb.Rig, noise_px: float = 0.3, outliers: float = 0.0, seed: int = 0, count: int = 300
) -> rb.Matches:
    """Matches of random points, some replaced by random pairs of pixels."""
    rng = np.random.default_rng(seed)
    _, left, right = points_before(rig, count, seed)
    wrong = round(outliers * len(left) / (1 - outliers))
    random = rng.uniform([[0, 0]], [rig.left.size], (2 * wrong, 2)).reshape(2, wrong, 2)
    exact = np.stack([left, right])
    return rb.Matches(*np.concatenate([exact + rng.normal(0, noise_px, exact.shape), random], axis=1))


def estimated(rig: rb.Rig, matches: rb.Matches, seed: int = 0) -> PoseEstimate:
    return relative_pose(rig.left, rig.right, matches, seed=seed)


@given(rig=rigs, seed=st.integers(0, 1000))
@settings(max_examples=8)
def test_exact_matches_give_the_exact_pose(rig: rb.Rig, seed: int) -> None:
    rotation_deg, direction_deg = estimated(rig, noisy_matches(rig, 0.0, seed=seed)).difference_deg(rig)
    assert rotation_deg < 1e-4
    assert direction_deg < 1e-3


@given(rig=rigs, seed=st.integers(0, 1000))
@settings(max_examples=8)
def test_a_third_of_wrong_matches_does_no_harm(rig: rb.Rig, seed: int) -> None:
    matches = noisy_matches(rig, 0.2, outliers=0.3, seed=seed)
    found = estimated(rig, matches)
    rotation_deg, direction_deg = found.difference_deg(rig)
    assert rotation_deg < 5 * found.rotation_sigma_deg
    assert direction_deg < 5 * found.direction_sigma_deg
    assert rotation_deg < 0.3
    assert len(found.inliers.left) < 0.75 * found.given


@pytest.mark.parametrize(
    "centre_m",
    [(0.12, 0.0, 0.0), (-0.12, 0.0, 0.0), (0.0, 0.12, 0.0), (0.01, 0.02, 0.12), (0.01, 0.02, -0.12)],
    ids=["right", "left", "down", "forward", "backward"],
)
def test_any_motion_is_found_and_named(centre_m: tuple[float, float, float]) -> None:
    moved = rig(centre_m=centre_m)
    found = estimated(moved, noisy_matches(moved, 0.2))
    rotation_deg, direction_deg = found.difference_deg(moved)
    assert rotation_deg < 0.2
    assert direction_deg < 2
    assert found.motion == ("forward" if abs(centre_m[2]) > 0.1 else "sideways")


def test_points_beyond_90_degrees_are_inliers() -> None:
    found = estimated(WIDE, noisy_matches(WIDE, 0.2, count=600))
    rays, _ = WIDE.left.unproject(found.inliers.left)
    assert (rays[:, 2] < 0).mean() > 0.1
    assert found.difference_deg(WIDE)[0] < 0.1


@pytest.mark.parametrize("noise_px", [0.1, 1.0])
def test_the_noise_is_measured(noise_px: float) -> None:
    matches = noisy_matches(WIDE, noise_px, outliers=0.2, count=800)
    assert estimated(WIDE, matches).noise_px == pytest.approx(noise_px, rel=0.15)


@pytest.mark.parametrize("rig", [rig(), WIDE, rig(centre_m=(0.02, 0.0, 0.12))], ids=["120", "230", "forward"])
def test_the_covariance_is_that_of_many_adjustments(rig: rb.Rig) -> None:
    _, left, right = points_before(rig, 200)
    true = Pose(rig.R_right_left, rig.t_right_left / rig.baseline_m)
    errors, covariances = [], []
    for seed in range(60):
        noise = np.random.default_rng(seed).normal(0, 0.3, (2, *left.shape))
        noisy, _ = RayMatches.of(rig.left, rig.right, rb.Matches(left + noise[0], right + noise[1]))
        found = adjusted(rig.left, rig.right, true, noisy)
        turn = Rotation.from_matrix(found.pose.R @ true.R.T).as_rotvec()
        errors.append([*turn, *(tangents(true.t).T @ (found.pose.t - true.t))])
        covariances.append(found.covariance)
    spread = np.sqrt(np.mean(np.square(errors), axis=0))
    believed = np.sqrt(np.diag(np.mean(covariances, axis=0)))
    # 60 errors tell a deviation to a tenth.
    assert (np.abs(np.log(believed / spread)) < np.log(1.4)).all()


def test_the_covariance_has_rank_five() -> None:
    found = estimated(WIDE, noisy_matches(WIDE))
    assert found.covariance.shape == (6, 6)
    np.testing.assert_allclose(
        found.covariance[3:] @ np.r_[0, 0, 0, found.direction_right_left], 0, atol=1e-18
    )
    assert np.linalg.matrix_rank(found.covariance, tol=1e-12) == 5


def test_the_same_seed_gives_the_same_bytes() -> None:
    matches = noisy_matches(WIDE, outliers=0.3)
    one, other = (estimated(WIDE, matches, seed=3) for _ in range(2))
    assert one.R_right_left.tobytes() == other.R_right_left.tobytes()
    assert one.direction_right_left.tobytes() == other.direction_right_left.tobytes()


def test_a_rig_in_the_estimated_pose_keeps_lenses_and_baseline() -> None:
    found = estimated(WIDE, noisy_matches(WIDE))
    placed = found.rig(WIDE)
    assert (placed.left, placed.right) == (WIDE.left, WIDE.right)
    assert placed.baseline_m == pytest.approx(WIDE.baseline_m)
    np.testing.assert_allclose(placed.R_right_left, found.R_right_left)
    assert found.difference_deg(placed) == pytest.approx((0, 0), abs=1e-5)


@pytest.mark.parametrize("count", [0, 1, 5, 7])
def test_fewer_than_eight_matches_are_refused(count: int) -> None:
    left, right = noisy_matches(WIDE)
    with pytest.raises(rb.PoseNotFound, match=f"{count} matches; expected at least 8"):
        estimated(WIDE, rb.Matches(left[:count], right[:count]))


def test_fifteen_good_matches_are_enough() -> None:
    left, right = noisy_matches(WIDE, 0.1)
    rotation_deg, direction_deg = estimated(WIDE, rb.Matches(left[:15], right[:15])).difference_deg(WIDE)
    assert rotation_deg < 1
    assert direction_deg < 10


@pytest.mark.parametrize("count", [8, 12, 30, 100, 300])
def test_random_matches_never_give_a_pose(count: int) -> None:
    for seed in range(2):
        rng = np.random.default_rng(seed)
        left, right = rng.uniform(0, 500, (2, count, 2))
        with pytest.raises(rb.PoseNotFound, match=r"overlap|fit together|matches; expected"):
            estimated(WIDE, rb.Matches(left, right))


@pytest.mark.parametrize("seed", range(3))
def test_a_turn_alone_is_recognised(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pixels = rng.uniform(20, 480, (400, 2))
    rays, _ = WIDE.left.unproject(pixels)
    turned, _ = WIDE.right.project(rays @ WIDE.R_right_left.T)
    # Heavy tails, as real features have.
    noise = rng.standard_t(3, (2, 400, 2)) * 0.2
    wrong = rng.uniform(0, 500, (2, 60, 2))
    matches = rb.Matches(*np.concatenate([np.stack([pixels, turned]) + noise, wrong], axis=1))
    with pytest.raises(rb.PoseNotFound, match="a turn alone explains"):
        estimated(WIDE, matches)


def test_a_few_near_points_among_far_ones_tell_the_pose() -> None:
    rng = np.random.default_rng(0)
    pixels = rng.uniform(20, 480, (400, 2))
    rays, _ = WIDE.left.unproject(pixels)
    distance_m = np.where(np.arange(400) < 60, rng.uniform(0.5, 1.0, 400), 5000.0)[:, None]
    moved, _ = WIDE.right.project(WIDE.right_from_left(rays * distance_m))
    noise = rng.normal(0, 0.2, (2, 400, 2))
    found = estimated(WIDE, rb.Matches(pixels + noise[0], moved + noise[1]))
    assert found.difference_deg(WIDE)[1] < 3


@pytest.mark.parametrize("seed", range(10))
def test_a_plane_tells_the_pose_of_the_two_that_lies_ahead(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1.5, 1.5, (2, 400))
    points = np.stack([x, y, 1 + 0.3 * x + 0.2 * y], axis=1)
    exact = np.stack([WIDE.left.project(points)[0], WIDE.right.project(WIDE.right_from_left(points))[0]])
    found = estimated(WIDE, rb.Matches(*(exact + rng.normal(0, 0.3, exact.shape))), seed)
    assert found.difference_deg(WIDE)[0] < 0.1


@pytest.mark.parametrize("seed", range(3))
def test_wrong_matches_may_come_first(seed: int) -> None:
    left, right = noisy_matches(WIDE, outliers=0.3, seed=seed)
    assert estimated(WIDE, rb.Matches(left[::-1], right[::-1])).difference_deg(WIDE)[0] < 0.2


@pytest.mark.parametrize("stuck", ["left", "right", "both"])
def test_matches_of_a_single_pixel_are_refused(stuck: str) -> None:
    anywhere, one = np.random.default_rng(0).uniform(0, 500, (50, 2)), np.full((50, 2), 250.0)
    pixels = (anywhere if stuck == "right" else one), (anywhere if stuck == "left" else one)
    with pytest.raises(rb.PoseNotFound, match="no pose stands out"):
        estimated(WIDE, rb.Matches(*pixels))


def test_matches_of_unequal_lengths_are_told() -> None:
    left, right = noisy_matches(WIDE)
    with pytest.raises(rb.InvalidInput, match=r"\(100, 2\) and \(99, 2\)"):
        estimated(WIDE, rb.Matches(left[:100], right[:99]))


def test_matches_that_no_lens_sees_are_not_counted() -> None:
    outside = np.full((20, 2), -4000.0)
    with pytest.raises(rb.PoseNotFound, match="of 20"):
        estimated(WIDE, rb.Matches(outside, outside))


def test_a_contradiction_with_the_calibration_is_told() -> None:
    left, right = noisy_matches(WIDE)
    assert estimated(WIDE, rb.Matches(left, right)).contradiction(WIDE) == ""
    assert "swapped" in relative_pose(WIDE.left, WIDE.right, rb.Matches(right, left)).contradiction(WIDE)
    across = rig(centre_m=(0.0, 0.12, 0.0))
    assert "direction" in estimated(across, noisy_matches(across)).contradiction(rig())
