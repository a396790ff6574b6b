"""The left image stays, and the right one's rows come as near as they can."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies.dsr import level
from scipy.optimize import minimize

import rectbench as rb
from tests.methods.homographies.pinholes import homographies, pinholes, rectified
from tests.rigs_for_tests import points_before


def test_the_left_image_is_untouched() -> None:
    H_left, _ = homographies(rectified(pinholes((0.5, 0.5, 1.0)), "dsr"))
    np.testing.assert_allclose(H_left, np.eye(3), atol=1e-9)


def test_rows_correspond_where_the_left_epipole_is_at_infinity() -> None:
    pair = pinholes((2.0, 4.0, 3.0), (0.2, 0.0, 0.0))
    _, left, right = points_before(pair, 300)
    assert rb.metrics.row_error(rectified(pair, "dsr"), left, right).columns()["row_error_max_px"] < 1e-9


def test_no_homography_of_the_right_image_brings_its_rows_nearer() -> None:
    _, left, right = points_before(pinholes((0.5, 0.5, 1.0)), 200)
    left, right = (left - 320) / 320, (right - 320) / 320
    points = np.column_stack([right, np.ones(len(right))])

    def apart(p: np.ndarray) -> float:
        return float(((points @ p[:3] / (1 + points[:, :2] @ p[3:]) - left[:, 1]) ** 2).sum())

    H = level(left[:, 1], right, unit=1.0)
    ours = np.array([*H[1], *H[2, :2]])
    found = minimize(apart, [0, 1, 0, 0, 0], method="BFGS", options={"gtol": 1e-10})
    assert apart(ours) <= found.fun * (1 + 1e-6)
    assert apart(ours) == pytest.approx(found.fun, rel=1e-3)


def test_no_match_has_a_disparity_below_zero() -> None:
    pair = pinholes((0.5, 0.5, 1.0))
    _, left, right = points_before(pair, 200)
    rect = rb.rectify(pair, method="dsr", matches=(left, right))
    disparities = rect.left.forward(left)[:, 0] - rect.right.forward(right)[:, 0]
    assert disparities.min() == pytest.approx(0, abs=1e-9)
