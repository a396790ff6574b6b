"""Where each lens stops: rays beyond the edge are invalid, rays before it are not."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from tests.cameras.random_cameras import SIZE, any_camera, cameras, domain_rays, edge_angle, ray

CENTRE = {"cx": 630.0, "cy": 480.0}
FOCAL = {"fx": 300.0, "fy": 310.0, **CENTRE}
PHI = np.linspace(0, 6, 13)


@pytest.mark.parametrize(
    ("model", "params", "edge_deg"),
    [
        ("pinhole", {}, 90),
        # slope 1 + 3 k1 r² = 0
        ("pinhole", {"k1": -0.3}, math.degrees(math.atan(math.sqrt(1 / 0.9)))),
        # slope 1 + 3 k1 q + 5 k2 q² = 0 at q = 1, a minimum before which it rises
        ("pinhole", {"k1": 0.5, "k2": -0.5}, 45),
        # r (1 + k4 r²)⁻¹: slope (1 - k4 r²)/(1 + k4 r²)² = 0
        ("pinhole", {"k4": 0.25}, math.degrees(math.atan(2))),
        ("kannala-brandt", {"k1": -0.1}, math.degrees(math.sqrt(1 / 0.3))),
        ("kannala-brandt", {}, 180),
        ("unified", {"xi": 0.6}, math.degrees(math.acos(-0.6))),
        ("unified", {"xi": 1.6}, math.degrees(math.acos(-1 / 1.6))),
        ("unified", {"xi": 1.0}, 180),
        ("extended-unified", {"alpha": 0.4, "beta": 1.0}, math.degrees(math.acos(-0.4 / 0.6))),
        ("extended-unified", {"alpha": 0.6, "beta": 1.0}, math.degrees(math.acos(-0.4 / 0.6))),
        # z = -w d with d² = β sin² + z²: tan θ = -sqrt((1 - w²)/β)/w
        (
            "extended-unified",
            {"alpha": 0.6, "beta": 2.0},
            180 - math.degrees(math.atan2(math.sqrt((1 - 4 / 9) / 2), 2 / 3)),
        ),
        ("double-sphere", {"alpha": 0.6}, math.degrees(math.acos(-0.4 / 0.6))),
        # the second sphere ends at 90° about its own centre: cos θ = -ξ
        ("double-sphere", {"xi": 0.5, "alpha": 1.0}, 120),
        ("double-sphere", {"xi": -0.2, "alpha": 1.0}, math.degrees(math.acos(0.2))),
        ("field-of-view", {"omega": 0.9}, 180),
        ("field-of-view", {"omega": 0.0}, 90),
        ("equidistant", {}, 180),
        ("equisolid", {}, 180),
        ("stereographic", {}, 180),
        ("orthographic", {}, 90),
        ("thin-prism-fisheye", {}, 180),
        ("thin-prism-fisheye", {"k1": -0.1}, math.degrees(math.sqrt(1 / 0.3))),
        ("fisheye624", {}, 180),
        ("fisheye624", {"k0": -0.1}, math.degrees(math.sqrt(1 / 0.3))),
        ("cahvor", {}, math.degrees(math.atan(1000))),
        # bent slope 0.5 (1 + 3 (-0.15/0.5) r²) = 0
        ("cahvor", {"r0": -0.5, "r1": -0.15}, math.degrees(math.atan(math.sqrt(1 / 0.9)))),
        # slope 1 + 9 k4 r⁸ = 0
        ("radial-tangential", {"k4": -0.01}, math.degrees(math.atan((1 / 0.09) ** 0.125))),
        ("radial-tangential", {}, 90),
        ("division", {}, 90),
        ("division", {"k": -0.3}, 180),
        # θ = atan2(r, 1 + k r²) stops rising at r = 1/sqrt(k)
        ("division", {"k": 0.2}, math.degrees(math.atan(0.5 / math.sqrt(0.2)))),
        # θ = ρ - ρ³/3, of a camera of one pixel's focal length, stops rising at ρ = 1
        ("f-theta", {"angle_poly": [1.0, 0.0, -1 / 3]}, math.degrees(2 / 3)),
        ("f-theta", {"angle_poly": [1.0, 0.5]}, 180),
    ],
)
def test_the_edge_is_where_theory_puts_it(model, params, edge_deg):
    camera = Camera(model, SIZE, {**(CENTRE if model == "f-theta" else FOCAL), **params})
    edge = np.degrees(edge_angle(camera, PHI))
    assert (edge <= edge_deg + 1e-9).all()
    assert (edge > edge_deg - 0.003).all()
    beyond = ray(np.radians(np.linspace(edge_deg + 1e-6, 180, 50))[:, None], PHI)
    if edge_deg < 180:
        assert not camera.project(beyond)[1].any()


def raw_radius(model, params, theta):
    """The models' formulas without any domain, written anew."""
    s, z = np.sin(theta), np.cos(theta)
    if model == "kannala-brandt":
        return theta + sum(params[f"k{i}"] * theta ** (2 * i + 1) for i in range(1, 5))
    if model == "unified":
        return s / (z + params["xi"])
    if model == "extended-unified":
        alpha = params["alpha"]
        return s / (alpha * np.sqrt(params["beta"] * s * s + z * z) + (1 - alpha) * z)
    alpha, forward = params["alpha"], params["xi"] + z
    return s / (alpha * np.hypot(s, forward) + (1 - alpha) * forward)


@pytest.mark.parametrize("model", ["kannala-brandt", "unified", "extended-unified", "double-sphere"])
@settings(max_examples=40)
@given(data=st.data())
def test_the_radius_rises_up_to_the_edge_and_not_beyond(model, data):
    camera = data.draw(cameras(model))
    params = {**camera.params}
    if model == "unified":
        params |= dict.fromkeys(("k1", "k2", "p1", "p2"), 0.0)
        camera = Camera(model, SIZE, params)
    edge = edge_angle(camera, np.zeros(1))[0]
    inside = raw_radius(model, params, np.linspace(0, 0.9999 * edge, 2000))
    assert (np.diff(inside) > 0).all()
    if edge < math.radians(179):
        before, after = raw_radius(model, params, np.array([edge - 1e-3, edge + 1e-3]))
        slope = (raw_radius(model, params, edge + 2e-3) - after) / 1e-3
        assert after < 0 or not np.isfinite(after) or after > 100 or slope < 0.05 * max(1.0, before)


def test_a_tilted_sensor_ends_where_it_sees_the_lens_plane_nearly_edge_on():
    camera = Camera("tilted-pinhole", SIZE, {**FOCAL, "tau_y": 0.2})
    left, right = edge_angle(camera, np.array([math.pi, 0.0]))
    assert math.tan(left) == pytest.approx((math.cos(0.2) - 0.05) / math.sin(0.2), rel=1e-9)
    assert right > math.radians(89.99)


@pytest.mark.parametrize("model", ["pinhole", "tilted-pinhole", "radial-tangential"])
@settings(max_examples=60)
@given(data=st.data())
def test_no_two_rays_of_a_distorted_pinhole_share_a_pixel(model, data):
    camera = data.draw(cameras(model))
    rays = domain_rays(camera, per_direction=30, directions=16)
    jacobian = camera.project_jacobian(rays)
    turns_over = np.cross(jacobian[:, 0], jacobian[:, 1])
    # The signed area that a small patch of rays covers on the image keeps its sign.
    area = np.einsum("ij,ij->i", turns_over, rays)
    assert (area[np.isfinite(area)] > 0).all()


def test_tangential_terms_pull_the_edge_in_where_they_fold_first():
    radial = Camera("pinhole", SIZE, {**FOCAL, "k1": -0.3})
    tilted = Camera("pinhole", SIZE, {**FOCAL, "k1": -0.3, "p1": 0.01, "p2": -0.02})
    assert edge_angle(tilted, PHI).max() < edge_angle(radial, PHI).min()
    # Slope along the direction that folds first: 1 + 3 k1 r² - 6 |p| r = 0.
    p = math.hypot(0.01, 0.02)
    fold = (-6 * p + math.sqrt(36 * p * p + 3.6)) / 1.8
    np.testing.assert_allclose(np.tan(edge_angle(tilted, PHI)), fold, rtol=1e-4)


def test_thin_prism_terms_pull_the_edge_in_too():
    prism = Camera("pinhole", SIZE, {**FOCAL, "k1": -0.3, "s1": 0.03, "s3": -0.04})
    # 1 + 3 k1 r² - 2 |s| r = 0 along -s.
    fold = (-0.1 + math.sqrt(0.01 + 3.6)) / 1.8
    np.testing.assert_allclose(np.tan(edge_angle(prism, PHI)), fold, rtol=1e-4)


@pytest.mark.parametrize(
    ("model", "terms"),
    [
        ("thin-prism-fisheye", {"p1": 0.06, "p2": -0.08}),
        ("fisheye624", {"p1": 0.06, "p0": -0.08}),
        # the prism terms' 2 |s| θ for the tangential ones' 6 |p| θ
        ("thin-prism-fisheye", {"sx1": 0.18, "sy1": -0.24}),
        ("fisheye624", {"s0": 0.18, "s2": -0.24}),
    ],
)
def test_tangential_and_prism_terms_end_a_fisheye_where_they_fold_first(model, terms):
    camera = Camera(model, SIZE, {**FOCAL, **terms})
    # Slope along the direction that folds first: 1 - 6 |p| θ = 0.
    np.testing.assert_allclose(edge_angle(camera, PHI), 1 / 0.6, rtol=1e-4)


@pytest.mark.parametrize("model", ["thin-prism-fisheye", "fisheye624"])
@settings(max_examples=30)
@given(data=st.data())
def test_no_two_rays_of_a_distorted_fisheye_share_a_pixel(model, data):
    camera = data.draw(cameras(model))
    rays = domain_rays(camera, per_direction=30, directions=16)
    jacobian = camera.project_jacobian(rays)
    area = np.einsum("ij,ij->i", np.cross(jacobian[:, 0], jacobian[:, 1]), rays)
    assert (area[np.isfinite(area)] > 0).all()


def test_a_rational_lens_ends_before_its_pole():
    camera = Camera("pinhole", SIZE, {**FOCAL, "k4": -0.25})
    edge = np.tan(edge_angle(camera, PHI))
    assert (edge < 2).all()
    assert (edge > 1.98).all()


@settings(max_examples=60)
@given(any_camera())
def test_pixels_beyond_the_image_of_the_domain_have_no_ray(camera):
    edge = edge_angle(camera, PHI)
    pixels, _ = camera.project(ray(edge, PHI))
    centre, _ = camera.project([0, 0, 1.0])
    outside = centre + (pixels - centre) * 1.02
    jacobian = camera.project_jacobian(ray(edge * 0.999, PHI))
    folds = np.abs(jacobian).max(axis=(-2, -1)) < 1e4 * np.linalg.norm(outside - centre, axis=-1)
    bounded = folds & (np.abs(pixels - centre).max(axis=-1) < 3e4)
    back, known = camera.unproject(outside)
    again, seen = camera.project(back)
    # Either there is no ray, or (the image of the edge is no circle) the ray is the right one.
    right = known & seen & (np.abs(again - outside).max(axis=-1) < 1e-6)
    assert (~known | right)[bounded].all()


@pytest.mark.parametrize("model", ["pinhole", "orthographic", "double-sphere"])
def test_a_far_pixel_of_a_folding_lens_has_no_ray(model):
    params = {"pinhole": {"k1": -0.3}, "orthographic": {}, "double-sphere": {"xi": -0.2, "alpha": 0.6}}[model]
    camera = Camera(model, SIZE, {**FOCAL, **params})
    rays, known = camera.unproject([[5000.0, 480.0], [-4000.0, 9000.0]])
    assert not known.any()
    assert np.isnan(rays).all()


@settings(max_examples=60)
@given(any_camera())
def test_what_is_not_finite_is_invalid(camera):
    bad = [math.nan, math.inf, -math.inf]
    rays = np.array([np.roll([b, 0.1, 1.0], i) for b in bad for i in range(3)] + [[0.0, 0.0, 0.0]])
    pixels = np.array([[b, 400.0] for b in bad] + [[400.0, b] for b in bad])
    for values, ok in (camera.project(rays), camera.unproject(pixels)):
        assert not ok.any()
        assert np.isnan(values).all()


@settings(max_examples=60)
@given(any_camera())
def test_the_ray_straight_back_has_no_one_pixel(camera):
    assert not camera.project([0.0, 0.0, -1.0])[1]


@pytest.mark.parametrize("model", ["equidistant", "kannala-brandt", "field-of-view", "stereographic"])
def test_rays_next_to_straight_back_are_seen(model):
    params = {"omega": 0.9} if model == "field-of-view" else {}
    camera = Camera(model, SIZE, {**FOCAL, **params})
    backward = ray(np.array([math.pi - 1e-7]), np.array([2.0]))
    pixels, seen = camera.project(backward)
    back, known = camera.unproject(pixels)
    assert seen.all()
    assert known.all()
    np.testing.assert_allclose(back, backward, rtol=0, atol=1e-9)
