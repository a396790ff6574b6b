"""Measures of distortion, on maps whose distortion is known, and their bounds."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies.usr_cgd import BOUND, IDEAL, distortions

import rectbench as rb
from rectbench.metrics.homography.outline import Outline
from rectbench.metrics.homography.usr_cgd import aspect_ratio, rotation_deg, size_ratio, skewness_deg
from tests.methods.homographies.pinholes import SIZE, homographies, pinholes, rectified
from tests.rigs_for_tests import points_before


def turned(angle_deg: float) -> np.ndarray:
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[c, -s, 7], [s, c, -3], [0, 0, 1]])


def test_an_image_as_it_is_has_the_ideal_measures() -> None:
    np.testing.assert_allclose(distortions(np.eye(3), SIZE), IDEAL, atol=1e-9)


@pytest.mark.parametrize("angle_deg", [10.0, -25.0])
def test_a_turn_is_rotation_and_nothing_else(angle_deg: float) -> None:
    np.testing.assert_allclose(distortions(turned(angle_deg), SIZE), [1, 0, angle_deg, 1], atol=1e-9)


def test_a_zoom_is_size_and_nothing_else() -> None:
    np.testing.assert_allclose(distortions(np.diag([1.1, 1.1, 1]), SIZE), [1, 0, 0, 1.21], atol=1e-9)


def test_a_shear_turns_all_four_corners_by_its_angle() -> None:
    shear = np.array([[1, np.tan(np.radians(4)), 0], [0, 1, 0], [0, 0, 1]])
    np.testing.assert_allclose(distortions(shear, SIZE), [1, 4, 0, 1], atol=1e-9)


def test_the_measures_are_those_that_reports_print() -> None:
    rect = rectified(pinholes(), "usr-cgd")
    source = Outline.of(SIZE)
    for warp, H in zip((rect.left, rect.right), homographies(rect), strict=True):
        outline = Outline.rectified(warp)
        printed = [aspect_ratio(outline), skewness_deg(outline), rotation_deg(source, outline)]
        aspect, skewness, turn, size = distortions(H, SIZE)
        np.testing.assert_allclose([aspect, skewness, abs(turn)], printed, atol=1e-9)
        assert size == pytest.approx(size_ratio(source, outline))


def beyond(rect: rb.Rectification) -> bool:
    """Whether a measure of either image lies beyond its bound."""
    return any((np.abs(distortions(H, SIZE) - IDEAL) > BOUND * (1 + 1e-9)).any() for H in homographies(rect))


def test_a_bound_that_exact_rows_would_break_is_kept_at_a_small_cost_of_rows() -> None:
    pair = pinholes((8.0, 0.0, 0.0))
    assert beyond(rectified(pair, "fusiello"))  # of least Sampson error alone
    rect = rectified(pair, "usr-cgd")
    assert not beyond(rect)
    assert "warning" not in rect.notes
    _, left, right = points_before(pair, 300)
    assert rb.metrics.row_error(rect, left, right).columns()["row_error_max_px"] < 1


def test_a_bound_that_rows_cannot_afford_is_told() -> None:
    rect = rectified(pinholes((1.0, 20.0, 2.0)), "usr-cgd")
    assert beyond(rect)
    assert rect.notes["warning"] == "a distortion stays beyond its bound, so that rows correspond"
    assert float(rect.notes["sampson_rms_px"]) <= 0.1
