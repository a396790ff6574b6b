"""The division model against Fitzgibbon's formula and the lenses it contains."""

import numpy as np
import pytest
from hypothesis import given, settings

from rectbench.cameras import Camera
from tests.cameras.random_cameras import SIZE, cameras, domain_rays, ray

FOCAL = {"fx": 320.0, "fy": 330.0, "cx": 640.0, "cy": 470.0}


@settings(max_examples=40)
@given(cameras("division"))
def test_a_pixel_s_ray_is_fitzgibbon_s(camera):
    """x_ideal = x / (1 + k r²): the ray (x, y, 1 + k r²)."""
    rays = domain_rays(camera, per_direction=15, directions=6)
    pixels, seen = camera.project(rays)
    p = camera.params
    x, y = (pixels[:, 0] - p["cx"]) / p["fx"], (pixels[:, 1] - p["cy"]) / p["fy"]
    near = seen & (np.hypot(x, y) < 1e3)
    assert near.sum() > len(rays) // 3
    x, y = x[near], y[near]
    expected = np.stack([x, y, 1 + p["k"] * (x * x + y * y)], axis=-1)
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    np.testing.assert_allclose(rays[near], expected, rtol=0, atol=1e-11)


@pytest.mark.parametrize(("k", "other"), [(-0.25, "stereographic"), (0.0, "pinhole")])
def test_it_contains_the_classical_lenses(k, other):
    theta = np.radians([0.0, 1e-6, 20, 70, 89] + ([90, 110, 179] if k else []))
    rays = ray(theta, np.full_like(theta, 0.7))
    pixels, seen = Camera("division", SIZE, {**FOCAL, "k": k}).project(rays)
    assert seen.all()
    np.testing.assert_allclose(pixels, Camera(other, SIZE, FOCAL).project(rays)[0], rtol=1e-12)


def test_next_to_the_pinhole_it_ends_with_the_pinhole():
    camera = Camera("division", SIZE, {**FOCAL, "k": -1e-12})
    assert camera.project([1.0, 0.0, 1e-6])[1]
    assert not camera.project([1.0, 0.0, -1e-6])[1]
