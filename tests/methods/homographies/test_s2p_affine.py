"""The affine rectification of affine pairs is exact, and says what it leaves of others."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies.s2p_affine import similarities
from scipy.optimize import minimize

import rectbench as rb
from tests.methods.homographies.pinholes import pinholes, rectified


def affine_matches(seed: int, noise_px: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Points seen by two affine cameras at different scales and turns."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-300, 300, (80, 3))
    turns = (np.linalg.qr(rng.normal(size=(3, 3)))[0][:2] * np.sign(rng.normal()) for _ in range(2))
    left, right = (points @ (turn * scale).T + 300 for turn, scale in zip(turns, (1.0, 1.3), strict=True))
    return left + rng.normal(0, noise_px, left.shape), right + rng.normal(0, noise_px, right.shape)


def rows(S: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    return pixels @ S[1, :2] + S[1, 2]


@pytest.mark.parametrize("seed", range(5))
def test_rows_of_affine_cameras_correspond_exactly(seed: int) -> None:
    left, right = affine_matches(seed)
    S_left, S_right = similarities(left, right)
    np.testing.assert_allclose(rows(S_left, left), rows(S_right, right), atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_both_are_turns_with_reciprocal_scales(seed: int) -> None:
    scales = []
    for S in similarities(*affine_matches(seed)):
        scale = np.sqrt(np.linalg.det(S[:2, :2]))
        np.testing.assert_allclose(S[:2, :2] @ S[:2, :2].T, scale**2 * np.eye(2), atol=1e-12)
        scales.append(scale)
    assert np.prod(scales) == pytest.approx(1)


def test_of_noisy_matches_the_plane_is_the_nearest() -> None:
    left, right = affine_matches(1, noise_px=1.0)
    points = np.column_stack([right, left])

    def distance(p: np.ndarray) -> float:
        return float((((points @ p[:4] + p[4]) / np.linalg.norm(p[:4])) ** 2).sum())

    S_left, S_right = similarities(left, right)
    ours = np.array([*-S_right[1, :2], *S_left[1, :2], S_left[1, 2] - S_right[1, 2]])
    found = minimize(distance, ours + 1e-3, method="BFGS")
    assert distance(ours) <= found.fun * (1 + 1e-9)


def test_the_narrower_the_view_the_less_is_left() -> None:
    left_px = [
        rectified(pinholes((0.05, 0.1, 3.0), (0.2, 0.01, 0.0), focal), "s2p-affine").notes["rows_rms_px"]
        for focal in (1000.0, 4000.0, 16000.0)
    ]
    assert left_px[0] > 3 * left_px[1] > 9 * left_px[2]
    assert left_px[2] < 0.01


def test_a_wide_view_is_refused_with_what_would_be_left() -> None:
    with pytest.raises(rb.Unsupported, match=r"affine maps leave \d+\.\d px between rows of 480"):
        rectified(pinholes((8.0, 12.0, 3.0), focal=350.0), "s2p-affine")
