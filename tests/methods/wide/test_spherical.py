"""spherical: meridians through the epipoles are rows, evenly spaced, and evenly divided."""

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import rig


@pytest.mark.parametrize(("grid", "along"), [("square", 1.0), ("equiangular", 2.0)])
def test_rows_are_longitudes_about_the_epipoles_and_columns_colatitudes(grid: str, along: float) -> None:
    pair = rig("kannala-brandt")
    rect = rb.rectify(pair, "spherical", grid=grid, focal_px=100.0)
    epipole = pair.centre_right_in_left / pair.baseline_m
    pixels = rb.evaluation_pixels(pair.left, 100)
    rays = pair.left.unproject(pixels)[0]
    colatitudes = np.arccos(rays @ -epipole)
    around = np.cross(rays, epipole)
    angles = np.arctan2(np.cross(around[0], around) @ -epipole, around @ around[0])  # about the baseline
    u, v = rect.left.forward(pixels).T
    np.testing.assert_allclose(u - u[0], 100 * along * (colatitudes - colatitudes[0]), atol=1e-7)
    np.testing.assert_allclose(v - v[0], 100 * angles, atol=1e-7)


def test_a_square_grid_is_abrahams_equidistant_map() -> None:
    pair = rig()
    ours, theirs = rb.rectify(pair, "spherical"), rb.rectify(pair, "abraham")
    np.testing.assert_array_equal(ours.maps("right"), theirs.maps("right"))
