"""Propagated uncertainty agrees with formulas, differences, Monte Carlo and the bench's own pose noise."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rectbench as rb
from rectbench.cameras.sensitivity import parameter_names
from rectbench.metrics import Uncertainty, uncertainty
from rectbench.rigs import POSES, RigCovariance, perturb
from rectbench.rigs.covariance import POSE, moved
from rectbench.warps import evaluation_pixels
from tests.rigs_for_tests import LENSES, aligned_rig, rig

FOCAL_PX = 300.0
NOTHING = RigCovariance((), np.zeros((0, 0)))


def of(name: str, sigma: float) -> RigCovariance:
    """The covariance of one parameter."""
    return RigCovariance((name,), [[sigma**2]])


def cylindrical(believed: rb.Rig, size: tuple[int, int] = (1200, 1200)) -> rb.Rectification:
    """û and v̂ are the angles γ and β times 300 px."""
    axes = rb.Radial("equidistant", FOCAL_PX, size[0] / 2), rb.Radial("equidistant", FOCAL_PX, size[1] / 2)
    return rb.Rectification.from_targets(believed, rb.Epipolar(*axes), rb.Epipolar(*axes), size)


def perspective_pair() -> tuple[rb.Rig, rb.Rectification]:
    """Two aligned pinholes of 500 px at 0.1 m, and the rectification that leaves them as they are."""
    lens = rb.Camera("pinhole", (641, 481), {"fx": 500, "fy": 500, "cx": 320, "cy": 240})
    pair = rb.Rig(lens, lens, np.eye(3), [-0.1, 0, 0])
    plane = rb.Perspective.from_focal(500, 320, 240)
    return pair, rb.Rectification.from_targets(pair, plane, plane, (641, 481))


def seen(rect: rb.Rectification, true: rb.Rig, pixels: np.ndarray, depth_m: float) -> tuple[np.ndarray, ...]:
    """Row error, and 1/d as triangulated, of the points at that depth: project truly, rectify as believed."""
    rays, _ = true.left.unproject(pixels)
    px_right, _ = true.right.project(rays @ true.R_right_left.T + true.t_right_left / depth_m)
    left, right = rect.left.forward(pixels), rect.right.forward(px_right)
    points = rect.triangulate(left, left[:, 0] - right[:, 0])
    return left[:, 1] - right[:, 1], 1 / np.linalg.norm(points, axis=-1)


@pytest.mark.parametrize("depth_m", [0.5, 4.0, np.inf])
def test_a_turn_about_the_baseline_moves_all_rows_alike(depth_m: float) -> None:
    pair = aligned_rig(640, 480, 120)
    found = uncertainty(cylindrical(pair), pair, of("pose.rx", 2e-3), depth_m=depth_m)
    sigma = found.row_error_sigma_px[np.isfinite(found.row_error_sigma_px)]
    assert sigma.size > 10_000
    np.testing.assert_allclose(sigma, FOCAL_PX * 2e-3, rtol=1e-9)
    (numbers,) = found.numbers()
    assert numbers["row_error_expected_mean_px"] == pytest.approx(np.sqrt(2 / np.pi) * 0.6)
    # σ of the distance is none: the point turns about the line on which distance is measured.
    assert np.nanmax(found.inverse_depth_sigma_per_m) < 1e-12


def test_a_baseline_that_points_elsewhere_counts_by_its_distance() -> None:
    pair, depth_m = aligned_rig(640, 480, 120), 3.0
    found = uncertainty(cylindrical(pair), pair, of("pose.ty", 1e-3), depth_m=depth_m)
    _, y, z = np.moveaxis(depth_m * pair.left.unproject(found.pixels)[0], -1, 0)
    shown = np.isfinite(found.row_error_sigma_px[0])
    expected = FOCAL_PX * 1e-3 * np.abs(z) / (y**2 + z**2)
    np.testing.assert_allclose(found.row_error_sigma_px[0][shown], expected[shown], rtol=1e-9)


def test_a_baseline_of_unsure_length_scales_all_distances_and_moves_no_row() -> None:
    pair = rig("double-sphere")
    covariance = RigCovariance.from_sigmas(pair, baseline_m=0.02 * pair.baseline_m)
    found = uncertainty(rb.rectify(pair), pair, covariance, depth_m=[0.8, 7.0])
    shares = found.depth_sigma_share[np.isfinite(found.depth_sigma_share)]
    np.testing.assert_allclose(shares, 0.02, rtol=1e-6)
    assert np.nanmax(found.row_error_sigma_px) < 1e-7  # the root of rounding
    np.testing.assert_allclose(found.depth_shares["translation"], 1.0)


def test_a_focal_length_common_to_both_scales_the_distance_on_the_axis() -> None:
    pair, rect = perspective_pair()
    both = RigCovariance(("left.fx", "right.fx"), np.full((2, 2), 25.0))
    found = uncertainty(rect, pair, both, depth_m=2.0, pixels=[[320, 240]])
    assert found.depth_sigma_share[0, 0] == pytest.approx(5 / 500)
    assert found.row_error_sigma_px[0, 0] == pytest.approx(0, abs=1e-12)


def test_a_lower_right_centre_lowers_the_rows_by_as_much() -> None:
    pair, rect = perspective_pair()
    found = uncertainty(rect, pair, of("right.cy", 0.7), depth_m=5.0)
    np.testing.assert_allclose(found.row_error_sigma_px[np.isfinite(found.row_error_sigma_px)], 0.7)


def test_matching_noise_counts_by_distance_squared_over_focal_length_and_baseline() -> None:
    pair, rect = perspective_pair()
    found = uncertainty(rect, pair, NOTHING, depth_m=[2.0, 8.0], matching_px=0.25, pixels=[[320, 240]])
    np.testing.assert_allclose(found.matched_depth_sigma_share[:, 0], [0.25 * d / 50 for d in (2, 8)])
    np.testing.assert_allclose(found.matched_row_error_sigma_px, 0.25)
    both = uncertainty(rect, pair, of("pose.rx", 1e-3), depth_m=2.0, matching_px=0.25, pixels=[[320, 240]])
    assert both.matched_row_error_sigma_px[0, 0] == pytest.approx(np.hypot(0.25, 0.5))


MODELS = {model: rig(model) for model in LENSES} | {
    "ocam": rb.Rig(
        *[rb.Camera("ocam", (480, 320), {"cx": 240, "cy": 160, "poly": [210, 0, -1e-3, 0, -3e-9]})] * 2,
        *(rig().R_right_left, rig().t_right_left),
    ),
    "f-theta": rb.Rig(
        *[rb.Camera("f-theta", (480, 320), {"cx": 240, "cy": 160, "angle_poly": [5e-3, 1e-7, 2e-9]})] * 2,
        *(rig().R_right_left, rig().t_right_left),
    ),
}


@pytest.mark.parametrize("model", MODELS)
def test_each_parameter_moves_row_and_distance_as_a_moved_rig_does(model: str) -> None:
    believed, depth_m = MODELS[model], 1.5
    rect = rb.rectify(believed)
    pixels = evaluation_pixels(believed.left, 40)
    lenses = [f"{side}.{name}" for side in ("left", "right") for name in parameter_names(believed.left)]
    for name in (*POSE, *lenses):
        power = 1 - int(name[-1]) if ".poly" in name else -1 - int(name[-1]) if ".angle_poly" in name else 0
        step = 1e-6 * 210.0**power
        one = uncertainty(rect, believed, of(name, step), depth_m=depth_m, pixels=pixels)
        moves = [seen(rect, moved(believed, {name: sign * step}), pixels, depth_m) for sign in (1, -1)]
        for sigma, ahead, behind in zip(
            (one.row_error_sigma_px[0], one.inverse_depth_sigma_per_m[0]), *moves, strict=True
        ):
            shown = np.isfinite(sigma)
            assert shown.sum() > 10
            numeric = np.abs(ahead - behind)[shown] / 2
            np.testing.assert_allclose(sigma[shown], numeric, rtol=1e-4, atol=2e-12, err_msg=name)


def correlated(believed: rb.Rig, rng: np.random.Generator) -> RigCovariance:
    """Pose and lenses unsure, each parameter with all others."""
    sigmas = {"fx": 0.4, "fy": 0.4, "cx": 0.3, "cy": 0.3, "k1": 2e-4, "xi": 1e-3, "alpha": 5e-4}
    lens = {name: sigma for name, sigma in sigmas.items() if name in believed.left.params}
    names = (*POSE, *(f"{side}.{name}" for side in ("left", "right") for name in lens))
    scale = np.array([*[5e-4] * 3, *[2e-4] * 3, *list(lens.values()) * 2])
    mixing = rng.normal(size=(len(names), 6)) / np.sqrt(6)
    return RigCovariance(names, scale[:, None] * (mixing @ mixing.T) * scale)


@pytest.mark.parametrize("method", ["conventional", "local-homography"])
@pytest.mark.parametrize("model", ["kannala-brandt", "double-sphere"])
def test_drawn_rigs_scatter_rows_and_distances_as_much_as_predicted(model: str, method: str) -> None:
    rng = np.random.default_rng(1)
    believed, depth_m = rig(model), 2.0
    covariance, rect = correlated(believed, rng), rb.rectify(believed, method)
    pixels = evaluation_pixels(believed.left, 60)
    found = uncertainty(rect, believed, covariance, depth_m=depth_m, pixels=pixels)
    drawn = [seen(rect, covariance.draw(believed, rng), pixels, depth_m) for _ in range(700)]
    rows, inverse = (np.std([one[i] for one in drawn], axis=0) for i in (0, 1))
    for predicted, scattered in (
        (found.row_error_sigma_px[0], rows),
        (found.inverse_depth_sigma_per_m[0], inverse),
    ):
        ratio = (scattered / predicted)[np.isfinite(predicted) & np.isfinite(scattered)]
        assert ratio.size > 15
        np.testing.assert_allclose(ratio, 1, atol=0.13)  # 1 / sqrt(2 * 700) is 2.7 %
        assert ratio.mean() == pytest.approx(1, abs=0.04)
    means = np.abs([row[np.isfinite(found.row_error_sigma_px[0])] for row, _ in drawn]).mean()
    (numbers,) = found.numbers()
    assert numbers["row_error_expected_mean_px"] == pytest.approx(means, rel=0.05)


def test_the_bench_s_perturbed_pose_errs_as_much_as_its_sizes_predict() -> None:
    true, noise = rb.load_rig("t265").scaled(0.5), POSES["perturbed"]
    covariance = RigCovariance.from_sigmas(
        true, rotation_deg=noise.rotation_deg, direction_deg=noise.direction_deg
    )
    pixels = evaluation_pixels(true.left)
    px_right, _ = true.right.project(true.right_from_left(2.0 * true.left.unproject(pixels)[0]))
    found = uncertainty(rb.rectify(true, "abraham"), true, covariance, depth_m=2.0, pixels=pixels)
    measured = [
        rb.metrics.row_error(rb.rectify(perturb(true, noise, seed), "abraham"), pixels, px_right).columns()
        for seed in range(80)
    ]
    rms = np.sqrt(np.mean([row["row_error_rms_px"] ** 2 for row in measured]))
    mean = np.mean([row["row_error_mean_px"] for row in measured])
    (numbers,) = found.numbers()
    assert numbers["row_error_sigma_rms_px"] == pytest.approx(rms, rel=0.1)
    # An error of fixed size has a larger mean than a normal one: by 8 % in three directions, 13 % in two.
    assert 0.95 < mean / numbers["row_error_expected_mean_px"] < 1.2


def sigmas(found: Uncertainty) -> np.ndarray:
    return np.stack([found.row_error_sigma_px, found.inverse_depth_sigma_per_m])


@settings(max_examples=8)
@given(
    st.tuples(*[st.floats(0, 0.2)] * 2),
    st.tuples(*[st.floats(0, 1)] * 2),
    st.floats(0.5, 3),
)
def test_independent_errors_add_in_squares_and_an_enlarged_image_enlarges_row_errors(
    pose: tuple[float, float], lens: tuple[float, float], factor: float
) -> None:
    believed = MODELS["kannala-brandt"]
    rect, pixels = rb.rectify(believed, "abraham"), evaluation_pixels(believed.left, 30)
    a = RigCovariance.from_sigmas(believed, rotation_deg=pose[0], direction_deg=pose[1])
    b = RigCovariance.from_sigmas(believed, focal_px=lens[0], centre_px=lens[1])
    one, other, both = (
        sigmas(uncertainty(rect, believed, c, depth_m=[1, np.inf], pixels=pixels)) for c in (a, b, a + b)
    )
    np.testing.assert_allclose(both, np.hypot(one, other), rtol=1e-9, atol=1e-12)
    larger = rect.scaled(factor)
    enlarged = uncertainty(larger, believed, a + b, depth_m=[1, np.inf], pixels=pixels)
    shown = np.isfinite(enlarged.row_error_sigma_px)
    ratio = larger.size[1] / rect.size[1]
    np.testing.assert_allclose(enlarged.row_error_sigma_px[shown], ratio * both[0][shown], rtol=1e-9)
    np.testing.assert_allclose(enlarged.inverse_depth_sigma_per_m[shown], both[1][shown], rtol=1e-9)


def test_a_certain_calibration_errs_by_nothing() -> None:
    believed = rig()
    found = uncertainty(rb.rectify(believed), believed, NOTHING)
    assert np.nanmax(found.row_error_sigma_px) == np.nanmax(found.inverse_depth_sigma_per_m) == 0
    assert np.isfinite(found.row_error_sigma_px).mean() > 0.5


def test_the_shares_of_the_groups_make_the_whole() -> None:
    believed = rig("kannala-brandt")
    covariance = correlated(believed, np.random.default_rng(3))
    found = uncertainty(rb.rectify(believed), believed, covariance, depth_m=[1.0, np.inf])
    for shares in (found.row_error_shares, found.depth_shares):
        np.testing.assert_allclose(np.sum(list(shares.values()), axis=0), 1.0)


def test_a_share_is_what_is_left_when_the_other_groups_are_certain() -> None:
    believed = rig("kannala-brandt")
    rect = rb.rectify(believed)
    parts = {"rotation": of("pose.rz", 1e-3), "left intrinsics": of("left.k1", 1e-3)}
    whole = uncertainty(rect, believed, parts["rotation"] + parts["left intrinsics"], depth_m=1.0)
    square = np.nansum(whole.row_error_sigma_px**2)
    for group, covariance in parts.items():
        alone = uncertainty(rect, believed, covariance, depth_m=1.0)
        share = np.nansum(alone.row_error_sigma_px**2) / square
        assert whole.row_error_shares[group][0] == pytest.approx(share)


def test_pixels_of_any_shape_give_maps_of_that_shape_and_the_same_values() -> None:
    believed = rig("kannala-brandt")
    rect, covariance = rb.rectify(believed), RigCovariance.from_sigmas(believed, rotation_deg=0.1)
    grid = believed.left.pixel_grid()
    whole = uncertainty(rect, believed, covariance, depth_m=2.0, pixels=grid)  # compiled, in blocks
    assert whole.row_error_sigma_px.shape == (1, 320, 480)
    few = uncertainty(rect, believed, covariance, depth_m=2.0, pixels=grid[100, ::7])
    np.testing.assert_allclose(whole.row_error_sigma_px[0, 100, ::7], few.row_error_sigma_px[0], rtol=1e-9)


def test_what_lands_in_one_image_only_is_no_number() -> None:
    pair, rect = perspective_pair()
    found = uncertainty(rect, pair, of("pose.rx", 1e-3), depth_m=0.5, pixels=[[50, 240], [320, 240]])
    assert np.isnan(found.row_error_sigma_px[0]).tolist() == [True, False]  # the disparity is 100 px
    assert found.numbers()[0]["pixels_share"] == 0.5


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"depth_m": 0.0}, "depth_m is 0.0; expected distances above 0"),
        ({"depth_m": [1.0, np.nan]}, "depth_m is .*; expected distances above 0"),
        ({"depth_m": []}, "depth_m is .*; expected distances above 0"),
        ({"depth_m": "far"}, "depth_m is 'far'; expected distances above 0"),
        ({"matching_px": -1}, "matching_px is -1; expected a number of pixels from 0 on"),
        ({"matching_px": np.nan}, "matching_px is nan; expected a number of pixels from 0 on"),
        ({"pixels": [1, 2, 3]}, r"pixels has shape \(3,\)"),
    ],
)
def test_a_distance_or_noise_that_is_none_is_refused(given: dict, message: str) -> None:
    pair, rect = perspective_pair()
    with pytest.raises(rb.InvalidInput, match=message):
        uncertainty(rect, pair, NOTHING, **given)


def test_a_parameter_that_the_lens_has_not_is_refused() -> None:
    pair, rect = perspective_pair()
    with pytest.raises(rb.UnknownName, match=r"unknown parameter of the left lens \(pinhole\) 'xi'"):
        uncertainty(rect, pair, of("left.xi", 0.1))
