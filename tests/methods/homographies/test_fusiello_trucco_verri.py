"""The three axes of the compact algorithm."""

from __future__ import annotations

import numpy as np
import pytest

import rectbench as rb
from tests.methods.homographies.pinholes import homographies, pinholes, random_pinholes, rectified


@pytest.mark.parametrize("seed", range(4))
def test_rows_lie_along_the_baseline_and_across_the_left_axis(seed: int) -> None:
    pair = random_pinholes(seed)
    rect = rectified(pair, "fusiello-trucco-verri")
    x, y, _ = rect.R_rect_left
    np.testing.assert_allclose(x, pair.centre_right_in_left / pair.baseline_m, atol=1e-12)
    assert y @ [0, 0, 1] == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(rect.R_rect_right, rect.R_rect_left @ pair.R_right_left.T, atol=1e-12)


def test_the_images_have_the_focal_length_of_the_view_and_common_rows() -> None:
    form = rb.opencv_form(rectified(pinholes(), "fusiello-trucco-verri"))
    assert form.P1[0, 0] == pytest.approx(520)
    np.testing.assert_allclose(form.P1[1], form.P2[1], atol=1e-9)


def test_a_left_camera_across_the_baseline_is_not_turned() -> None:
    H_left, _ = homographies(rectified(pinholes((2.0, 4.0, 3.0), (0.2, 0.0, 0.0)), "fusiello-trucco-verri"))
    np.testing.assert_allclose(H_left[:, :2], np.eye(3)[:, :2], atol=1e-9)
