"""The three axes of the compact algorithm."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from tests.methods.homographies.pinholes import (
    camera_matrix,
    homographies,
    pinholes,
    random_pinholes,
    rectified,
)


@pytest.mark.parametrize("seed", range(4))
def test_rows_lie_along_the_baseline_and_across_the_left_axis(seed: int) -> None:
    pair = random_pinholes(seed)
    rect = rectified(pair, "fusiello-trucco-verri")
    K = camera_matrix(pair)
    H_left, _ = homographies(rect)
    R = np.linalg.inv(K) @ H_left @ K
    R /= np.cbrt(np.linalg.det(R))
    # H is K R K⁻¹ but for the shift, which is K's principal point: the first two columns tell all but that.
    x, z = R[0] - R[2] * (R[0] @ R[2]), R[2]
    assert np.cross(x / np.linalg.norm(x), pair.centre_right_in_left / pair.baseline_m) == pytest.approx(
        np.zeros(3), abs=1e-9
    )
    assert np.cross(z, x) @ [0, 0, 1] == pytest.approx(0, abs=1e-9)


def test_the_cameras_are_parallel_afterwards_and_keep_their_focal_length() -> None:
    form = rb.opencv_form(rectified(pinholes(), "fusiello-trucco-verri"))
    assert form.P1[0, 0] == pytest.approx(520)
    np.testing.assert_allclose(form.R2 @ pinholes().R_right_left @ form.R1.T, np.eye(3), atol=1e-9)


def test_a_left_camera_across_the_baseline_is_not_turned() -> None:
    pair = pinholes((2.0, 4.0, 3.0), (0.2, 0.0, 0.0))
    H_left, _ = homographies(rectified(pair, "fusiello-trucco-verri"))
    np.testing.assert_allclose(H_left[:, :2], np.eye(3)[:, :2], atol=1e-9)
