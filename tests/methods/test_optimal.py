"""optimal: exact derivatives, the least that an independent solver finds, and nobody below it."""

import numpy as np
import pytest
from rectbench_methods.scan_lines._free_form import Columns, FreeForm, Intervals, Rows
from rectbench_methods.scan_lines._log_energy import WeightedPixels
from rectbench_methods.scan_lines._stretch_energies import ENERGIES, StretchEnergy
from rectbench_methods.scan_lines.optimal import Optimal, fitted, served
from scipy.optimize import approx_fprime, minimize

import rectbench as rb
from rectbench.metrics.distortion import distortion_of
from rectbench.plugins.rectifier import pose_problem
from rectbench.warps.jacobians import Jacobians, LogStretches
from tests.rigs_for_tests import aligned_rig, points_before, rig

method = Optimal()
OBJECTIVES = sorted(ENERGIES)


def energy_of(problem: rb.Problem, objective: str, count: int = 500) -> StretchEnergy:
    pixels = (rb.evaluation_pixels(camera, count) for camera in (problem.rig.left, problem.rig.right))
    left, right = (WeightedPixels(px, np.ones(len(px))) for px in pixels)
    return StretchEnergy(objective, problem.angle_warps(), left, right)


def form_of(
    problem: rb.Problem,
    energy: StretchEnergy,
    intervals: int,
    columns: Columns = "full",
    rows: Rows = "shared",
) -> FreeForm:
    both = Intervals(intervals, 4 * intervals)
    focal = rb.centre_resolution_px(problem.rig)
    return FreeForm(energy, rb.view_angles(problem.rig), both, focal, columns, rows)


def somewhere(form: FreeForm, seed: int = 0) -> np.ndarray:
    return form.even() + np.random.default_rng(seed).normal(0, 0.3, form.count)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_energies_are_the_metrics_of_any_map(objective: str) -> None:
    problem = pose_problem(rig("unified", (3, -9, 5)))
    energy = energy_of(problem, objective)
    form = form_of(problem, energy, 2)
    z = somewhere(form)
    values, _, _ = energy(form.x(z))
    surfaces, v = form.surfaces(z), form.profiles(z)[0]
    rect = rb.Rectification.from_targets(problem.rig, *(rb.ScanLines(u, v) for u in surfaces), (100, 100))
    assert values.sum() == pytest.approx(energy.of_rectification(rect), rel=1e-9)
    jacobians = Jacobians.at(rect)
    if objective == "L":
        assert values.sum() == pytest.approx(float(distortion_of(jacobians)), rel=1e-9)
    else:
        found = LogStretches.of(jacobians.both)
        mean = found.size.mean()
        assert values.sum() == pytest.approx(found.distortion()[0] ** 2 + mean**2, rel=1e-9)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("columns", "rows"), [("full", "shared"), ("separable", "per-image")])
def test_the_derivatives_are_the_differences(objective: str, columns: Columns, rows: Rows) -> None:
    problem = pose_problem(rig("double-sphere", (3, -9, 5)))
    form = form_of(problem, energy_of(problem, objective, 60), 1, columns, rows)
    z, held = somewhere(form), form.even()
    _, gradient, hessian = form.derivatives(z, held)
    slopes = approx_fprime(z, lambda at: form.value(at, held), 1e-7)
    np.testing.assert_allclose(gradient, slopes, rtol=1e-4, atol=1e-5 * np.abs(slopes).max())
    curvatures = approx_fprime(z, lambda at: form.derivatives(at, held)[1], 1e-7)
    np.testing.assert_allclose(hessian, curvatures, rtol=1e-4, atol=1e-5 * np.abs(curvatures).max())


def test_where_the_image_is_nowhere_squeezed_the_derivatives_are_finite_and_true() -> None:
    for above in (0.0, 1e-8, 1e-6, 2e-6, 1e-3):
        P, R, S = np.full(1, 2 * (1 + above)), np.zeros(1), np.full(1, 2.0)
        value, first, second = ENERGIES["log"](P, P, R, S)
        assert value[0] == pytest.approx((np.log(2) ** 2 + np.arccosh(1 + above) ** 2) / 4, rel=1e-9)
        beyond = ENERGIES["log"](P + 1e-3, P + 1e-3, R, S)[1]
        np.testing.assert_allclose(beyond - first, second[:, :2].sum(axis=1) * 1e-3, rtol=2e-3, atol=1e-7)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_an_independent_solver_finds_no_less(objective: str) -> None:
    problem = pose_problem(rig("equisolid", size=(200, 160)))
    form = form_of(problem, energy_of(problem, objective, 80), 1)
    found = form.least(form.even())
    other = minimize(form.value, somewhere(form, 3), (form.even(),), "BFGS", options={"maxiter": 200})
    assert (1 - 1e-6) * found.energy < other.fun < 1.02 * found.energy


@pytest.mark.parametrize("columns", ["full", "separable"])
def test_finer_splines_hold_the_coarse_ones_exactly(columns: Columns) -> None:
    problem = pose_problem(rig("kannala-brandt", (2, -5, 3)))
    energy = energy_of(problem, "log")
    coarse, fine = form_of(problem, energy, 2, columns), form_of(problem, energy, 4)
    z = somewhere(coarse)
    np.testing.assert_allclose(fine.x(coarse.refined(z, fine)), coarse.x(z), rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("model", ["equidistant", "unified"])
def test_no_other_map_to_scan_lines_has_less(model: str, objective: str) -> None:
    problem = pose_problem(rig(model, size=(320, 320), fov_deg=95))
    rect = method.fit(problem, method.Options(objective=objective))
    warps = problem.angle_warps()
    pixels = (problem.pixels_left, problem.pixels_right)
    energy = StretchEnergy(objective, warps, *(fitted(w, px) for w, px in zip(warps, pixels, strict=True)))
    least = energy.of_rectification(rect)
    rivals = dict(served(problem))
    assert len(rivals) == 10
    assert all(least < energy.of_rectification(rival) for rival in rivals.values())


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [("aligned", 0.0510, 0.0516), ("sony-as200v", 0.0190, 0.0195), ("t265", 0.2, 0.214)],
)
def test_its_L_is_that_of_an_independent_free_form(name: str, low: float, high: float) -> None:
    pair = aligned_rig(1920, 1080, 135) if name == "aligned" else rb.load_rig(name)
    rect = rb.rectify(pair, "optimal", objective="L")
    trimmed = pose_problem(pair)
    assert low < energy_of(trimmed, "L", 20_000).of_rectification(rect) < high
    assert "warning" not in rect.notes


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_what_the_fit_gains_it_gains_at_other_pixels_too(objective: str) -> None:
    problem = pose_problem(rb.load_rig("t265"))
    rect = method.fit(problem, method.Options(objective=objective))
    energy = energy_of(problem, objective, 16_000)
    form = form_of(problem, energy, int(rect.notes["intervals"]))
    coarse = form_of(problem, energy, 4)
    best = form.least(coarse.refined(coarse.least(coarse.even()).z, form)).energy
    root = 0.5 if objective == "log" else 1.0
    assert (energy.of_rectification(rect) / best) ** root < 1.005


def test_of_parallel_pinholes_nothing_is_distorted() -> None:
    lens = rb.Camera("pinhole", (320, 240), {"fx": 250.0, "fy": 250.0, "cx": 159.5, "cy": 119.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]), name="parallel")
    rect = rb.rectify(pair, "optimal")
    assert rect.notes["distortion"] < 1e-9
    assert rect.notes["taken_from"] == "conventional"


def test_rows_agree_and_what_is_far_has_about_no_disparity() -> None:
    pair = rig("field-of-view", (2, -6, 3), (0.1, 0.08, 0.02))
    rect = rb.rectify(pair, "optimal")
    _, px_left, px_right = points_before(pair, 200)
    assert rb.metrics.row_error(rect, px_left, px_right).columns()["row_error_max_px"] < 1e-6
    rays = pair.left.unproject(px_left)[0] @ pair.R_right_left.T
    seen = pair.right.sees(rays)
    far = rect.right.forward(pair.right.project(rays[seen])[0])
    assert abs(np.median(rect.left.forward(px_left[seen]) - far, axis=0)).max() < 1.0


def test_rows_go_around_an_epipole_in_the_view() -> None:
    lens = rb.load_rig("t265").scaled(0.25).left
    ahead = rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0.0, -0.3]), name="ahead")
    rect, other = rb.rectify(ahead, "optimal"), rb.rectify(ahead, "polar-optimal")
    assert rect.turn_px is not None
    view = rb.ScoredView.of(ahead)
    least, above = (rb.Delivered.of(r, view).log_distortion(1.0) for r in (rect, other))
    assert least < 1.005 * above  # of a lens that looks along the baseline the floor is separable


def test_given_pixels_are_the_ones_that_count() -> None:
    pair = rig("equisolid")
    corner = np.stack(np.meshgrid(np.arange(5.0, 150, 5), np.arange(5.0, 100, 5)), -1).reshape(-1, 2)
    there, usual = (rb.rectify(pair, "optimal", pixels=px) for px in (corner, None))

    def at_corner(rect: rb.Rectification) -> float:
        J = np.concatenate([rect.left.jacobian(corner), rect.right.jacobian(corner)])
        return LogStretches.of(J).distortion()[0]

    assert at_corner(there) < 0.9 * at_corner(usual)
