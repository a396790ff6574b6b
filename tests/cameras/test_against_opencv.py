"""The models that OpenCV has too give its pixels."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from tests.cameras.random_cameras import SIZE, cameras, domain_rays

COEFFICIENTS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
ZERO = np.zeros(3)


def matrix(camera):
    p = camera.params
    return np.array([[p["fx"], p.get("skew", 0), p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])


def coefficients(camera, names):
    return np.array([camera.params[name] for name in names])


def compare(camera, rays, expected):
    """Equal to 1e-8 px wherever the pixel is not so far out that its last digit is worth more."""
    pixels, seen = camera.project(rays)
    near = seen & (np.abs(pixels) < 1e4).all(axis=-1)
    assert near.sum() > len(rays) // 3
    assert np.abs(pixels - expected.reshape(-1, 2))[near].max() < 1e-8


@settings(max_examples=60)
@given(cameras("pinhole"))
def test_pinhole_is_calib3d_with_twelve_coefficients(camera):
    rays = domain_rays(camera, directions=12)
    rays = rays[rays[:, 2] > 0.02]
    compare(
        camera,
        rays,
        cv2.projectPoints(rays, ZERO, ZERO, matrix(camera), coefficients(camera, COEFFICIENTS))[0],
    )


@settings(max_examples=60)
@given(cameras("tilted-pinhole"))
def test_tilted_pinhole_is_calib3d_with_fourteen_coefficients(camera):
    rays = domain_rays(camera, directions=12)
    rays = rays[rays[:, 2] > 0.02]
    all_of_them = coefficients(camera, (*COEFFICIENTS, "tau_x", "tau_y"))
    compare(camera, rays, cv2.projectPoints(rays, ZERO, ZERO, matrix(camera), all_of_them)[0])


@settings(max_examples=60)
@given(cameras("radial-tangential"))
def test_three_radial_terms_are_calib3d_s_first_five_coefficients(camera):
    camera = replace(camera, params={**camera.params, "k4": 0.0, "skew": 0.0})
    rays = domain_rays(camera, directions=12)
    rays = rays[rays[:, 2] > 0.02]
    first = coefficients(camera, COEFFICIENTS[:5])
    compare(camera, rays, cv2.projectPoints(rays, ZERO, ZERO, matrix(camera), first)[0])


@settings(max_examples=60)
@given(cameras("kannala-brandt"))
def test_kannala_brandt_is_fisheye_up_to_90_degrees(camera):
    rays = domain_rays(camera, directions=12)
    rays = rays[rays[:, 2] > 1e-3]
    flat = rays.reshape(-1, 1, 3)
    expected = cv2.fisheye.projectPoints(
        flat,
        ZERO,
        ZERO,
        matrix(camera),
        coefficients(camera, ["k1", "k2", "k3", "k4"]),
        alpha=camera.params["skew"] / camera.params["fx"],
    )[0]
    compare(camera, rays, expected)


@settings(max_examples=60)
@given(cameras("unified"))
def test_unified_is_omnidir(camera):
    rays = domain_rays(camera, directions=12)
    rays = rays[rays[:, 2] > 0.02 - min(camera.params["xi"], 1.0)]
    distortion = coefficients(camera, ["k1", "k2", "p1", "p2"])
    expected = cv2.omnidir.projectPoints(
        rays.reshape(-1, 1, 3), ZERO, ZERO, matrix(camera), camera.params["xi"], distortion
    )[0]
    compare(camera, rays, expected)


@pytest.mark.parametrize("name", COEFFICIENTS)
@given(value=st.floats(0.001, 0.02))
@settings(max_examples=5)
def test_each_pinhole_coefficient_stands_where_opencv_has_it(name, value):
    focal = {"fx": 500.0, "fy": 510.0, "cx": 600.0, "cy": 400.0}
    camera = Camera("pinhole", SIZE, {**focal, name: value})
    rays = np.array([[0.3, -0.2, 1.0], [-0.4, 0.5, 2.0]])
    every = coefficients(camera, COEFFICIENTS)
    expected = cv2.projectPoints(rays, ZERO, ZERO, matrix(camera), every)[0].reshape(-1, 2)
    np.testing.assert_allclose(camera.project(rays)[0], expected, rtol=0, atol=1e-10)
    assert np.abs(expected - Camera("pinhole", SIZE, focal).project(rays)[0]).max() > 1e-5
