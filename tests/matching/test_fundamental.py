"""The fundamental matrix: exact on exact matches, near OpenCV's on noisy ones, never worse."""

import cv2
import numpy as np
import pytest

import rectbench as rb


def pinhole_matches(noise_px: float = 0.0, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(F, left [N, 2], right [N, 2]) of points before two pinhole cameras."""
    rng = np.random.default_rng(seed)
    K = np.array([[500.0, 0, 320], [0, 510, 240], [0, 0, 1]])
    R = cv2.Rodrigues(np.array([0.03, -0.05, 0.02]))[0]
    t = np.array([-0.2, 0.01, 0.02])
    X = np.column_stack([rng.uniform(-2, 2, (300, 2)), rng.uniform(3, 12, 300)])
    left, right = (points @ K.T for points in (X, X @ R.T + t))
    cross = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    F = np.linalg.inv(K).T @ cross @ R @ np.linalg.inv(K)
    px = [p[:, :2] / p[:, 2:] + noise_px * rng.standard_normal((300, 2)) for p in (left, right)]
    return F / np.linalg.norm(F), px[0], px[1]


def test_exact_matches_give_the_exact_matrix() -> None:
    F, left, right = pinhole_matches()
    found = rb.fundamental_matrix(left, right)
    np.testing.assert_allclose(found * np.sign((found * F).sum()), F, atol=1e-11)
    assert abs(np.linalg.det(found)) < 1e-15


@pytest.mark.parametrize("seed", range(3))
def test_on_noisy_matches_the_sampson_error_is_at_most_that_of_opencv(seed: int) -> None:
    _, left, right = pinhole_matches(0.5, seed)
    theirs, _ = cv2.findFundamentalMat(left, right, cv2.FM_8POINT)
    x, y = (np.column_stack([p, np.ones(len(p))]) for p in (left, right))
    ours = np.square(rb.sampson_residuals(rb.fundamental_matrix(left, right), x, y)).mean()
    assert ours <= np.square(rb.sampson_residuals(theirs, x, y)).mean()


def test_too_few_matches_are_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="N >= 8"):
        rb.fundamental_matrix(np.zeros((7, 2)), np.zeros((7, 2)))


def test_matches_that_are_all_one_pixel_are_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="same pixel or in one line"):
        rb.fundamental_matrix(np.ones((9, 2)), np.ones((9, 2)))
