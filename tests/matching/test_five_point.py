"""The five-point solver: the truth is among its answers, for rays in any direction."""

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench.matching.pose.five_point import essential_matrices

SAMPLES = 2000


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def samples(kind: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rays [B, 5, 3] twice and the essential matrices [B, 3, 3], norm 1, behind them."""
    rng = np.random.default_rng(seed)
    R = Rotation.from_rotvec(rng.normal(0, 0.1, (SAMPLES, 3))).as_matrix()
    heading = {"sideways": [1, 0, 0], "forward": [0, 0, 1]}.get(kind, [0, 0, 0])
    t = unit(np.array(heading) + rng.normal(0, 0.02 if any(heading) else 1, (SAMPLES, 3)))
    rays = unit(rng.normal(size=(SAMPLES, 5, 3)))
    if kind != "all round":
        rays[..., 2] = np.abs(rays[..., 2]) + 0.3
    points = unit(rays) * rng.uniform(3, 30, (SAMPLES, 5, 1))
    if kind == "planar":
        points = np.concatenate([rng.uniform(-4, 4, (SAMPLES, 5, 2)), np.full((SAMPLES, 5, 1), 5.0)], axis=-1)
    moved = points @ np.swapaxes(R, 1, 2) + t[:, None]
    cross = np.cross(t[:, None], np.eye(3)).swapaxes(1, 2)
    return unit(points), unit(moved), cross @ R / np.sqrt(2)


@pytest.mark.parametrize("kind", ["all round", "ahead", "sideways", "forward", "planar"])
def test_the_truth_is_among_the_solutions(kind: str) -> None:
    left, right, truth = samples(kind)
    found, sample = essential_matrices(left, right)
    errors = np.minimum(*(np.linalg.norm(found - s * truth[sample], axis=(1, 2)) for s in (1, -1)))
    nearest = np.full(SAMPLES, np.inf)
    np.minimum.at(nearest, sample, errors)
    assert (nearest < 1e-6).mean() > 0.995


def test_every_solution_is_an_essential_matrix_through_the_sample() -> None:
    left, right, _ = samples("all round", seed=1)
    found, sample = essential_matrices(left, right)
    residuals = np.einsum("kni,kij,knj->kn", right[sample], found, left[sample])
    assert np.abs(residuals).max() < 1e-9
    values = np.linalg.svd(found, compute_uv=False)
    np.testing.assert_allclose(values, np.array([[1, 1, 0]]) / np.sqrt(2) + 0 * values, atol=1e-6)
    assert (np.diff(sample) >= 0).all()
    assert np.bincount(sample).max() <= 10


def test_it_finds_the_solutions_that_opencv_finds() -> None:
    left, right, _ = samples("ahead", seed=2)
    found, sample = essential_matrices(left[:50], right[:50])
    agreeing = total = 0
    for i in range(50):
        stacked, _ = cv2.findEssentialMat(
            left[i, :, :2] / left[i, :, 2:], right[i, :, :2] / right[i, :, 2:], np.eye(3), method=cv2.LMEDS
        )
        for theirs in stacked.reshape(-1, 3, 3):
            ours = found[sample == i]
            errors = [
                np.linalg.norm(ours - s * theirs / np.linalg.norm(theirs), axis=(1, 2)) for s in (1, -1)
            ]
            agreeing += min(np.min(e, initial=np.inf) for e in errors) < 1e-5
            total += 1
    assert total >= 50
    assert agreeing > 0.95 * total


def test_a_sample_of_one_ray_gives_nothing_that_is_not_finite() -> None:
    ray = np.tile([0.0, 0.0, 1.0], (1, 5, 1))
    found, _ = essential_matrices(ray, ray)
    assert np.isfinite(found).all()


def test_samples_of_one_left_ray_give_nothing_that_is_not_finite() -> None:
    rng = np.random.default_rng(0)
    left = np.broadcast_to(unit(rng.normal(size=(SAMPLES, 1, 3))), (SAMPLES, 5, 3))
    found, _ = essential_matrices(left, unit(rng.normal(size=(SAMPLES, 5, 3))))
    assert np.isfinite(found).all()
