"""Each model against its formula in the literature, and the models that contain one another."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from tests.cameras.random_cameras import SIZE, ray

FOCAL = {"fx": 320.0, "fy": 330.0, "cx": 640.0, "cy": 470.0}
THETA = np.radians([1e-6, 0.3, 20, 55, 85])
WIDE = np.radians([1e-6, 0.3, 20, 55, 85, 90, 110, 150, 179])
PHI = 0.7


def radii(camera: Camera, theta: np.ndarray) -> np.ndarray:
    """Radius on the lens plane of rays at the angles theta."""
    pixels, seen = camera.project(ray(theta, np.full_like(theta, PHI)))
    assert seen.all()
    x = (pixels[:, 0] - camera.params["cx"]) / camera.params["fx"]
    y = (pixels[:, 1] - camera.params["cy"]) / camera.params["fy"]
    np.testing.assert_allclose(np.arctan2(y, x), PHI, atol=1e-6)
    return np.hypot(x, y)


@pytest.mark.parametrize(
    ("model", "law", "theta"),
    [
        ("pinhole", np.tan, THETA),
        ("equidistant", lambda t: t, WIDE),
        ("equisolid", lambda t: 2 * np.sin(t / 2), WIDE),
        ("stereographic", lambda t: 2 * np.tan(t / 2), WIDE),
        ("orthographic", np.sin, THETA),
    ],
)
def test_classical_lenses_follow_their_law(model, law, theta):
    np.testing.assert_allclose(radii(Camera(model, SIZE, FOCAL), theta), law(theta), rtol=1e-10, atol=1e-15)


def test_field_of_view_is_devernay_and_faugeras_and_goes_past_90_degrees():
    camera = Camera("field-of-view", SIZE, {**FOCAL, "omega": 0.9})
    expected = np.arctan(2 * np.tan(THETA) * np.tan(0.45)) / 0.9
    np.testing.assert_allclose(radii(camera, THETA), expected, rtol=1e-10, atol=1e-15)
    assert radii(camera, np.array([math.pi / 2]))[0] == pytest.approx(math.pi / 2 / 0.9, rel=1e-14)
    beyond = radii(camera, np.radians([100, 150, 179.9]))
    expected = (math.pi - np.arctan(2 * np.tan(np.radians([80, 30, 0.1])) * np.tan(0.45))) / 0.9
    np.testing.assert_allclose(beyond, expected, rtol=1e-12)


@pytest.mark.parametrize("omega", [0.0, 1e-9, 1e-6])
def test_without_distortion_field_of_view_is_the_pinhole(omega):
    camera, pinhole = (
        Camera("field-of-view", SIZE, {**FOCAL, "omega": omega}),
        Camera("pinhole", SIZE, FOCAL),
    )
    theta = np.radians([0.0, 1e-7, 10, 60, 89])
    rays = ray(theta, np.full_like(theta, PHI))
    np.testing.assert_allclose(camera.project(rays)[0], pinhole.project(rays)[0], rtol=1e-8)
    assert not camera.project([1.0, 0, 0])[1]
    assert not camera.project([1.0, 0, -0.5])[1]


def test_double_sphere_is_equation_40_of_usenko():
    # Left camera of TUM-VI (basalt's tumvi_512_ds_calib.json, BSD-3).
    xi, alpha = -0.17213086034353243, 0.5931177593944744
    focal = {"fx": 158.28600034966977, "fy": 158.2743455478755}
    centre = {"cx": 254.96116578191653, "cy": 256.8894394501779}
    camera = Camera("double-sphere", (512, 512), {**focal, **centre, "xi": xi, "alpha": alpha})
    x, y, z = 0.8, -0.5, 0.3
    d1 = math.sqrt(x * x + y * y + z * z)
    d2 = math.sqrt(x * x + y * y + (xi * d1 + z) ** 2)
    depth = alpha * d2 + (1 - alpha) * (xi * d1 + z)
    expected = [
        158.28600034966977 * x / depth + 254.96116578191653,
        158.2743455478755 * y / depth + 256.8894394501779,
    ]
    np.testing.assert_allclose(camera.project([x, y, z])[0], expected, rtol=0, atol=1e-10)


@settings(max_examples=40)
@given(st.floats(-0.9, 0.9), st.floats(0.01, 0.99), st.floats(0, 0.6), st.floats(0, 6))
def test_double_sphere_unprojects_as_equations_46_to_50_of_usenko(xi, alpha, radius, phi):
    camera = Camera("double-sphere", SIZE, {**FOCAL, "xi": xi, "alpha": alpha})
    mx, my = radius * math.cos(phi), radius * math.sin(phi)
    square = mx * mx + my * my
    mz = (1 - alpha**2 * square) / (alpha * math.sqrt(1 - (2 * alpha - 1) * square) + 1 - alpha)
    scale = (mz * xi + math.sqrt(mz**2 + (1 - xi**2) * square)) / (mz**2 + square)
    pixel = [320.0 * mx + 640.0, 330.0 * my + 470.0]
    expected = np.array([scale * mx, scale * my, scale * mz - xi])
    np.testing.assert_allclose(camera.unproject(pixel)[0], expected, rtol=0, atol=1e-13)


def test_extended_unified_is_khomutenko():
    # One EuRoC camera (fisheye-calib-adapter, EUCM.yml, MIT).
    alpha, beta = 0.5864679700626143, 1.139248617863534
    focal = {"fx": 460.92588889854693, "fy": 459.59327980206865}
    centre = {"cx": 365.81762690405503, "cy": 248.93674967920276}
    camera = Camera("extended-unified", (752, 480), {**focal, **centre, "alpha": alpha, "beta": beta})
    x, y, z = -0.9, 0.4, 0.2
    depth = alpha * math.sqrt(beta * (x * x + y * y) + z * z) + (1 - alpha) * z
    expected = [focal["fx"] * x / depth + centre["cx"], focal["fy"] * y / depth + centre["cy"]]
    np.testing.assert_allclose(camera.project([x, y, z])[0], expected, rtol=0, atol=1e-10)


def same(one: Camera, other: Camera, theta: np.ndarray, tolerance_px: float = 1e-9) -> None:
    phi = np.linspace(0, 6, 7)
    rays = ray(theta[:, None] + 0 * phi, phi)
    (a, seen_a), (b, seen_b) = one.project(rays), other.project(rays)
    assert seen_a.all()
    assert seen_b.all()
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerance_px)


def scaled_focal(factor: float) -> dict[str, float]:
    return {**FOCAL, "fx": factor * FOCAL["fx"], "fy": factor * FOCAL["fy"]}


@settings(max_examples=30)
@given(st.floats(0.05, 0.95))
def test_three_sphere_models_meet_in_the_unified_one(alpha):
    theta = np.linspace(0, 0.9 * math.acos(max(-alpha / (1 - alpha), -(1 - alpha) / alpha, -1)), 9)
    unified = Camera("unified", SIZE, {**scaled_focal(1 / (1 - alpha)), "xi": alpha / (1 - alpha)})
    same(unified, Camera("extended-unified", SIZE, {**FOCAL, "alpha": alpha, "beta": 1.0}), theta)
    same(unified, Camera("double-sphere", SIZE, {**FOCAL, "alpha": alpha}), theta)


def test_special_cases_of_the_sphere_models_are_the_classical_lenses():
    pinhole, stereographic = Camera("pinhole", SIZE, FOCAL), Camera("stereographic", SIZE, FOCAL)
    orthographic = Camera("orthographic", SIZE, FOCAL)
    same(pinhole, Camera("unified", SIZE, FOCAL), THETA)
    same(pinhole, Camera("extended-unified", SIZE, {**FOCAL, "beta": 2.0}), THETA)
    same(pinhole, Camera("double-sphere", SIZE, FOCAL), THETA)
    same(stereographic, Camera("unified", SIZE, {**scaled_focal(2.0), "xi": 1.0}), WIDE[:-1])
    same(stereographic, Camera("extended-unified", SIZE, {**FOCAL, "alpha": 0.5, "beta": 1.0}), WIDE[:-1])
    same(orthographic, Camera("extended-unified", SIZE, {**FOCAL, "alpha": 1.0, "beta": 1.0}), THETA)


def test_kannala_brandt_without_coefficients_is_equidistant():
    same(Camera("kannala-brandt", SIZE, FOCAL), Camera("equidistant", SIZE, FOCAL), WIDE)


def test_published_fits_of_one_camera_by_five_models_agree():
    # The same EuRoC camera, fitted by fisheye-calib-adapter (MIT); fx fy cx cy, then the model's own.
    fits = {
        "kannala-brandt": {
            "fx": 461.58688085556616,
            "fy": 460.2811732644195,
            "cx": 366.28603126815506,
            "cy": 249.08026891791644,
            "k1": -0.012523386218579752,
            "k2": 0.057836801948828065,
            "k3": -0.08495347810986263,
            "k4": 0.04362766880887814,
        },
        "double-sphere": {
            "fx": 348.112754378549,
            "fy": 347.1109973814674,
            "cx": 365.8121721753254,
            "cy": 249.3555778487899,
            "alpha": 0.5657413673629862,
            "xi": -0.24425190195168348,
        },
        "extended-unified": {
            "fx": 460.92588889854693,
            "fy": 459.59327980206865,
            "cx": 365.81762690405503,
            "cy": 248.93674967920276,
            "alpha": 0.5864679700626143,
            "beta": 1.139248617863534,
        },
        "pinhole": {
            "fx": 459.2595646276051,
            "fy": 457.7579979599497,
            "cx": 366.021259576013,
            "cy": 248.29906707021513,
            "k1": -0.2895683327836746,
            "k2": 0.07964702146041833,
            "p1": 0.00033877669379945766,
            "p2": -2.1638533618181003e-05,
        },
    }
    cameras = [Camera(model, (752, 480), params) for model, params in fits.items()]
    pixels = np.stack(np.meshgrid(np.linspace(80, 670, 9), np.linspace(60, 420, 7)), axis=-1)
    rays, known = cameras[0].unproject(pixels)
    assert known.all()
    for camera in cameras[1:]:
        assert np.abs(camera.project(rays)[0] - pixels).max() < 3.0
