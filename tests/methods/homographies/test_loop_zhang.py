"""Loop and Zhang's criteria, as they are defined, of what is rectified; and the closed form of the least."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies._homographies import Pencils
from rectbench_methods.homographies.lafiosca_ceccaroni import least_distorted
from rectbench_methods.homographies.loop_zhang import nearest_affine
from scipy.optimize import minimize_scalar

import rectbench as rb
from rectbench.metrics.homography.loop_zhang import projective_criterion
from rectbench.plugins.rectifier import pose_problem
from tests.methods.homographies.pinholes import (
    CENTRE,
    SIZE,
    fundamental,
    homographies,
    pinholes,
    pixel_grid,
    random_pinholes,
    rectified,
)

BOTH = ("loop-zhang", "lafiosca-ceccaroni")
PIXELS = pixel_grid()
EDGES = np.array([[-0.5, 239.5], [639.5, 239.5], [319.5, -0.5], [319.5, 479.5]])
"""The ends of the horizontal and of the vertical midline."""


def distortion(w_left: np.ndarray, w_right: np.ndarray) -> float:
    """The mean of ((w_i - w_c)/w_c)² over the pixels, w_c the mean; of both images (Loop and Zhang)."""
    weights = [PIXELS @ w for w in (w_left, w_right)]
    return float(sum(((w - w.mean()) ** 2).mean() / w.mean() ** 2 for w in weights))


def direction(angle: float) -> np.ndarray:
    """z, a point at infinity of the left image."""
    return np.array([np.cos(angle), np.sin(angle), 0])


def through(H: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    mapped = np.column_stack([pixels, np.ones(len(pixels))]) @ H.T
    return mapped[:, :2] / mapped[:, 2:]


@pytest.mark.parametrize("method", BOTH)
def test_the_criterion_told_is_that_of_the_delivered_homographies(method: str) -> None:
    rect = rectified(pinholes(), method)
    H_left, H_right = homographies(rect)
    assert rect.notes["projective_distortion"] == pytest.approx(distortion(H_left[2], H_right[2]), rel=1e-8)
    printed = projective_criterion(rect.left) + projective_criterion(rect.right)
    assert rect.notes["projective_distortion"] == pytest.approx(printed, rel=1e-2)


@pytest.mark.parametrize("method", BOTH)
def test_no_direction_has_less_projective_distortion(method: str) -> None:
    pair = pinholes()
    F = fundamental(pair)
    epipole = np.linalg.svd(F)[2][-1]
    brute = minimize_scalar(
        lambda angle: distortion(np.cross(epipole, z := direction(angle)), F @ z), bounds=(0, np.pi)
    )
    found = float(rectified(pair, method).notes["projective_distortion"])
    assert found <= brute.fun * (1 + 1e-9)
    assert found == pytest.approx(brute.fun, rel=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_the_quartic_has_the_least_of_all(seed: int) -> None:
    pair = random_pinholes(seed)
    pencils = Pencils.of(fundamental(pair), rb.PinholeView.of(pose_problem(pair)))
    found = pencils.projective_distortion(least_distorted(pencils))
    # Lines w at all angles to the left middle, near it and far from it.
    everywhere = np.tan(np.linspace(-np.pi / 2, np.pi / 2, 20001)[1:-1]) / sum(SIZE)
    assert found <= min(pencils.projective_distortion(t) for t in everywhere)
    assert found <= pencils.projective_distortion(nearest_affine(pencils)) * (1 + 1e-12)


@pytest.mark.parametrize("method", BOTH)
def test_midlines_stay_perpendicular_and_keep_their_ratio(method: str) -> None:
    for H in homographies(rectified(pinholes(), method)):
        ends = through(H, EDGES)
        across, down = ends[1] - ends[0], ends[3] - ends[2]
        assert across @ down == pytest.approx(0, abs=1e-6)
        assert np.linalg.norm(across) / np.linalg.norm(down) == pytest.approx(SIZE[0] / SIZE[1], rel=1e-9)


@pytest.mark.parametrize("method", BOTH)
def test_the_sum_of_areas_is_kept(method: str) -> None:
    pair = homographies(rectified(pinholes(), method))
    # det J of a homography that is 1 in the middle, summed over the pixels.
    assert sum((np.linalg.det(H) / (PIXELS @ H[2]) ** 3).sum() for H in pair) == pytest.approx(
        2 * SIZE[0] * SIZE[1], rel=1e-5
    )


@pytest.mark.parametrize("method", BOTH)
def test_each_middle_is_in_the_middle_column(method: str) -> None:
    for H in homographies(rectified(pinholes(), method)):
        assert through(H, CENTRE[None])[0, 0] == pytest.approx(CENTRE[0])
