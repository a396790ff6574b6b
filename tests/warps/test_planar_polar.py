"""Polar coordinates of an image plane: lengths, logarithms, and epipoles from the image to infinity."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.formulas.evaluation import KERNEL_THRESHOLD

K = np.array([[500.0, 0.0, 320.0], [0.0, 510.0, 240.0], [0.0, 0.0, 1.0]])
ROWS = rb.Radial("equidistant", 300.0, 5.0)
CORNER = (-0.5, -0.5)

turns = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
sizes_rad = st.sampled_from([0.0, 1e-12, 1e-8, 1e-4, 0.1, 1.0, 3.0])


def plane(rotvec: np.ndarray) -> np.ndarray:
    return K @ Rotation.from_rotvec(rotvec).as_matrix()


def pixels_of(matrix: np.ndarray, rays: np.ndarray) -> np.ndarray:
    projected = rays @ matrix.T
    return projected[..., :2] / projected[..., 2:]


def rays_of(matrix: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    rays = np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(matrix).T
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


@pytest.mark.parametrize("along", ["length", "logarithm"])
@given(turns, sizes_rad)
def test_every_pixel_comes_back_wherever_the_epipole_is(
    along: str, turn: tuple[float, float, float], size_rad: float
) -> None:
    matrix = plane(size_rad * np.array(turn))
    target = rb.PlanarPolar(matrix, CORNER, ROWS, along, 3.0)
    pixels = np.random.default_rng(0).uniform([0, 0], [640, 480], (200, 2))
    mapped, shown = target.project(rays_of(matrix, pixels))
    assert shown.all()
    back, ok = target.unproject(mapped)
    assert ok.all()
    np.testing.assert_allclose(pixels_of(matrix, back), pixels, atol=1e-8)


@given(turns)
def test_lengths_along_lines_are_kept_and_rise_towards_the_epipole(turn: tuple[float, float, float]) -> None:
    matrix = plane(np.array([0.0, -1.2, 0.0]) + 0.3 * np.array(turn))
    epipole = matrix[:2, 0] / matrix[2, 0]
    pixels = np.random.default_rng(1).uniform([0, 0], [640, 480], (200, 2))
    u = rb.PlanarPolar(matrix, CORNER, ROWS).project(rays_of(matrix, pixels))[0][:, 0]
    radius = np.linalg.norm(pixels - epipole, axis=1) - np.linalg.norm(np.array(CORNER) - epipole)
    np.testing.assert_allclose(u, -np.sign(matrix[2, 0]) * radius, atol=1e-7)


def test_logarithms_are_of_the_radius_and_agree_with_lengths_at_the_reference() -> None:
    matrix = plane(np.array([0.0, -1.4, 0.1]))
    epipole = matrix[:2, 0] / matrix[2, 0]
    pixels = np.random.default_rng(2).uniform([0, 0], [640, 480], (50, 2))
    u = rb.PlanarPolar(matrix, CORNER, ROWS, "logarithm").project(rays_of(matrix, pixels))[0][:, 0]
    reach = np.linalg.norm(np.array(CORNER) - epipole)
    expected = -reach * np.log(np.linalg.norm(pixels - epipole, axis=1) / reach)
    np.testing.assert_allclose(u, expected, rtol=1e-12)


def test_an_epipole_at_infinity_is_the_limit_of_far_ones() -> None:
    pixels = np.random.default_rng(3).uniform([0, 0], [640, 480], (50, 2))
    at_infinity = plane(np.zeros(3))
    far = plane(np.array([0.0, -1e-9, 0.0]))
    for along in ("length", "logarithm"):
        near_limit, limit = (
            rb.PlanarPolar(matrix, CORNER, ROWS, along).project(rays_of(matrix, pixels))[0]
            for matrix in (far, at_infinity)
        )
        np.testing.assert_allclose(near_limit, limit, atol=1e-3)
        np.testing.assert_allclose(limit[:, 0], pixels[:, 0] + 0.5, atol=1e-9)


def test_tables_hold_what_the_formula_says() -> None:
    matrix = plane(np.array([0.1, -1.3, 0.2]))
    lens = rb.Camera("pinhole", (640, 480), {"fx": 500, "fy": 510, "cx": 320, "cy": 240})
    R_rect_cam = Rotation.from_rotvec([0.1, -1.3, 0.2]).as_matrix().T
    for along in ("length", "logarithm"):
        warp = rb.Warp(lens, R_rect_cam, rb.PlanarPolar(matrix, CORNER, ROWS, along, 500.0))
        rect = rb.Rectification(rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0])), warp, warp, (200, 150))
        assert KERNEL_THRESHOLD < 200 * 150
        map_x, map_y = rect.maps("left")
        grid = np.stack(np.meshgrid(np.arange(200.0), np.arange(150.0)), axis=-1)
        expected = warp.inverse(grid)
        seen = np.isfinite(expected).all(axis=-1)
        assert seen.any()
        np.testing.assert_allclose(np.stack([map_x, map_y], axis=-1)[seen], expected[seen], atol=1e-3)
        assert (map_x[~seen] == -16).all()


def test_nothing_behind_the_plane_or_past_the_epipole_is_shown() -> None:
    matrix = plane(np.array([0.0, -1.4, 0.0]))
    target = rb.PlanarPolar(matrix, CORNER, ROWS)
    behind = -rays_of(matrix, np.array([[300.0, 200.0]]))
    assert not target.project(behind)[1].any()
    epipole = matrix[:2, 0] / matrix[2, 0]
    past = np.linalg.norm(np.array(CORNER) - epipole) + 1.0
    assert not target.unproject([past, 5.0])[1]


def test_what_makes_no_pencil_is_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="invertible 3x3"):
        rb.PlanarPolar(np.zeros((3, 3)), CORNER, ROWS)
    with pytest.raises(rb.InvalidInput, match="expected length or logarithm"):
        rb.PlanarPolar(K, CORNER, ROWS, "area")  # type: ignore[arg-type]
    ahead = K @ np.array([[0.0, 0, -1], [0, 1, 0], [1, 0, 0]])
    with pytest.raises(rb.InvalidInput, match="is the epipole"):
        rb.PlanarPolar(ahead, (320.0, 240.0), ROWS)
