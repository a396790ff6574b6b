"""Scaramuzza's model in OCamCalib's frame, with the numbers of a real calibration."""

import math

import numpy as np
import pytest

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from tests.cameras.random_cameras import angle_between, ray

# calib_results_0.txt of matsuren/ocamcalib_undistort (MIT), 1600x1600.
POLY = (-4.714441e02, 0.0, 7.356108e-04, -3.773045e-07, 5.800006e-10)
INVERSE_POLY = (
    772.405470,
    504.754051,
    7.034666,
    45.327180,
    54.651570,
    0.458049,
    -7.873745,
    15.588713,
    13.743404,
    2.968883,
)
ROW, COLUMN = 794.308657, 798.175741
C, D, E = 1.000305, -0.000277, -0.000925
AFFINE = {"cx": COLUMN, "cy": ROW, "c": C, "d": D, "e": E}
EXACT = Camera("ocam", (1600, 1600), {**AFFINE, "poly": POLY, "inverse_poly": INVERSE_POLY})
FITTED = Camera("ocam", (1600, 1600), {**AFFINE, "inverse_poly": INVERSE_POLY})


def world2cam(x: float, y: float, z: float) -> tuple[float, float]:
    """(row, column) of a point in OCamCalib's frame, as its C code computes it."""
    norm = math.hypot(x, y)
    theta = math.atan(z / norm)
    rho = sum(b * theta**i for i, b in enumerate(INVERSE_POLY))
    x, y = x / norm * rho, y / norm * rho
    return x * C + y * D + ROW, x * E + y + COLUMN


def cam2world(row: float, column: float) -> np.ndarray:
    """Unit vector in OCamCalib's frame of a pixel, as its C code computes it."""
    inverse_determinant = 1 / (C - D * E)
    x = inverse_determinant * ((row - ROW) - D * (column - COLUMN))
    y = inverse_determinant * (-E * (row - ROW) + C * (column - COLUMN))
    rho = math.hypot(x, y)
    vector = np.array([x, y, sum(a * rho**i for i, a in enumerate(POLY))])
    return vector / np.linalg.norm(vector)


PIXELS = np.stack(np.meshgrid(np.linspace(100, 1500, 15), np.linspace(100, 1500, 15)), axis=-1).reshape(-1, 2)


def test_unproject_is_cam2world_in_our_axes():
    expected = [cam2world(v, u) for u, v in PIXELS]
    expected = np.array([(y, x, -z) for x, y, z in expected])
    np.testing.assert_allclose(EXACT.unproject(PIXELS)[0], expected, rtol=0, atol=1e-13)


def test_the_fitted_inverse_is_world2cam_in_our_axes():
    theta = np.radians([0.05, 1, 30, 60, 89.9, 92])
    rays = ray(theta[:, None], np.linspace(0, 6, 8)).reshape(-1, 3)
    expected = np.array([world2cam(y, x, -z)[::-1] for x, y, z in rays])
    np.testing.assert_allclose(FITTED.project(rays)[0], expected, rtol=0, atol=1e-8)


def test_the_polynomial_and_its_own_fitted_inverse_agree_to_a_hundredth_of_a_pixel():
    rays, known = EXACT.unproject(PIXELS)
    assert known.all()
    difference = np.abs(FITTED.project(rays)[0] - EXACT.project(rays)[0])
    assert 1e-4 < difference.max() < 0.01


def test_a_fitted_inverse_that_misses_the_centre_has_no_hole_there():
    assert abs(sum(b * (-math.pi / 2) ** i for i, b in enumerate(INVERSE_POLY))) > 0.005  # px at θ = 0
    centre, seen = FITTED.project([0, 0, 1.0])
    assert seen
    np.testing.assert_allclose(centre, [COLUMN, ROW], rtol=0, atol=1e-12)
    pixels = np.array([COLUMN, ROW]) + np.geomspace(1e-9, 1, 30)[:, None] * [0.6, -0.8]
    rays, known = FITTED.unproject(pixels)
    assert known.all()
    assert (np.diff(np.arctan2(np.hypot(rays[:, 0], rays[:, 1]), rays[:, 2])) > 0).all()
    np.testing.assert_allclose(FITTED.project(rays)[0], pixels, rtol=0, atol=1e-9)
    # The fit itself is negative within 1.2e-5 rad of the axis, which would mirror these rays.
    right = FITTED.project(ray(np.geomspace(1e-12, 1e-3, 40), 0.0))[0][:, 0] - COLUMN
    assert (right >= 0).all()
    assert (np.diff(right[10:]) > 0).all()


def test_the_sign_of_a0_only_turns_the_axis_of_the_source():
    matlab = Camera("ocam", (1600, 1600), {**AFFINE, "poly": [-a for a in POLY]})
    np.testing.assert_array_equal(matlab.unproject(PIXELS)[0], EXACT.unproject(PIXELS)[0])
    assert (EXACT.unproject([[COLUMN, ROW], [COLUMN + 300, ROW]])[0][:, 2] > 0).all()


def test_the_real_lens_sees_past_90_degrees():
    pixel = np.array([COLUMN + 790, ROW])
    bearing, known = EXACT.unproject(pixel)
    assert known
    assert bearing[2] < 0
    np.testing.assert_allclose(EXACT.project(bearing)[0], pixel, rtol=0, atol=1e-9)


def test_left_out_affine_parameters_mean_square_pixels():
    camera = Camera("ocam", (1600, 1600), {"cx": COLUMN, "cy": ROW, "poly": POLY})
    assert (camera.params["c"], camera.params["d"], camera.params["e"]) == (1.0, 0.0, 0.0)
    right, down = camera.project([[1.0, 0, 1], [0, 1.0, 1]])[0] - [COLUMN, ROW]
    np.testing.assert_allclose(right, down[::-1], atol=1e-9)


def test_a_linear_term_is_part_of_the_model():
    camera = Camera("ocam", (800, 600), {"cx": 400, "cy": 300, "poly": [-200, 0.1, 1e-3]})
    pixel = np.array([400 + 60.0, 300 + 80])
    expected = np.array([60, 80, 200 - 0.1 * 100 - 1e-3 * 100**2])
    np.testing.assert_allclose(
        camera.unproject(pixel)[0], expected / np.linalg.norm(expected), rtol=0, atol=1e-14
    )


def test_the_domain_ends_where_the_angle_stops_rising_with_the_radius():
    # z = 200 - 1e-3 ρ² + 4e-6 ρ³: θ rises while 200 + 1e-3 ρ² - 8e-6 ρ³ > 0.
    camera = Camera("ocam", (800, 600), {"cx": 400, "cy": 300, "poly": [200, 0, -1e-3, 4e-6]})
    fold = max(np.roots([-8e-6, 1e-3, 0, 200]).real)
    assert camera.unproject([400 + fold * (1 - 1e-4), 300])[1]
    assert not camera.unproject([400 + fold * (1 + 1e-9), 300])[1]
    theta = math.atan2(fold, 200 - 1e-3 * fold**2 + 4e-6 * fold**3)
    inside, outside = ray(np.array([theta - 1e-4, theta + 1e-4]), np.zeros(2))
    pixel, seen = camera.project(inside)
    assert seen
    assert angle_between(camera.unproject(pixel)[0], inside) < 1e-9
    assert not camera.project(outside)[1]


def test_two_radii_that_newton_steps_call_in_turn_do_not_hold_up_the_search():
    poly = (254.56781383768674, 0.0, -0.0029164910565134734, -3.921286791800707e-06, 1.4176320756669279e-08)
    camera = Camera("ocam", (1600, 1200), {"cx": 874.3, "cy": 389.3, "poly": poly})
    bearing = np.array([0.18582545, 0.9820952, -0.03095045])
    bearing /= np.linalg.norm(bearing)
    pixel, seen = camera.project(bearing)
    assert seen
    assert angle_between(camera.unproject(pixel)[0], bearing) < 1e-9


@pytest.mark.parametrize(
    ("params", "message"),
    [
        ({}, "lacks poly and inverse_poly"),
        ({"poly": (), "inverse_poly": ()}, "lacks poly and inverse_poly"),
        ({"poly": -470.0}, "poly = -470.0; expected a list"),
        ({"poly": [0.0, 1.0]}, "a0 = 0"),
        ({"poly": [-470, math.nan]}, "list of finite numbers"),
        ({"poly": POLY, "c": 0.0}, "c - d e = 0"),
        ({"poly": POLY, "fx": 300.0}, "parameter of ocam 'fx'"),
        ({"inverse_poly": [772.0, 900.0]}, "px at the axis"),
        ({"inverse_poly": [772.0]}, "px at the axis"),
    ],
)
def test_bad_parameters_are_named(params, message):
    with pytest.raises(InvalidInput, match=message):
        Camera("ocam", (1600, 1600), params)
