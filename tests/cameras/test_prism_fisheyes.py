"""The two fisheyes with thin-prism terms: their formulas written anew, COLMAP's own numbers."""

import math

import numpy as np
import pytest
from hypothesis import given, settings

from rectbench.cameras import Camera
from tests.cameras.random_cameras import SIZE, angle_between, cameras, domain_rays, ray

# Camera 0 of ETH3D's courtyard, as often printed in documentation: fx fy cx cy, then the terms.
ETH3D = {"fx": 3411.42, "fy": 3410.02, "cx": 3040.79, "cy": 2013.57, "k1": 0.21047, "k2": 0.21102} | {
    "p1": -5.36231e-06,
    "p2": 0.00051541,
    "k3": -0.158023,
    "k4": 0.406856,
    "sx1": -8.46499e-05,
    "sy1": 0.000861313,
}
ARIA = {"fx": 240.0, "fy": 241.0, "cx": 319.5, "cy": 239.5, "k0": -0.024, "k1": 0.1, "k2": -0.04} | {
    "k3": 0.011,
    "k4": -0.0012,
    "k5": 0.0002,
    "p0": 0.0012,
    "p1": -0.0008,
    "s0": -0.0003,
    "s1": 0.0004,
    "s2": 0.0009,
    "s3": -0.0002,
}


def weng(p, theta, phi):
    """u and v of COLMAP's documentation of THIN_PRISM_FISHEYE, term by term."""
    u, v = theta * math.cos(phi), theta * math.sin(phi)
    r2 = theta**2
    stretch = p["k1"] * r2 + p["k2"] * r2**2 + p["k3"] * r2**3 + p["k4"] * r2**4
    du = u * stretch + 2 * p["p1"] * u * v + p["p2"] * (r2 + 2 * u * u) + p["sx1"] * r2
    dv = v * stretch + 2 * p["p2"] * u * v + p["p1"] * (r2 + 2 * v * v) + p["sy1"] * r2
    return p["fx"] * (u + du) + p["cx"], p["fy"] * (v + dv) + p["cy"]


def aria(p, theta, phi):
    """The equations of Project Aria's page on its camera models."""
    radius = theta * (1 + sum(p[f"k{i}"] * theta ** (2 * i + 2) for i in range(6)))
    radial = np.array([radius * math.cos(phi), radius * math.sin(phi)])
    tangent, square = np.array([p["p0"], p["p1"]]), radial @ radial
    point = radial + 2 * (radial @ tangent) * radial + square * tangent
    point += [p["s0"] * square + p["s1"] * square**2, p["s2"] * square + p["s3"] * square**2]
    return p["fx"] * point[0] + p["cx"], p["fy"] * point[1] + p["cy"]


@pytest.mark.parametrize(
    ("model", "params", "formula"), [("thin-prism-fisheye", ETH3D, weng), ("fisheye624", ARIA, aria)]
)
@pytest.mark.parametrize("theta_deg", [1e-6, 5, 40, 89, 90, 110])
def test_each_is_its_formula(model, params, formula, theta_deg):
    camera = Camera(model, SIZE, params)
    for phi in (0.3, 2.0, 4.4):
        pixel, seen = camera.project(ray(np.radians(theta_deg), phi))
        assert seen
        np.testing.assert_allclose(pixel, formula(params, math.radians(theta_deg), phi), rtol=1e-12)


@pytest.mark.parametrize("model", ["thin-prism-fisheye", "fisheye624"])
@pytest.mark.parametrize("term", ["k", "p", "s"])
def test_each_term_stands_where_its_formula_has_it(model, term):
    params, formula = (ETH3D, weng) if model == "thin-prism-fisheye" else (ARIA, aria)
    bare = {name: value if name[0] in "fc" else 0.0 for name, value in params.items()}
    for name in params:
        if name.startswith(term):
            camera = Camera(model, SIZE, {**bare, name: 0.013})
            expected = formula({**bare, name: 0.013}, 0.8, 0.9)
            np.testing.assert_allclose(camera.project(ray(np.array(0.8), np.array(0.9)))[0], expected)
            assert np.abs(np.subtract(expected, formula(bare, 0.8, 0.9))).max() > 0.1


# What pycolmap 4.2.1 gives for these cameras, half a pixel further as COLMAP counts them.
COLMAP_RAYS = [[0.3, -0.2, 1.0], [-0.8, 0.5, 0.9], [1.5, 1.2, 0.4]]
COLMAP_PIXELS = {
    "thin-prism-fisheye": [
        [4051.5482518891, 1341.3076848358],
        [99.0416897816, 3854.7312964755],
        [24943.9479969273, 19532.2568139096],
    ],
    "fisheye624": [
        [389.0946520183, 193.7653388205],
        [153.0240507108, 344.9085700607],
        [617.872327689, 478.1339222488],
    ],
}


@pytest.mark.parametrize(("model", "params"), [("thin-prism-fisheye", ETH3D), ("fisheye624", ARIA)])
def test_each_gives_the_pixels_of_colmap(model, params):
    pixels, seen = Camera(model, SIZE, params).project(COLMAP_RAYS)
    assert seen.all()
    np.testing.assert_allclose(pixels + 0.5, COLMAP_PIXELS[model], rtol=0, atol=1e-8)


@settings(max_examples=30)
@given(cameras("kannala-brandt"))
def test_both_contain_kannala_brandt(camera):
    camera = Camera(camera.model, camera.size, {**camera.params, "skew": 0.0})
    rays = domain_rays(camera, per_direction=20, directions=8)
    pixels, seen = camera.project(rays)
    focal = {name: camera.params[name] for name in ("fx", "fy", "cx", "cy")}
    k1, k2, k3, k4 = (camera.params[f"k{i}"] for i in range(1, 5))
    for model, terms in (
        ("thin-prism-fisheye", {"k1": k1, "k2": k2, "k3": k3, "k4": k4}),
        ("fisheye624", {"k0": k1, "k1": k2, "k2": k3, "k3": k4}),
    ):
        same, same_seen = Camera(model, SIZE, {**focal, **terms}).project(rays)
        both = seen & same_seen
        assert both.mean() > 0.7  # the rest lie within 1e-5 of an edge, which takes the slope otherwise
        np.testing.assert_allclose(same[both], pixels[both], rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize(("model", "params"), [("thin-prism-fisheye", ETH3D), ("fisheye624", ARIA)])
def test_real_terms_come_back_all_over_the_domain(model, params):
    camera = Camera(model, SIZE, params)
    rays = domain_rays(camera)
    pixels, seen = camera.project(rays)
    back, known = camera.unproject(pixels[seen])
    assert seen.mean() > 0.98
    assert known.all()
    assert angle_between(back, rays[seen]).max() < 1e-10
