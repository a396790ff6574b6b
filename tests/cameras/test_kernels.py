"""The compiled path gives the digits of the NumPy path."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rectbench import llvm
from rectbench.cameras import Camera, brown
from rectbench.formulas import evaluation
from rectbench.formulas.inversion import invert_in_disk, invert_monotone
from rectbench.formulas.namespaces import NUMPY
from tests.cameras.random_cameras import MODELS, SIZE, cameras, domain_rays

needs_llvm = pytest.mark.skipif(not llvm.available(), reason=f"no LLVM: {llvm.problem()}")


NOWHERE = [
    [np.nan, 0, 1],
    [0, np.nan, 1],
    [0, 0, np.nan],
    [1, 0, np.inf],
    [-np.inf, 0, 1],
    [0, 0, 0],
    [0, 0, -1],
]


def both(function, points):
    """What `function` gives for the points by NumPy and by a kernel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluation, "KERNEL_THRESHOLD", 10**9)
        by_numpy = function(points)
        patch.setattr(evaluation, "KERNEL_THRESHOLD", 1)
        return by_numpy, function(points)


@needs_llvm
@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=6)
@given(data=st.data())
def test_kernels_and_numpy_agree_to_1e12(model, data):
    camera = data.draw(cameras(model))
    rays = domain_rays(camera, per_direction=20, directions=10)
    off_edge = np.abs(camera.project_jacobian(rays)).max(axis=(-2, -1)) < 1e5
    rays = np.concatenate([rays[off_edge], NOWHERE])
    (pixels, seen), (pixels_kernel, seen_kernel) = both(camera.project, rays)
    size = np.maximum(np.abs(pixels), 1e3)
    assert (seen == seen_kernel).mean() > 0.95  # rounding decides on the very edge
    assert np.nanmax(np.abs(pixels - pixels_kernel) / size) < 1e-12
    assert np.isnan(pixels_kernel[-len(NOWHERE) :]).all()

    inside = np.random.default_rng(5).uniform(250, 950, (400, 2))
    inner = np.concatenate([inside, [[np.nan, 3], [3, np.inf], [-np.inf, 3]]])
    (back, known), (back_kernel, known_kernel) = both(camera.unproject, inner)
    assert not known_kernel[-3:].any()
    slope = np.abs(camera.unproject_jacobian(inner)).max(axis=(-2, -1))
    steep = ~(slope < 0.1)  # where a fold is near, both have only the digits that it leaves
    assert (known == known_kernel)[~steep].all()
    assert np.nanmax(np.abs(back - back_kernel)[~steep], initial=0.0) < 1e-12

    jacobian, jacobian_kernel = both(camera.project_jacobian, rays[: -len(NOWHERE)])
    scale = np.linalg.norm(jacobian, axis=(-2, -1), keepdims=True)
    assert np.nanmax(np.abs(jacobian - jacobian_kernel) / scale) < 1e-9


@needs_llvm
def test_a_full_frame_comes_back_and_keeps_its_shape():
    camera = Camera(
        "kannala-brandt", (320, 200), {"fx": 100, "fy": 101, "cx": 160, "cy": 99, "k1": -0.01, "k2": 0.003}
    )
    grid = camera.pixel_grid()
    assert grid.shape[0] * grid.shape[1] >= evaluation.KERNEL_THRESHOLD
    rays, known = camera.unproject(grid)
    pixels, seen = camera.project(rays)
    assert rays.shape == (200, 320, 3)
    assert known.shape == (200, 320)
    assert known.all()
    assert seen.all()
    np.testing.assert_allclose(pixels, grid, rtol=0, atol=1e-9)
    assert camera.project_jacobian(rays).shape == (200, 320, 2, 3)


@needs_llvm
def test_kernels_leave_their_input_alone_and_their_output_is_ones_own():
    camera = Camera("equidistant", SIZE, {"fx": 300, "fy": 300, "cx": 640, "cy": 480})
    pixels = camera.pixel_grid().reshape(-1, 2)[: evaluation.KERNEL_THRESHOLD]
    before = pixels.copy()
    first, _ = camera.unproject(pixels)
    kept = first.copy()
    pixels += 100
    second, _ = camera.unproject(pixels)
    second[:] = 7
    np.testing.assert_array_equal(pixels - 100, before)
    np.testing.assert_array_equal(first, kept)


def test_views_and_other_number_types_are_read_right():
    camera = Camera("equidistant", SIZE, {"fx": 300, "fy": 300, "cx": 640, "cy": 480})
    wide = np.arange(60, dtype=np.float32).reshape(6, 10)
    np.testing.assert_array_equal(
        camera.unproject(wide[::2, 3:5])[0], camera.unproject(wide[::2, 3:5].astype(float).copy())[0]
    )


def test_the_search_in_a_disk_takes_a_few_steps_and_ends_on_a_fold_too():
    calls = []

    def formula(c, a, b, xp):
        calls.append(None)
        return brown.distorted(c, a, b, xp)

    camera = Camera("pinhole", SIZE, {"fx": 500, "fy": 500, "k1": -0.3, "p1": 1e-3, "p2": -8e-4})
    c = SimpleNamespace(**camera.constants)
    angle = np.linspace(0, 6, 200)
    for radius, most_calls in ((0.6 * c.max_radius, 9), (c.max_radius, 60)):
        point = radius * np.cos(angle), radius * np.sin(angle)
        target = brown.distorted(c, *point, NUMPY)
        calls.clear()
        *found, reached = invert_in_disk(formula, c, *target, c.max_radius, c.reach, NUMPY)
        assert reached.all()
        np.testing.assert_allclose(found, point, rtol=0, atol=1e-9)
        assert len(calls) <= most_calls


@settings(max_examples=60)
@given(st.floats(-3, 3), st.floats(1e-6, 5), st.floats(0, 1), st.floats(0, 1))
def test_invert_monotone_finds_the_root_from_any_start(bend, slope, place, start):
    def function(x):
        return slope * x + np.arctan(50 * (x - bend)), slope + 50 / (1 + 2500 * (x - bend) ** 2)

    low, high = -4.0, 4.0
    x = np.array([low + (high - low) * place])
    target = function(x)[0]
    found = invert_monotone(function, target, low, high, np.array([low + (high - low) * start]), NUMPY)
    np.testing.assert_allclose(function(found)[0], target, rtol=1e-13, atol=1e-13)


def test_invert_monotone_gives_the_nearer_end_for_a_target_beyond():
    def function(x):
        return x**3 + x, 3 * x**2 + 1

    target = np.array([-100.0, 100.0])
    found = invert_monotone(function, target, -1.0, 2.0, np.zeros(2), NUMPY)
    np.testing.assert_allclose(found, [-1, 2], rtol=1e-14)


def test_a_point_comes_out_the_same_beside_others_that_take_longer():
    params = {"fx": 500, "fy": 500, "cx": 640, "cy": 480, "xi": 1.2, "k1": -0.3, "p1": 1e-3, "p2": -8e-4}
    camera = Camera("unified", SIZE, params)
    pixels = np.stack(np.meshgrid(np.linspace(0, 1279, 40), np.linspace(0, 959, 30)), axis=-1).reshape(-1, 2)
    rays, seen = camera.unproject(pixels)
    assert 0 < seen.mean() < 1  # those beyond the edge are looked for to the last step
    for some in (pixels[::97], pixels[seen][::50]):
        alone = np.concatenate([camera.unproject(pixel[None])[0] for pixel in some])
        together = rays[[np.flatnonzero((pixels == pixel).all(axis=1))[0] for pixel in some]]
        np.testing.assert_array_equal(alone, together)
