"""Profiles of profiles are what their formulas say, invert, differentiate and survive being written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rectbench as rb
from rectbench.formulas.evaluation import namespaced
from rectbench.formulas.namespaces import NUMPY
from tests.rigs_for_tests import rig

CUBIC = rb.Cubic(7.0, 300.0, 20.0, -30.0, -1.1, 1.3)
THETA = np.linspace(-0.9, 1.0, 201)


def angles_of(profile: rb.Profile, values: np.ndarray) -> np.ndarray:
    return np.asarray(profile.angle(namespaced(profile.constants), values, NUMPY))


def test_a_composed_profile_is_the_outer_of_the_inner_and_inverts() -> None:
    composed = rb.Composed(CUBIC, rb.Radial("stereographic", 1.0, 0.0), -0.9, 1.0)
    f = 2 * np.tan(THETA / 2)
    np.testing.assert_allclose(composed(THETA), 7 + 300 * f + 20 * f**2 - 30 * f**3, rtol=1e-14)
    np.testing.assert_allclose(angles_of(composed, composed(THETA)), THETA, atol=1e-13)
    framed = composed.framed(5.0, 2.0)
    np.testing.assert_allclose(framed(THETA), (composed(THETA) - 5) * 2 - 0.5, rtol=1e-13)


def test_a_polynomial_inverse_is_the_least_squares_one_that_keeps_the_ends() -> None:
    fitted = rb.PolynomialInverse.of(CUBIC, 5)
    assert (fitted.low, fitted.high) == pytest.approx((CUBIC.low, CUBIC.high), abs=1e-12)
    theta = np.linspace(CUBIC.low, CUBIC.high, 1001)
    missed = theta - angles_of(fitted, CUBIC(theta))
    x = 2 * (CUBIC(theta) - CUBIC(theta[0])) / (CUBIC(theta[-1]) - CUBIC(theta[0])) - 1
    basis = (1 - x * x)[:, None] * np.vander(x, 4)
    np.testing.assert_allclose(basis.T @ missed, 0, atol=1e-8)  # orthogonal: nothing of that degree is better


def test_what_a_polynomial_inverse_maps_it_maps_back_to_machine_precision() -> None:
    fitted = rb.PolynomialInverse.of(CUBIC, 7).framed(3.0, 1.5)
    pixels = np.linspace(fitted.value_low, fitted.value_high, 301)
    np.testing.assert_allclose(fitted(angles_of(fitted, pixels)), pixels, atol=1e-9)
    beyond = [fitted.value_low - 1, fitted.value_high + 1]
    assert np.isnan(angles_of(fitted, np.array(beyond))).all()


def test_its_error_is_the_distance_from_what_it_stands_for_and_falls_with_the_degree() -> None:
    fits = [rb.PolynomialInverse.of(CUBIC, degree) for degree in (3, 5, 7, 9)]
    errors = [fitted.error_px(CUBIC) for fitted in fits]
    theta = np.linspace(CUBIC.low, CUBIC.high, 20001)
    assert errors[0] == pytest.approx(np.abs(fits[0](theta) - CUBIC(theta)).max(), rel=1e-3)
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.1 < 1 < errors[0]


@pytest.mark.parametrize("q", [(0.0, 1.0, 0.0, -0.5), (0.0, 0.1, 0.0, -1.0, 0.0, 1.0), (1.0,)])
def test_a_polynomial_that_does_not_rise_is_refused(q: tuple[float, ...]) -> None:
    with pytest.raises(rb.InvalidInput):
        rb.PolynomialInverse(q, -100.0, 100.0)


@pytest.mark.parametrize("options", [{"model": "stereographic"}, {"inverse": "polynomial"}])
def test_their_jacobian_is_the_derivative_and_the_inverse_the_inverse(options: dict[str, str]) -> None:
    rect = rb.rectify(rig("equidistant"), **options)
    pixels = rb.evaluation_pixels(rect.rig.left, 80)
    np.testing.assert_allclose(rect.left.inverse(rect.left.forward(pixels)), pixels, atol=1e-6)
    step = np.array([1e-3, 0.0])
    slope = (rect.left.forward(pixels + step) - rect.left.forward(pixels - step)) / 2e-3
    np.testing.assert_allclose(rect.left.jacobian(pixels)[..., 0], slope, atol=1e-6)


@pytest.mark.parametrize("options", [{"model": "equisolid"}, {"inverse": "polynomial"}])
def test_they_are_read_as_they_were_written(tmp_path: Path, options: dict[str, str]) -> None:
    rect = rb.rectify(rig("equidistant"), **options)
    rb.save_rectification(rect, tmp_path / "rectified.yaml")
    again = rb.load_rectification(tmp_path / "rectified.yaml")
    for ours, theirs in zip(rect.maps("left"), again.maps("left"), strict=True):
        np.testing.assert_array_equal(ours, theirs)
