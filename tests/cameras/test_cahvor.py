"""CAHVOR: mrcal's own pixels, the formula with A, H, V, O and R, and the pinhole within it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from tests.cameras.random_cameras import SIZE, angle_between, cameras, domain_rays

FOCAL = {"fx": 500.0, "fy": 510.0, "cx": 640.0, "cy": 470.0}


def test_the_pixels_of_mrcal_s_regression_test():
    # mrcal, test/test-projections.py (Apache-2.0)
    focal = {"fx": 4842.918, "fy": 4842.771, "cx": 1970.528, "cy": 1085.302}
    params = {**focal, "alpha": -0.001, "beta": 0.002, "r0": -0.637, "r1": -0.002, "r2": 0.016}
    points = [[1.0, 2.0, 10.0], [-1.1, 0.3, 1.0], [-0.9, -1.5, 1.0]]
    expected = [
        [2143.17840406, 1442.93419919],
        [-92.63813066, 1653.09646897],
        [-249.83199315, -2606.46477164],
    ]
    pixels, seen = Camera("cahvor", (3840, 2160), params).project(points)
    assert seen.all()
    np.testing.assert_allclose(pixels, expected, rtol=0, atol=1e-7)


@settings(max_examples=40)
@given(cameras("cahvor"))
def test_it_is_the_formula_with_five_vectors(camera):
    """P' = P + μ λ with λ = P - ω O, μ = r0 + r1 τ + r2 τ², τ = |λ|²/ω²; then H·P'/A·P', V·P'/A·P'."""
    p = camera.params
    points = domain_rays(camera, per_direction=10, directions=6) * 3.0
    pixels, seen = camera.project(points)
    optical = np.array(
        [np.sin(p["alpha"]) * np.cos(p["beta"]), np.sin(p["beta"]), np.cos(p["alpha"]) * np.cos(p["beta"])]
    )
    axis = np.array([0.0, 0.0, 1.0])
    across, down = (
        np.array([p["fx"], 0, 0]) + p["cx"] * axis,
        np.array([0, p["fy"], 0]) + p["cy"] * axis,
    )
    along = points @ optical
    off = points - along[:, None] * optical
    tau = (off * off).sum(axis=-1) / along**2
    bent = points + (p["r0"] + tau * (p["r1"] + tau * p["r2"]))[:, None] * off
    expected = np.stack([bent @ across, bent @ down], axis=-1) / (bent @ axis)[:, None]
    near = seen & (np.abs(pixels) < 1e4).all(axis=-1)
    assert near.sum() > len(points) // 3
    np.testing.assert_allclose(pixels[near], expected[near], rtol=0, atol=1e-7)


def test_without_terms_it_is_the_pinhole_wherever_its_axis_points():
    rays = np.array([[0.3, -0.2, 1.0], [-1.0, 1.0, 0.5], [0, 0, 1.0]])
    expected, _ = Camera("pinhole", SIZE, FOCAL).project(rays)
    pixels, seen = Camera("cahvor", SIZE, {**FOCAL, "alpha": 0.2, "beta": -0.1}).project(rays)
    assert seen.all()
    np.testing.assert_allclose(pixels, expected, rtol=1e-12)


def test_about_the_sensor_s_normal_it_is_the_radial_pinhole():
    rays = np.array([[0.3, -0.2, 1.0], [-0.4, 0.1, 0.5], [0, 0, 1.0]])
    expected, _ = Camera("pinhole", SIZE, {**FOCAL, "k1": 0.1, "k2": 0.02}).project(rays)
    pixels, seen = Camera("cahvor", SIZE, {**FOCAL, "r1": 0.1, "r2": 0.02}).project(rays)
    assert seen.all()
    np.testing.assert_allclose(pixels, expected, rtol=1e-12)


@pytest.mark.parametrize("r0", [-0.9, 0.0, 3.0])
@settings(max_examples=10)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-2, 2), st.floats(-2, 2))
def test_strong_terms_and_tilts_come_back(r0, alpha, beta, r1, r2):
    terms = {"alpha": alpha, "beta": beta, "r0": r0, "r1": r1, "r2": r2}
    camera = Camera("cahvor", SIZE, {**FOCAL, **terms})
    rays = np.random.default_rng(4).normal(size=(2000, 3))
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    pixels, seen = camera.project(rays)
    back, known = camera.unproject(pixels[seen])
    assert known.all()
    assert angle_between(back, rays[seen]).max(initial=0.0) < 1e-9


@pytest.mark.parametrize(("name", "value"), [("alpha", 1.6), ("beta", -1.6), ("r0", -1.0)])
def test_an_axis_behind_and_a_lens_turned_over_are_refused(name, value):
    with pytest.raises(InvalidInput, match=f"cahvor has {name} = "):
        Camera("cahvor", SIZE, {**FOCAL, name: value})
