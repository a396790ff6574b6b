"""Derivatives agree with finite differences, on the axis too."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from tests.cameras.random_cameras import MODELS, SIZE, cameras, domain_rays, edge_angle, ray

STEP = 1e-5


def inner_rays(camera: Camera) -> np.ndarray:
    """Rays [N, 3] off the edge, where a finite difference does not leave the domain."""
    phi = np.linspace(0.1, 6.2, 11)
    share = np.concatenate([[0.0, 1e-12, 1e-7, 1e-3], np.linspace(0.05, 0.93, 12)])
    return ray(share[:, None] * edge_angle(camera, phi), phi).reshape(-1, 3)


def central_differences(function, points: np.ndarray, step: float) -> np.ndarray:
    """d(function)/d(points) [..., m, k], to fourth order in the step."""
    columns = []
    for axis in np.eye(points.shape[-1]) * step:
        near = function(points + axis)[0] - function(points - axis)[0]
        far = function(points + 2 * axis)[0] - function(points - 2 * axis)[0]
        columns.append((8 * near - far) / (12 * step))
    return np.stack(columns, axis=-1)


TURNED = ("cahvor", "tilted-pinhole")
"""Models whose axis, or sensor, does not stand as the others'."""


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=20)
@given(data=st.data())
def test_the_jacobian_of_project_is_that_of_finite_differences(model, data):
    camera = data.draw(cameras(model))
    rays = inner_rays(camera)
    jacobian = camera.project_jacobian(rays)
    numeric = central_differences(camera.project, rays, STEP)
    size = np.linalg.norm(jacobian, axis=(-2, -1), keepdims=True)
    pixel_rounding = 1e-15 * np.abs(camera.project(rays)[0]).max(axis=-1) / STEP
    curved = size[..., 0, 0] > 20 * np.median(size)  # towards infinity the difference itself is poor
    error = np.abs(jacobian - numeric).max(axis=(-2, -1))
    assert (error < 1e-6 * size[..., 0, 0] + 50 * pixel_rounding)[~curved].all()
    assert (~curved).mean() > 0.5


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=20)
@given(data=st.data())
def test_each_row_of_the_jacobian_is_orthogonal_to_the_ray(model, data):
    camera = data.draw(cameras(model))
    rays = domain_rays(camera, per_direction=10, directions=5)
    jacobian = camera.project_jacobian(rays)
    along = np.abs((jacobian @ rays[..., None])[..., 0])
    known = np.isfinite(along)
    size = np.linalg.norm(jacobian, axis=-1)
    assert known.mean() > 0.9
    assert (along <= 1e-7 * size + 1e-9)[known].all()


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=10)
@given(data=st.data())
def test_the_jacobian_of_unproject_is_that_of_finite_differences(model, data):
    camera = data.draw(cameras(model))
    pixels = camera.project(inner_rays(camera))[0]
    pixels = pixels[(np.abs(pixels) < 3000).all(axis=-1)]
    jacobian = camera.unproject_jacobian(pixels)
    numeric = central_differences(camera.unproject, pixels, 1e-2)
    known = np.isfinite(numeric).all(axis=(-2, -1))
    size = np.linalg.norm(jacobian, axis=(-2, -1))
    curved = size > 20 * np.median(size)  # a fold is near
    error = np.abs(jacobian - numeric).max(axis=(-2, -1))
    assert (error < 1e-5 * size)[known & ~curved].all()
    assert (known & ~curved).sum() > 10


@pytest.mark.parametrize("model", [model for model in MODELS if model not in TURNED])
@settings(max_examples=20)
@given(data=st.data())
def test_on_the_axis_the_jacobian_is_the_focal_length_times_one_slope(model, data):
    camera = data.draw(cameras(model))
    principal, _ = camera.project([0.0, 0.0, 1.0])
    rays, known = camera.unproject(principal)
    assert known
    np.testing.assert_allclose(rays, [0, 0, 1], rtol=0, atol=1e-15)
    jacobian = camera.project_jacobian([0.0, 0.0, 1.0])
    np.testing.assert_allclose(jacobian[:, 2], 0, atol=1e-9)
    if model == "ocam":
        c, d, e, poly = (camera.params[name] for name in ("c", "d", "e", "poly"))
        focal = abs(poly[0]) * np.array([[1, e], [d, c]])
    elif model == "f-theta":
        c, d, e, poly = (camera.params[name] for name in ("c", "d", "e", "angle_poly"))
        focal = np.array([[1, e], [d, c]]) / poly[0]
    else:
        slope = jacobian[0, 0] / camera.params["fx"]
        assert 0.2 < slope < 20
        fx, fy, skew = (camera.params.get(name, 0.0) for name in ("fx", "fy", "skew"))
        focal = slope * np.array([[fx, skew], [0, fy]])
    np.testing.assert_allclose(jacobian[:, :2], focal, rtol=1e-9, atol=1e-7)


@pytest.mark.parametrize("model", ["pinhole", "kannala-brandt", "equidistant", "stereographic"])
def test_classical_lenses_have_unit_slope_on_the_axis(model):
    camera = Camera(model, SIZE, {"fx": 300, "fy": 310, "cx": 600, "cy": 400})
    np.testing.assert_allclose(
        camera.project_jacobian([0, 0, 2.0]), [[150, 0, 0], [0, 155, 0]], rtol=1e-12, atol=1e-12
    )


def test_outside_the_domain_the_jacobian_is_nan():
    camera = Camera("orthographic", SIZE, {"fx": 300, "fy": 300, "cx": 600, "cy": 400})
    assert np.isnan(camera.project_jacobian([0.1, 0, -1])).all()
    assert np.isnan(camera.unproject_jacobian([600 + 301, 400])).all()
    assert np.isfinite(camera.unproject_jacobian([600 + 299, 400])).all()
