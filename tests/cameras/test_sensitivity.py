"""How pixels depend on a lens's parameters agrees with cameras made anew, for every projection model."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rectbench.cameras import Camera
from rectbench.cameras.lens import LENSES
from rectbench.cameras.sensitivity import parameter_names, projection_by_parameters, with_changes
from rectbench.errors import UnknownName

FOCAL = {"fx": 301.0, "fy": 305.0, "cx": 322.0, "cy": 237.0}
BROWN = {"k1": -0.1, "k2": 0.02, "p1": 2e-3, "p2": -1e-3}
CAMERAS = {
    "pinhole": FOCAL
    | BROWN
    | {"k3": -0.002, "k4": 0.01, "k5": 0.001, "k6": 1e-4}
    | {"s1": 1e-3, "s2": -1e-4, "s3": 2e-3, "s4": 1e-4},
    "kannala-brandt": FOCAL | {"k1": 0.02, "k2": -0.008, "k3": 0.002, "k4": -0.0003, "skew": 2.0},
    "unified": FOCAL | BROWN | {"xi": 0.9, "skew": 2.0},
    "extended-unified": FOCAL | {"alpha": 0.6, "beta": 1.1},
    "double-sphere": FOCAL | {"xi": -0.2, "alpha": 0.58},
    "field-of-view": FOCAL | {"omega": 0.92},
    "ocam": {"cx": 322, "cy": 237, "c": 1.01, "d": 1e-3, "e": -2e-3, "poly": [250, 0, -1e-3, 1e-6, -2e-9]},
    "thin-prism-fisheye": FOCAL | BROWN | {"k3": 0.01, "k4": -0.001, "sx1": 1e-3, "sy1": -2e-3},
    "fisheye624": FOCAL
    | {"k0": 0.02, "k1": -0.008, "k2": 0.002, "k3": -0.0003, "k4": 1e-4, "k5": -1e-5}
    | {"p0": 1e-3, "p1": -1e-3, "s0": 2e-3, "s1": -1e-4, "s2": 1e-3, "s3": 1e-4},
    "cahvor": FOCAL | {"alpha": 0.01, "beta": -0.02, "r0": 0.003, "r1": -0.05, "r2": 0.01},
    "division": FOCAL | {"k": -0.2},
    "f-theta": {"cx": 322, "cy": 237, "c": 1.01, "d": 1e-3, "e": -2e-3, "angle_poly": [4e-3, 1e-7, 2e-9]},
    "tilted-pinhole": FOCAL | BROWN | {"k3": 0.01, "s1": 1e-3, "tau_x": 0.03, "tau_y": -0.02},
    "radial-tangential": FOCAL | BROWN | {"k3": 0.01, "k4": -0.002, "skew": 2.0},
}
ABOUT_90_DEG = Polynomial([np.pi / 2, 1.0])
INVERSE_OCAM = {
    "cx": 322,
    "cy": 237,
    "c": 1.01,
    "inverse_poly": Polynomial([0.1, 250, 0, 10])(ABOUT_90_DEG).coef,
}


def camera(model: str) -> Camera:
    return Camera(model, (640, 480), CAMERAS.get(model, FOCAL))


def rays_within(angle: float) -> np.ndarray:
    """Rays [N, 3] up to this angle from the axis, the axis among them."""
    theta, phi = np.meshgrid(np.linspace(0, angle, 8), np.linspace(0.1, 6.2, 11))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


def differenced(camera: Camera, name: str, rays: np.ndarray) -> np.ndarray:
    """d(pixel)/d(parameter) [..., 2] from cameras with more and less of it, to fourth order."""
    whole, _, place = name.partition(".")
    powers = {"poly": lambda place: 1 - place, "angle_poly": lambda place: -1 - place}
    step = 1e-3 * (300.0 ** powers[whole](int(place)) if whole in powers else 1.0)
    values = {shift: with_changes(camera, {name: shift * step}).project(rays)[0] for shift in (-2, -1, 1, 2)}
    return (8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * step)


@pytest.mark.parametrize("lens", [camera(m) for m in LENSES] + [Camera("ocam", (640, 480), INVERSE_OCAM)])
def test_pixels_move_with_each_parameter_as_cameras_made_anew_say(lens: Camera) -> None:
    rays = rays_within(0.9)
    names = parameter_names(lens)
    slopes = projection_by_parameters(lens, rays, names)
    assert np.isfinite(slopes).all()
    for i, name in enumerate(names):
        numeric = differenced(lens, name, rays)
        np.testing.assert_allclose(
            slopes[..., i], numeric, rtol=1e-6, atol=1e-6 * np.abs(numeric).max(), err_msg=name
        )


@pytest.mark.parametrize("model", ["kannala-brandt", "pinhole", "ocam"])
def test_a_compiled_kernel_gives_the_same_slopes(model: str) -> None:
    rays = np.tile(rays_within(0.9), (300, 1, 1))
    names = parameter_names(camera(model))
    few = projection_by_parameters(camera(model), rays[:11], names)
    many = projection_by_parameters(camera(model), rays, names)[:11]
    np.testing.assert_allclose(many, few, rtol=1e-9, atol=1e-9 * np.abs(few).max())


def test_focal_length_and_centre_count_as_the_formula_says() -> None:
    ray = [np.sin(0.7) * 0.6, np.sin(0.7) * 0.8, np.cos(0.7)]
    slopes = projection_by_parameters(camera("equidistant"), ray, ("fx", "fy", "cx", "cy"))
    np.testing.assert_allclose(slopes, [[0.7 * 0.6, 0, 1, 0], [0, 0.7 * 0.8, 0, 1]], atol=1e-12)


def test_a_ray_that_the_lens_does_not_see_has_no_slopes() -> None:
    assert np.isnan(projection_by_parameters(camera("pinhole"), [0.1, 0.0, -1.0], ("fx",))).all()


def test_a_parameter_of_another_model_is_refused() -> None:
    with pytest.raises(UnknownName, match="unknown parameter of ocam 'k1'"):
        with_changes(camera("ocam"), {"k1": 0.1})
