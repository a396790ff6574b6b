"""A camera as a value: checked, immutable, comparable, scalable."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench.cameras import Camera
from rectbench.cameras.brown import COEFFICIENTS
from rectbench.errors import InvalidInput, UnknownName
from tests.cameras.random_cameras import SIZE, any_camera, domain_rays

FOCAL = {"fx": 300.0, "fy": 310.0, "cx": 630.0, "cy": 480.0}


@settings(max_examples=40)
@given(any_camera(), st.sampled_from([None, 80, 95.5]))
def test_copies_are_equal_and_hash_alike(camera, limit_deg):
    camera = dataclasses.replace(camera, max_angle_deg=limit_deg)
    assert camera.max_angle_deg == limit_deg
    for other in (
        pickle.loads(pickle.dumps(camera)),
        copy.deepcopy(camera),
        eval(repr(camera), {"Camera": Camera}),
        Camera(camera.model, list(camera.size), dict(camera.params), camera.max_angle_deg),
    ):
        assert other == camera
        assert hash(other) == hash(camera)


def test_cameras_that_differ_in_one_number_differ():
    camera = Camera("equidistant", SIZE, FOCAL)
    assert camera != Camera("equisolid", SIZE, FOCAL)
    assert camera != Camera("equidistant", (1280, 961), FOCAL)
    assert camera != Camera("equidistant", SIZE, {**FOCAL, "cx": 630.0000001})
    assert camera != Camera("equidistant", SIZE, FOCAL, max_angle_deg=90)
    assert camera == Camera("equidistant", SIZE, {**FOCAL, "fx": np.float64(300)})


def test_a_camera_cannot_be_changed():
    given_params = dict(FOCAL)
    camera = Camera("equidistant", SIZE, given_params)
    given_params["fx"] = 1.0
    assert camera.params["fx"] == 300.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        camera.size = (1, 1)
    with pytest.raises(TypeError):
        camera.params["fx"] = 1.0


def test_parameters_left_out_are_0():
    camera = Camera("pinhole", SIZE, {"fx": 300, "fy": 300})
    assert set(camera.params) == {*FOCAL, *COEFFICIENTS}
    assert camera.params["cx"] == camera.params["s4"] == 0.0


@settings(max_examples=60)
@given(any_camera(), st.sampled_from([0.5, 0.37, 2.0, 3.1]))
def test_scaling_keeps_the_image_and_moves_its_pixels(camera, factor):
    scaled = camera.scaled(factor)
    sx, sy = scaled.width / camera.width, scaled.height / camera.height
    assert scaled.size == (round(SIZE[0] * factor), round(SIZE[1] * factor))
    rays = domain_rays(camera, per_direction=20, directions=6)
    (pixels, seen), (moved, still_seen) = camera.project(rays), scaled.project(rays)
    expected = (pixels + 0.5) * [sx, sy] - 0.5
    both = seen & still_seen
    assert both.sum() > 0.95 * seen.sum()
    # At the edge of a domain, where the angle no longer grows with the radius, rounding is magnified.
    np.testing.assert_allclose(moved[both], expected[both], rtol=1e-9, atol=1e-6)


def test_contains_counts_the_outer_half_pixels():
    camera = Camera("equidistant", (640, 480), FOCAL)
    corners = [[-0.5, -0.5], [639.5, 479.5], [-0.6, 0], [0, 479.6], [math.nan, 0]]
    assert camera.contains(corners).tolist() == [True, True, False, False, False]


def test_sees_needs_both_the_domain_and_the_image():
    camera = Camera("equidistant", (640, 480), {"fx": 200, "fy": 200, "cx": 320, "cy": 240}, max_angle_deg=60)
    assert camera.sees([[0, 0, 1], [0, 1, 0.1], [3, 0, 1.0], [math.nan, 0, 1]]).tolist() == [
        True,
        False,
        False,
        False,
    ]


def test_points_keep_their_leading_shape():
    camera = Camera("double-sphere", SIZE, {**FOCAL, "xi": -0.2, "alpha": 0.6})
    for shape in ((), (0,), (1,), (2, 3), (2, 0, 4)):
        rays = np.broadcast_to([0.1, 0.2, 1.0], (*shape, 3))
        pixels, seen = camera.project(rays)
        assert pixels.shape == (*shape, 2)
        assert seen.shape == shape
        back, known = camera.unproject(pixels)
        assert back.shape == (*shape, 3)
        assert known.shape == shape
        assert camera.project_jacobian(rays).shape == (*shape, 2, 3)
        assert camera.unproject_jacobian(pixels).shape == (*shape, 3, 2)
        assert seen.all()


@pytest.mark.parametrize(("method", "shape"), [("project", (4, 2)), ("unproject", (3,)), ("project", ())])
def test_points_of_the_wrong_width_are_refused(method, shape):
    with pytest.raises(InvalidInput, match="expected"):
        getattr(Camera("equidistant", SIZE, FOCAL), method)(np.zeros(shape))


@pytest.mark.parametrize(
    ("model", "params", "message"),
    [
        ("equidistant", {"fx": 300}, "equidistant lacks fy; expected a number in (0, inf)"),
        (
            "equidistant",
            {**FOCAL, "fx": -3},
            "equidistant has fx = -3; expected a number in (0, inf)",
        ),
        (
            "extended-unified",
            {**FOCAL, "beta": 1, "alpha": 1.5},
            "extended-unified has alpha = 1.5; expected a number in [0, 1]",
        ),
        (
            "extended-unified",
            {**FOCAL, "alpha": 0.5},
            "extended-unified lacks beta; expected a number in (0, inf)",
        ),
        (
            "extended-unified",
            {**FOCAL, "alpha": 0.5, "beta": 0},
            "extended-unified has beta = 0; expected a number in (0, inf)",
        ),
        (
            "double-sphere",
            {**FOCAL, "xi": -1},
            "double-sphere has xi = -1; expected a number in (-1, 1]",
        ),
        (
            "double-sphere",
            {**FOCAL, "alpha": -0.1},
            "double-sphere has alpha = -0.1; expected a number in [0, 1]",
        ),
        ("unified", {**FOCAL, "xi": -1.5}, "unified has xi = -1.5; expected a number in (-1, inf)"),
        (
            "field-of-view",
            {**FOCAL, "omega": 3.2},
            "field-of-view has omega = 3.2; expected a number in [0, 3.14159)",
        ),
        ("pinhole", {**FOCAL, "k1": math.nan}, "pinhole has k1 = nan; expected a finite number"),
        ("pinhole", {**FOCAL, "k1": math.inf}, "pinhole has k1 = inf; expected a finite number"),
        ("pinhole", {**FOCAL, "k1": "wide"}, "pinhole has k1 = 'wide'; expected a finite number"),
        ("pinhole", {**FOCAL, "k1": [0.1]}, "pinhole has k1 = [0.1]; expected a finite number"),
        ("pinhole", {**FOCAL, "k1": None}, "pinhole has k1 = None; expected a finite number"),
        ("pinhole", [1, 2], "pinhole has params [1, 2]; expected a mapping of names to numbers"),
        (
            "pinhole",
            {**FOCAL, "K1": 0.1},
            "unknown parameter of pinhole 'K1'; did you mean",
        ),
        ("pinhol", FOCAL, "unknown projection model 'pinhol'; did you mean pinhole"),
        ("double_sphere", FOCAL, "unknown projection model 'double_sphere'; did you mean double-sphere"),
    ],
)
def test_a_bad_parameter_gets_one_line_with_model_name_value_and_range(model, params, message):
    with pytest.raises(InvalidInput) as error:
        Camera(model, SIZE, params)
    assert str(error.value).startswith(message)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("size", [(0, 480), (640, -1), (640,), (640, 480, 3), (640.5, 480), "64", None, 640])
def test_a_bad_size_is_refused(size):
    with pytest.raises(InvalidInput, match="camera size is"):
        Camera("equidistant", size, FOCAL)


@pytest.mark.parametrize("limit", [0, -1, 181, math.nan, math.inf, "90"])
def test_a_bad_image_circle_is_refused(limit):
    with pytest.raises(InvalidInput, match="max_angle_deg is"):
        Camera("equidistant", SIZE, FOCAL, max_angle_deg=limit)


@pytest.mark.parametrize("factor", [0, -1, math.nan, math.inf])
def test_a_bad_scale_is_refused(factor):
    with pytest.raises(InvalidInput, match="scaled by"):
        Camera("equidistant", SIZE, FOCAL).scaled(factor)


def test_unknown_names_are_a_kind_of_invalid_input():
    with pytest.raises(UnknownName):
        Camera("fish", SIZE, FOCAL)
