"""polar-optimal: exact derivatives, a convex energy, a closed form, and nobody of its kind below it."""

import numpy as np
import pytest
from rectbench_methods.scan_lines._log_energy import LogEnergy, Splines, WeightedPixels
from rectbench_methods.scan_lines.polar_optimal import PolarOptimal, fitted
from scipy.optimize import approx_fprime

import rectbench as rb
from rectbench.plugins.rectifier import pose_problem
from rectbench.warps.jacobians import LogStretches
from tests.rigs_for_tests import LENSES, points_before, rig

method = PolarOptimal()
SEPARABLE = ("abraham", "local-homography", "log-polar", "polar")
MOTIONS = {
    "sideways": (0.12, 0.006, -0.004),
    "diagonal": (0.1, 0.08, 0.02),
    "vertical": (0.004, 0.12, 0.003),
}


def energy_of(problem: rb.Problem) -> LogEnergy:
    return LogEnergy(problem.angle_warps(), *map(equal, (problem.pixels_left, problem.pixels_right)))


def equal(pixels: np.ndarray) -> WeightedPixels:
    return WeightedPixels(pixels, np.ones(len(pixels)))


def ahead(max_angle_deg: float = 60.0, size: int = 401) -> rb.Rig:
    """One equidistant camera before the other, with an image circle about the epipole."""
    middle = (size - 1) / 2
    focal = middle / np.radians(max_angle_deg)
    params = {"fx": focal, "fy": focal, "cx": middle, "cy": middle}
    lens = rb.Camera("equidistant", (size, size), params, max_angle_deg)
    return rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0.0, -0.3]), name="ahead")


def log_distortion_at(rect: rb.Rectification, left: np.ndarray, right: np.ndarray) -> float:
    J = np.concatenate([rect.left.jacobian(left), rect.right.jacobian(right)])
    return LogStretches.of(J).distortion()[0]


@pytest.mark.parametrize("model", ["equisolid", "unified"])
def test_the_energy_is_the_log_distortion_whatever_the_slopes(model: str) -> None:
    problem = pose_problem(rig(model))
    rect = rb.rectify(problem.rig, method="local-homography")
    energy = energy_of(problem)
    columns = rect.left.target.u, rect.right.target.u, rect.left.target.v
    step = 1e-5
    angles = energy.gamma_left, energy.gamma_right, energy.beta
    slopes = [(f(a + step) - f(a - step)) / (2 * step) for f, a in zip(columns, angles, strict=True)]
    p, q = np.log(np.concatenate(slopes[:2])), np.log(slopes[2])
    p, q = p - (m := float((p + q + energy.log_area).mean()) / 2), q - m
    expected = log_distortion_at(rect, problem.pixels_left, problem.pixels_right)
    assert energy(p, q)[0] == pytest.approx(expected**2, rel=1e-6)


def test_the_energys_derivatives_are_its_differences() -> None:
    energy = energy_of(pose_problem(rig("kannala-brandt", (3, -9, 5), MOTIONS["diagonal"])))
    rng = np.random.default_rng(0)
    p, q = rng.normal(5, 1, (2, len(energy.beta)))
    _, gradient, second = energy(p, q)
    for place in (0, 7, len(energy.beta) - 1):
        step = 1e-5 * np.eye(len(energy.beta))[place]
        for axis, (dp, dq) in enumerate([(step, 0 * step), (0 * step, step)]):
            (up, upward, _), (down, downward, _) = energy(p + dp, q + dq), energy(p - dp, q - dq)
            assert gradient[axis, place] == pytest.approx((up - down) / 2e-5, rel=1e-4, abs=1e-9)
            slopes = (upward - downward)[:, place] / 2e-5
            np.testing.assert_allclose(second[axis, :, place], slopes, rtol=1e-5, atol=1e-10)


def test_where_the_image_is_nowhere_squeezed_the_derivatives_are_finite() -> None:
    energy = energy_of(pose_problem(ahead()))
    _, gradient, second = energy(np.zeros(len(energy.beta)), energy.log_ratio)
    assert np.isfinite(gradient).all()
    np.testing.assert_allclose(second[0, 0], 1 / len(energy.beta), rtol=1e-6)


@pytest.mark.parametrize("columns", ["per-image", "shared"])
def test_the_splines_derivatives_are_their_differences(columns: str) -> None:
    problem = pose_problem(rig("double-sphere", (3, -9, 5)))
    splines = Splines(energy_of(problem), rb.view_angles(problem.rig), 3, columns)
    alpha = np.random.default_rng(1).normal(5, 0.5, splines.count)
    assert splines.count == (15 if columns == "per-image" else 10)
    _, gradient = splines.value_and_gradient(alpha)
    slopes = approx_fprime(alpha, lambda a: splines.value_and_gradient(a)[0], 1e-7)
    np.testing.assert_allclose(gradient, slopes, rtol=1e-4, atol=1e-7)
    curvatures = approx_fprime(alpha, lambda a: splines.value_and_gradient(a)[1], 1e-7)
    np.testing.assert_allclose(splines.hessian(alpha), curvatures, rtol=1e-4, atol=1e-7)


@pytest.mark.parametrize("seed", range(5))
def test_the_energy_is_convex_in_the_log_slopes(seed: int) -> None:
    energy = energy_of(pose_problem(rig("unified", (8, -20, 11), MOTIONS["diagonal"])))
    rng = np.random.default_rng(seed)
    one, other = rng.normal(0, 3, (2, 2, len(energy.beta)))
    middle = energy(*(one + other) / 2)[0]
    assert middle <= (energy(*one)[0] + energy(*other)[0]) / 2
    _, _, second = energy(*one)
    assert (np.linalg.eigvalsh(np.moveaxis(second, -1, 0)) >= -1e-15).all()


@pytest.mark.parametrize("model", ["equidistant", "unified"])
def test_any_start_ends_at_the_same_least(model: str) -> None:
    problem = pose_problem(rig(model))
    splines = Splines(energy_of(problem), rb.view_angles(problem.rig), 8, "per-image")
    usual = splines.least(np.full(splines.count, 5.0)).fun
    rng = np.random.default_rng(0)
    for _ in range(4):
        assert splines.least(rng.normal(5, 1.5, splines.count)).fun == pytest.approx(usual, rel=1e-5)


@pytest.mark.parametrize(
    ("model", "motion"),
    [(model, "sideways") for model in sorted(LENSES)]
    + [("unified", "diagonal"), ("double-sphere", "vertical")],
)
def test_no_other_separable_method_has_less_log_distortion(model: str, motion: str) -> None:
    pair = rig(model, centre_m=MOTIONS[motion], size=(320, 320), fov_deg=95)
    left, right = (fitted(camera, rb.evaluation_pixels(camera)).pixels for camera in (pair.left, pair.right))
    rect = method.fit(pose_problem(pair), method.Options())
    least = log_distortion_at(rect, left, right)
    assert least == pytest.approx(rect.notes["log_distortion"], rel=1e-6)
    for other in SEPARABLE:
        assert least < log_distortion_at(rb.rectify(pair, method=other), left, right)


@pytest.mark.parametrize("model", ["kannala-brandt", "double-sphere"])
def test_shared_columns_give_both_images_one_profile_and_cost_no_less(model: str) -> None:
    pair = rig(model, rotation_deg=(2, -5, 3))
    shared, own = (rb.rectify(pair, "polar-optimal", columns=c) for c in ("shared", "per-image"))
    assert shared.left.target.u == shared.right.target.u
    assert own.left.target.u != own.right.target.u
    assert shared.notes["log_distortion"] >= own.notes["log_distortion"]


def test_its_slopes_about_an_epipole_are_the_closed_form() -> None:
    # Of an equidistant lens that looks along the baseline σ_γ = h' / f and σ_β = g' / r over a ring of radii:
    # log distortion is least for h' = f and log g' the mean of log r; its square is half of log r's variance.
    pair = ahead(size=801)
    rect = rb.rectify(pair, "polar-optimal", margin_deg=7.0)
    focal, reach = pair.left.params["fx"], 400.0
    log_r = np.log(np.sqrt(np.linspace((focal * np.radians(7.0)) ** 2, reach**2, 10_000)))
    assert rect.notes["log_distortion"] == pytest.approx(np.sqrt(log_r.var() / 2), rel=0.01)
    gamma = np.radians(np.linspace(40, 85, 10))
    for warp in (rect.left, rect.right):
        u, v = warp.target.target.u, warp.target.target.v
        np.testing.assert_allclose((u(gamma + 1e-4) - u(gamma - 1e-4)) / 2e-4, focal, rtol=0.02)
        beta = np.linspace(-3, 3, 13)
        slope = (v(beta + 1e-4) - v(beta - 1e-4)) / 2e-4
        np.testing.assert_allclose(slope, np.exp(log_r.mean()), rtol=0.02)


def test_what_the_fit_gains_it_gains_at_other_pixels_too() -> None:
    for model in ("unified", "double-sphere"):
        pair = rig(model)
        rect = rb.rectify(pair, "polar-optimal")
        others = [rb.evaluation_pixels(camera, 20_000) for camera in (pair.left, pair.right)]
        energy = LogEnergy(pose_problem(pair).angle_warps(), *map(equal, others))
        best = Splines(energy, rb.view_angles(pair), 32, "per-image")
        floor = best.least(np.full(best.count, np.log(rb.centre_resolution_px(pair)))).fun ** 0.5
        assert log_distortion_at(rect, *others) < 1.005 * floor


def test_given_pixels_are_the_ones_that_count_and_few_make_few_intervals() -> None:
    pair = rig("equisolid")
    corner = np.stack(np.meshgrid(np.arange(5.0, 150, 10), np.arange(5.0, 100, 10)), -1).reshape(-1, 2)
    there, usual = rb.rectify(pair, "polar-optimal", pixels=corner), rb.rectify(pair, "polar-optimal")
    assert there.notes["intervals"] <= 8
    assert log_distortion_at(there, corner, corner) < log_distortion_at(usual, corner, corner)


def test_rows_agree_and_images_have_as_many_pixels_as_their_sources() -> None:
    pair = rig("field-of-view", (2, -6, 3), MOTIONS["diagonal"])
    rect = rb.rectify(pair, "polar-optimal")
    _, px_left, px_right = points_before(pair, 200)
    assert rb.metrics.row_error(rect, px_left, px_right).columns()["row_error_max_px"] < 1e-6
    pixels = rb.evaluation_pixels(pair.left, 3000)
    J = np.concatenate([rect.left.jacobian(pixels), rect.right.jacobian(pixels)])
    assert np.log(np.abs(np.linalg.det(J))).mean() == pytest.approx(0, abs=0.01)
