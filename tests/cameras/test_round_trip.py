"""What goes out comes back: rays to pixels to rays, and pixels to rays to pixels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from tests.cameras.random_cameras import (
    MODELS,
    angle_between,
    any_camera,
    cameras,
    domain_rays,
    edge_angle,
    ray,
)


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=25)
@given(data=st.data())
def test_unproject_undoes_project_to_1e9_rad_all_over_the_domain(model, data):
    camera = data.draw(cameras(model))
    rays = domain_rays(camera)
    pixels, seen = camera.project(rays)
    # A ray that rounding has put beyond the edge or straight back may be missing, a few of 1500.
    assert seen.mean() > 0.9
    back, known = camera.unproject(pixels[seen])
    assert known.all()
    assert angle_between(back, rays[seen]).max() < 1e-9


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=20)
@given(data=st.data())
def test_project_undoes_unproject_to_1e8_px_wherever_a_pixel_has_a_ray(model, data):
    camera = data.draw(cameras(model))
    pixels = np.random.default_rng(3).uniform(-500, 1800, (800, 2))
    rays, known = camera.unproject(pixels)
    back, seen = camera.project(rays[known])
    assert known.any()
    assert seen.all()
    assert np.abs(back - pixels[known]).max() < 1e-8


@pytest.mark.parametrize("alpha", [0.0, 0.3, 0.5, 0.8, 1.0])
def test_a_double_sphere_shifted_by_next_to_one_keeps_its_digits(alpha):
    focal = {"fx": 300, "fy": 300, "cx": 600, "cy": 400}
    camera = Camera("double-sphere", (1280, 960), {**focal, "xi": 1 - 1e-9, "alpha": alpha})
    rays = domain_rays(camera)
    pixels, seen = camera.project(rays)
    back, known = camera.unproject(pixels[seen])
    assert known.all()
    assert angle_between(back, rays[seen]).max() < 1e-9


@given(any_camera(), st.floats(5, 180))
@settings(max_examples=40)
def test_the_image_circle_cuts_rays_and_pixels_alike(camera, limit_deg):
    camera = Camera(camera.model, camera.size, camera.params, max_angle_deg=limit_deg)
    phi = np.linspace(0, 6, 9)
    edge = edge_angle(camera, phi)
    assert (edge <= np.radians(limit_deg) + 1e-6).all()
    inside, outside = ray(edge * (1 - 1e-12), phi), ray(np.radians(limit_deg) + 1e-5 + 0 * phi, phi)
    pixels, seen = camera.project(inside)
    back, known = camera.unproject(pixels)
    assert seen.all()
    assert known.all()
    assert angle_between(back, inside).max() < 1e-9
    if limit_deg < 179.9:
        assert not camera.project(outside)[1].any()


@given(any_camera())
@settings(max_examples=40)
def test_a_pixel_hangs_on_the_direction_alone(camera):
    rays = domain_rays(camera, per_direction=10, directions=5)
    rays = rays[camera.project(rays * (1 - 1e-12))[1] & camera.project(rays)[1]]
    inner = angle_between(rays, np.array([0.0, 0.0, 1.0])) < 0.999 * edge_angle(camera, np.zeros(1))
    near, far = camera.project(rays[inner] * 1e-3)[0], camera.project(rays[inner] * 1e6)[0]
    size = np.maximum(1.0, np.abs(near))
    assert (np.abs(near - far) < 1e-9 * size).all()


@given(any_camera())
@settings(max_examples=40)
def test_unprojected_rays_have_unit_length(camera):
    rays, known = camera.unproject(np.random.default_rng(1).uniform(-300, 1500, (300, 2)))
    np.testing.assert_allclose(np.linalg.norm(rays[known], axis=-1), 1.0, rtol=0, atol=4e-15)


@pytest.mark.parametrize("k1", [-1, -0.99, -0.9999, -1.0001, -1.01, -0.5])
def test_two_folds_that_meet_leave_the_digits_too(k1):
    # With ξ = 2 the sphere ends at the radius 1/sqrt(3), where k1 = -1 folds as well.
    focal = {"fx": 300, "fy": 300, "cx": 600, "cy": 400}
    camera = Camera("unified", (1280, 960), {**focal, "xi": 2, "k1": k1})
    rays = domain_rays(camera)
    pixels, seen = camera.project(rays)
    back, known = camera.unproject(pixels[seen])
    assert known.all()
    assert angle_between(back, rays[seen]).max() < 1e-9
    assert edge_angle(camera, np.zeros(1))[0] > np.radians(110)
