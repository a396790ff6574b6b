"""A monotone spline rises whatever its slopes are, and is inverted to the last digits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import BSpline

import rectbench as rb
from rectbench.formulas.evaluation import KERNEL_THRESHOLD, evaluate, namespaced
from rectbench.formulas.jets import JetNamespace, as_jets, variables
from rectbench.formulas.namespaces import NUMPY


@st.composite
def splines(draw: st.DrawFn) -> rb.MonotoneSpline:
    steps = draw(st.lists(st.floats(0.01, 1.0), min_size=1, max_size=12))
    logs = draw(st.lists(st.floats(-4.0, 4.0), min_size=len(steps) + 2, max_size=len(steps) + 2))
    knots = np.cumsum([-1.3, *steps])
    return rb.MonotoneSpline(tuple(knots), tuple(300 * np.exp(logs)), draw(st.floats(-500, 500)))


@given(splines())
def test_it_rises_between_the_knots_too_and_is_inverted(spline: rb.MonotoneSpline) -> None:
    theta = np.linspace(spline.low, spline.high, 2001)
    values = spline(theta)
    slopes = np.diff(values) / np.diff(theta)
    assert slopes.min() >= min(spline.slopes) * (1 - 1e-6)
    assert slopes.max() <= max(spline.slopes) * (1 + 1e-6)
    back = spline.angle(namespaced(spline.constants), values, NUMPY)
    # As near as the values' own digits tell where the slope is least.
    np.testing.assert_allclose(back, theta, atol=1e-15 + 1e-12 / min(spline.slopes) * np.abs(values).max())


@given(splines())
def test_its_slope_is_the_b_spline_of_its_slopes(spline: rb.MonotoneSpline) -> None:
    theta = np.linspace(spline.low, spline.high, 97)
    basis = rb.MonotoneSpline.slope_basis(spline.knots, theta)
    assert (basis >= 0).all()
    np.testing.assert_allclose(basis.sum(axis=1), 1, rtol=1e-12)
    clamped = [*[spline.low] * 2, *spline.knots, *[spline.high] * 2]
    np.testing.assert_allclose(basis @ spline.slopes, BSpline(clamped, spline.slopes, 2)(theta), rtol=1e-9)
    jet = spline.value(as_jets(namespaced(spline.constants)), *variables(theta), JetNamespace(NUMPY))
    np.testing.assert_allclose(jet.partials[0], basis @ spline.slopes, rtol=1e-9)


def test_its_value_is_the_integral_of_its_slope() -> None:
    spline = rb.MonotoneSpline((-1.0, -0.2, 0.5, 0.6), (300.0, 20.0, 500.0, 400.0, 350.0), 12.0)
    for angle in (-0.9, -0.2, 0.1, 0.55, 0.6):
        rise, _ = quad(
            lambda t: float((spline.slope_basis(spline.knots, [t]) @ spline.slopes)[0]),
            -1.0,
            angle,
            epsrel=1e-10,
        )
        assert spline(angle) == pytest.approx(12.0 + rise, abs=1e-5)


def test_many_points_get_the_same_from_a_kernel() -> None:
    spline = rb.MonotoneSpline(tuple(np.linspace(-1, 1, 40)), tuple(np.geomspace(50, 700, 41)), 0.0)
    theta = np.linspace(-1, 1, KERNEL_THRESHOLD)

    def there_and_back(c: object, angle: object, xp: rb.Formulas) -> tuple[object, ...]:
        value = spline.value(c, angle, xp)
        return value, spline.angle(c, value, xp)

    value, back = evaluate(there_and_back, spline.constants, theta)
    np.testing.assert_allclose(value, spline(theta), rtol=1e-13, atol=1e-12)
    np.testing.assert_allclose(back, theta, atol=1e-13)


def test_pixels_beyond_its_range_have_no_angle() -> None:
    spline = rb.MonotoneSpline((-1.0, 1.0), (100.0, 100.0, 100.0), 0.0)
    beyond = spline.angle(namespaced(spline.constants), np.array([-0.1, 0.0, 200.0, 200.1]), NUMPY)
    np.testing.assert_array_equal(np.isnan(beyond), [True, False, False, True])


def test_framing_moves_and_scales_its_pixels() -> None:
    spline = rb.MonotoneSpline((-1.0, 0.3, 1.0), (100.0, 50.0, 70.0, 90.0), 8.0)
    theta = np.linspace(-1, 1, 11)
    framed = spline.framed(20.0, 0.5)
    assert isinstance(framed, rb.MonotoneSpline)
    np.testing.assert_allclose(framed(theta), (spline(theta) - 20.0) * 0.5 - 0.5, rtol=1e-13)


@pytest.mark.parametrize(
    ("knots", "slopes", "message"),
    [
        ((0.0,), (1.0, 1.0), "two or more that rise"),
        ((0.0, 0.0), (1.0, 1.0, 1.0), "two or more that rise"),
        ((0.0, np.inf), (1.0, 1.0, 1.0), "two or more that rise"),
        ((0.0, 1.0), (1.0, 1.0), "2 slopes over 2 knots; expected one more"),
        ((0.0, 1.0), (1.0, 0.0, 1.0), "slope of 0"),
        ((0.0, 1.0), (1.0, np.nan, 1.0), "slope of nan"),
    ],
)
def test_what_does_not_rise_is_refused(
    knots: tuple[float, ...], slopes: tuple[float, ...], message: str
) -> None:
    with pytest.raises(rb.InvalidInput, match=message):
        rb.MonotoneSpline(knots, slopes, 0.0)
