"""NVIDIA's f-theta lens against its own formula, with numbers as a wide camera of a car has them."""

import math

import numpy as np
import pytest

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from tests.cameras.random_cameras import ray

SIZE = (1920, 1080)
POLY = (1.06e-3, 3.1e-8, 2.4e-10, -1.1e-13, 5e-17)
C, D, E = 1.0004, 3e-4, -2e-4
CENTRE = {"cx": 961.2, "cy": 537.9}
CAMERA = Camera("f-theta", SIZE, {**CENTRE, "c": C, "d": D, "e": E, "angle_poly": POLY})


def unprojected(u: float, v: float) -> np.ndarray:
    """The ray of a pixel: sin θ along the place on the sensor, cos θ ahead."""
    x, y = np.linalg.solve([[1.0, E], [D, C]], [u - CENTRE["cx"], v - CENTRE["cy"]])
    rho = math.hypot(x, y)
    theta = sum(a * rho**power for power, a in enumerate(POLY, 1))
    return np.array([math.sin(theta) * x / rho, math.sin(theta) * y / rho, math.cos(theta)])


def test_a_pixel_s_ray_is_the_polynomial_s() -> None:
    pixels = np.random.default_rng(5).uniform([0, 0], SIZE, (200, 2))
    rays, seen = CAMERA.unproject(pixels)
    assert seen.all()
    np.testing.assert_allclose(rays, [unprojected(u, v) for u, v in pixels], atol=1e-14)
    np.testing.assert_allclose(CAMERA.project(rays)[0], pixels, atol=1e-9)


def test_a_line_is_the_equidistant_lens() -> None:
    rays = ray(np.linspace(0.01, 3.1, 40)[:, None], np.linspace(0, 6, 7)).reshape(-1, 3)
    straight = Camera("f-theta", SIZE, {**CENTRE, "angle_poly": [1 / 400]})
    equidistant = Camera("equidistant", SIZE, {**CENTRE, "fx": 400, "fy": 400})
    np.testing.assert_allclose(straight.project(rays)[0], equidistant.project(rays)[0], atol=1e-9)


def test_a_smaller_image_shows_the_same_rays() -> None:
    small = CAMERA.scaled(0.5)
    pixels = np.random.default_rng(6).uniform([0, 0], SIZE, (50, 2))
    np.testing.assert_allclose(
        small.unproject((pixels + 0.5) / 2 - 0.5)[0], CAMERA.unproject(pixels)[0], atol=1e-12
    )


@pytest.mark.parametrize(
    ("poly", "reason"),
    [([], "no angle_poly"), ([0.0, 1e-3], "a1 = 0"), ([-1e-3], "a1 = -0.001")],
)
def test_a_lens_that_does_not_open_at_its_centre_is_refused(poly: list[float], reason: str) -> None:
    with pytest.raises(InvalidInput, match=f"f-theta has {reason}; expected its coefficients a1 > 0"):
        Camera("f-theta", SIZE, {**CENTRE, "angle_poly": poly})
