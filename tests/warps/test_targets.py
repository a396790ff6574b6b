"""Rectified image models: profiles rise, invert exactly and refuse what they cannot map."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rectbench as rb
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from rectbench.warps.profiles import RADIAL_LIMIT_RAD, least_slope

coefficients = st.tuples(st.floats(100, 900), st.floats(-300, 300), st.floats(-200, 200))


@given(coefficients, st.floats(-1.6, -0.2), st.floats(0.2, 1.6))
def test_a_rising_cubic_is_inverted_to_machine_precision(
    c: tuple[float, ...], low: float, high: float
) -> None:
    assume(least_slope(np.array(c), low, high) > 1.0)
    cubic = rb.Cubic(12.5, *c, low, high)
    theta = np.linspace(low, high, 101)
    back = cubic.angle(namespaced(cubic.constants), cubic(theta), NUMPY)
    np.testing.assert_allclose(back, theta, atol=1e-11)


@given(coefficients, st.floats(-1.6, -0.2), st.floats(0.2, 1.6))
def test_least_slope_is_the_minimum_over_the_range(c: tuple[float, ...], low: float, high: float) -> None:
    theta = np.linspace(low, high, 20001)
    brute = (c[0] + 2 * c[1] * theta + 3 * c[2] * theta**2).min()
    assert least_slope(np.array(c), low, high) == pytest.approx(brute, abs=1e-4)


def test_a_falling_cubic_is_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="falls within"):
        rb.Cubic(0, 100, 0, -200, -1, 1)


@pytest.mark.parametrize("law", sorted(RADIAL_LIMIT_RAD))
def test_radial_laws_have_unit_slope_on_the_axis_and_invert(law: str) -> None:
    profile = rb.Radial(law, 300.0, 20.0)
    theta = np.linspace(-1.5, 1.5, 301)
    values = profile(theta)
    assert (np.diff(values) > 0).all()
    np.testing.assert_allclose((profile(1e-6) - profile(-1e-6)) / 2e-6, 300, rtol=1e-9)
    np.testing.assert_allclose(profile.angle(namespaced(profile.constants), values, NUMPY), theta, atol=1e-12)


def test_rays_out_of_a_profiles_range_are_invalid() -> None:
    target = rb.Epipolar(rb.Cubic(0, 100, 0, 0, -0.5, 0.5), rb.Radial("equidistant", 100, 0))
    rays = np.array([[math.sin(0.4), 0, math.cos(0.4)], [math.sin(0.6), 0, math.cos(0.6)]])
    pixels, ok = target.project(rays)
    assert ok.tolist() == [True, False]
    assert np.isnan(pixels[1]).all()
    assert target.unproject([[49.9, 0], [50.1, 0]])[1].tolist() == [True, False]


def test_perspective_masks_what_lies_behind_it() -> None:
    target = rb.Perspective.from_focal(100, 50, 50)
    pixels, ok = target.project([[0, 0, 1.0], [0, 0, -1.0], [1, 0, 0]])
    assert ok.tolist() == [True, False, False]
    assert np.isnan(pixels[1:]).all()


@pytest.mark.parametrize("matrix", [np.zeros((3, 3)), np.full((3, 3), np.nan), np.eye(2)])
def test_a_matrix_that_maps_nothing_is_refused(matrix: np.ndarray) -> None:
    with pytest.raises(rb.InvalidInput, match="invertible 3x3"):
        rb.Perspective(matrix)
