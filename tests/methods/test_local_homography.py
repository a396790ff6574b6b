"""Local homography: the optimum is the least of what any start reaches, and its slopes stay positive."""

import numpy as np
import pytest
from rectbench_methods.scan_lines._local_energy import Energy, Law
from rectbench_methods.scan_lines.local_homography import LocalHomography
from scipy.optimize import minimize

import rectbench as rb
from rectbench.plugins.rectifier import pose_problem
from tests.rigs_for_tests import LENSES, aligned_rig, rig

method = LocalHomography()
LAWS = ("equidistant", "stereographic", "equisolid", "orthographic", "cylindrical")


def energy_of(problem: rb.Problem, law: str = "equidistant") -> Energy:
    return Energy(problem, Law(law, rb.view_angles(problem.rig)), (0.5, 0.5))


@pytest.mark.parametrize("model", sorted(LENSES))
def test_the_fit_reaches_the_least_of_what_random_starts_reach(model: str) -> None:
    pair = rig(model)
    problem = pose_problem(pair)
    focal = rb.centre_resolution_px(pair)
    energy = energy_of(problem)
    rect = method.fit(problem, method.Options())
    rng = np.random.default_rng(0)
    for _ in range(8):
        start = np.tile([1.0, 0, 0], 3) * rng.uniform(0.3, 2, 9) + rng.normal(0, 0.2, 9)
        other = minimize(lambda c: energy(c * focal)[0], start, method="BFGS")
        assert rect.notes["energy"] <= other.fun * (1 + 1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_the_energy_is_the_distortion_metric(law: str) -> None:
    pair = rig("double-sphere")
    rect = rb.rectify(pair, model=law)
    assert rb.metrics.distortion(rect, pair) == pytest.approx(rect.notes["energy"], rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_the_energys_gradient_is_its_derivative(law: str) -> None:
    pair = rig("kannala-brandt")
    energy = energy_of(pose_problem(pair), law)
    c = np.tile([220.0, 15, -9], 3) * np.linspace(0.9, 1.1, 9)
    _, gradient = energy(c)
    step = 1e-4
    for i, d in enumerate(np.eye(9) * step):
        difference = (energy(c + d)[0] - energy(c - d)[0]) / (2 * step)
        assert gradient[i] == pytest.approx(difference, rel=1e-5, abs=1e-9)


def test_no_scaling_of_the_result_lowers_its_distortion() -> None:
    pair = rig("equisolid")
    rect = rb.rectify(pair)
    native = rb.metrics.distortion(rect, pair)
    assert rb.metrics.distortion(rect, pair, protocol="stretched") == pytest.approx(float(native), rel=1e-6)


def test_it_beats_abraham_under_every_protocol() -> None:
    for model in sorted(LENSES):
        pair = rig(model)
        ours, theirs = rb.rectify(pair), rb.rectify(pair, method="abraham")
        for protocol in ("native", "rescaled", "stretched"):
            assert rb.metrics.distortion(ours, pair, protocol=protocol) <= rb.metrics.distortion(
                theirs, pair, protocol=protocol
            )


def test_shared_columns_give_both_images_one_profile_and_cost_no_less() -> None:
    pair = rig("kannala-brandt", rotation_deg=(2, -5, 3))
    shared, own = rb.rectify(pair, columns="shared"), rb.rectify(pair)
    assert shared.left.target.u == shared.right.target.u
    assert own.left.target.u != own.right.target.u
    assert shared.notes["energy"] >= own.notes["energy"]


def test_the_constraint_holds_where_it_binds() -> None:
    # All weight on the aspect ratio near the epipoles pulls the slope of û down to its bound.
    pair = aligned_rig(400, 400, 178, max_angle_deg=89)
    rect = rb.rectify(pair, alpha_ratio=50.0, alpha_skew=50.0)
    for profile in (rect.left.target.u, rect.left.target.v):
        theta = np.linspace(profile.low, profile.high, 500)
        assert (np.diff(profile(theta)) > 0).all()


def test_other_pixels_are_minimised_where_given() -> None:
    pair = rig()
    corner = np.stack(np.meshgrid(np.arange(5.0, 150, 10), np.arange(5.0, 100, 10)), -1).reshape(-1, 2)
    there = rb.rectify(pair, pixels=corner)
    usual = rb.rectify(pair)
    assert rb.metrics.distortion(there, pair, pixels=corner) < rb.metrics.distortion(
        usual, pair, pixels=corner
    )
    assert rb.metrics.distortion(there, pair) > rb.metrics.distortion(usual, pair)


def test_pixels_that_a_lens_does_not_see_are_left_out() -> None:
    pair = aligned_rig(400, 400, 170, max_angle_deg=85)
    pixels = np.stack(np.meshgrid(np.arange(0.0, 400, 20), np.arange(0.0, 400, 20)), -1).reshape(-1, 2)
    seen = pixels[pair.left.unproject(pixels)[1]]
    assert len(seen) < len(pixels)
    everywhere, masked = rb.rectify(pair, pixels=pixels), rb.rectify(pair, pixels=seen)
    np.testing.assert_array_equal(everywhere.maps("left"), masked.maps("left"))
    with pytest.raises(rb.InvalidInput, match="sees none of the 1 pixels"):
        rb.rectify(pair, pixels=[[0.0, 0.0]])


@pytest.mark.parametrize("law", LAWS)
def test_each_model_is_a_cubic_of_its_f_and_rises(law: str) -> None:
    rect = rb.rectify(rig("equisolid"), model=law)
    f = {
        "equidistant": lambda a: a,
        "stereographic": lambda a: 2 * np.tan(a / 2),
        "equisolid": lambda a: 2 * np.sin(a / 2),
        "orthographic": np.sin,
        "cylindrical": np.tan,
    }[law]
    for profile in (rect.left.target.u, rect.right.target.u, rect.left.target.v):
        theta = np.linspace(profile.low, profile.high, 400)
        fitted = np.polynomial.Polynomial.fit(f(theta), profile(theta), 3)
        np.testing.assert_allclose(fitted(f(theta)), profile(theta), atol=1e-7)
        assert (np.diff(profile(theta)) > 0).all()


@pytest.mark.parametrize("law", ["stereographic", "equisolid"])
def test_a_model_is_at_its_least(law: str) -> None:
    pair = rig("kannala-brandt")
    problem, focal = pose_problem(pair), rb.centre_resolution_px(pair)
    energy = energy_of(problem, law)
    least = method.fit(problem, method.Options(model=law)).notes["energy"]
    found = minimize(lambda c: energy(c * focal)[0], np.tile([1.0, 0, 0], 3), method="BFGS")
    assert least <= found.fun * (1 + 1e-6)


def test_a_model_that_ends_before_the_view_is_refused_with_the_angle() -> None:
    wide = aligned_rig(400, 400, 182, max_angle_deg=90.6)
    with pytest.raises(rb.Unsupported, match=r"model=cylindrical ends at 90 degrees; the view reaches 94\.9"):
        rb.rectify(wide, model="cylindrical")


def test_a_polynomial_inverse_is_the_map_and_tells_how_far_off_it_is() -> None:
    pair = rig("equidistant")
    exact, fitted = rb.rectify(pair), rb.rectify(pair, inverse="polynomial", inverse_degree=5)
    pixels = rb.evaluation_pixels(pair.left, 4000)
    off = np.abs(exact.left.forward(pixels) - fitted.left.forward(pixels))
    for place, axis in enumerate("uv"):
        error = fitted.notes[f"inverse_error_{axis}_px"]
        assert 0.5 * error < np.nanmax(off[:, place]) <= error * (1 + 1e-3) + 1e-9
    again = rb.rectify(pair, inverse="polynomial", inverse_degree=5)
    assert again.left.target.v == again.right.target.v  # rows stay shared
