"""Distortion: identities, the published figures, brute force for the optima of the protocols."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rectbench as rb
from rectbench.metrics import Jacobians, distortion_of, log_distortion, sampling
from rectbench.metrics.distortion import best_scale, best_stretch
from rectbench.scored import Delivered, ScoredView
from rectbench.warps.jacobians import entries, singular_values
from tests.rigs_for_tests import aligned_rig, rig


def same_everywhere(J: list[list[float]], count: int = 50) -> Jacobians:
    stacked = np.tile(np.array(J, dtype=float), (count, 1, 1))
    return Jacobians(stacked, stacked.copy())


def random_jacobians(seed: int = 0, count: int = 200) -> Jacobians:
    rng = np.random.default_rng(seed)
    left, right = (np.eye(2) * 1.3 + 0.25 * rng.standard_normal((count, 2, 2)) for _ in range(2))
    return Jacobians(left, right)


def brute_force_l(J: np.ndarray) -> float:
    """L from its definition, pixel by pixel."""
    total = 0.0
    for (a, b), (c, d) in J:
        w1, w2 = math.hypot(a, c), math.hypot(b, d)
        total += (abs(a * d - b * c) - 1) ** 2 + 0.5 * (w1 - w2) ** 2 + 0.5 * (a * b + c * d) ** 2
    return total / len(J)


def test_the_identity_has_no_distortion() -> None:
    score = distortion_of(same_everywhere([[1, 0], [0, 1]]))
    assert score == 0
    assert score.terms == {"area": 0, "ratio": 0, "skew": 0}


def test_a_turn_has_no_distortion() -> None:
    c, s = math.cos(0.3), math.sin(0.3)
    jacobians = same_everywhere([[c, -s], [s, c]])
    assert distortion_of(jacobians) == pytest.approx(0, abs=1e-30)
    assert log_distortion(jacobians)["log_distortion"] == pytest.approx(0, abs=1e-15)


@given(st.floats(0.01, 5))
def test_a_uniform_scale_costs_the_area_term_alone_and_nothing_once_rescaled(scale: float) -> None:
    jacobians = same_everywhere([[scale, 0], [0, scale]])
    native = distortion_of(jacobians)
    assert native == pytest.approx((scale**2 - 1) ** 2, abs=1e-12)
    assert native.terms["ratio"] == native.terms["skew"] == 0
    assert distortion_of(jacobians, "rescaled") == pytest.approx(0, abs=1e-12)
    assert log_distortion(jacobians)["log_distortion"] == pytest.approx(0, abs=1e-12)


def test_zero_scale_has_a_distortion_of_exactly_one() -> None:
    assert distortion_of(same_everywhere([[0, 0], [0, 0]])) == 1


def test_a_stretch_of_two_is_undone_by_the_stretched_protocol_only() -> None:
    jacobians = same_everywhere([[2, 0], [0, 1]])
    assert distortion_of(jacobians) == pytest.approx((2 - 1) ** 2 + 0.5 * (2 - 1) ** 2)
    assert distortion_of(jacobians, "rescaled") > 0.1
    assert distortion_of(jacobians, "stretched") == pytest.approx(0, abs=1e-12)


def test_l_is_the_papers_sum_over_pixels_and_its_terms_add_up() -> None:
    jacobians = random_jacobians()
    score = distortion_of(jacobians)
    assert score == pytest.approx(brute_force_l(jacobians.both), rel=1e-12)
    assert sum(score.terms.values()) == pytest.approx(float(score), rel=1e-12)
    per_pixel = np.concatenate([score.per_pixel["left"], score.per_pixel["right"]])
    assert per_pixel.mean() == pytest.approx(float(score), rel=1e-12)
    assert score.median == np.quantile(per_pixel, 0.5, method="inverted_cdf")


@pytest.mark.parametrize("seed", range(5))
def test_the_best_scale_beats_every_scale_tried(seed: int) -> None:
    J = random_jacobians(seed).both
    scale, _ = best_scale(J)
    tried = np.linspace(0.01, 3, 3000)
    losses = [brute_force_l(J[:40] * s) for s in tried[::100]]
    assert brute_force_l(J * scale) <= min(brute_force_l(J * s) for s in tried[::25]) + 1e-9
    assert min(losses) > 0


@pytest.mark.parametrize("seed", range(3))
def test_the_best_stretch_beats_every_stretch_tried(seed: int) -> None:
    J = random_jacobians(seed, 60).both
    found = brute_force_l(J * np.array(best_stretch(J))[:, None])
    grid = np.linspace(0.3, 1.6, 27)
    assert found <= min(brute_force_l(J * np.array([[a], [b]])) for a in grid for b in grid) + 1e-9


@given(st.integers(0, 1000))
def test_protocols_are_ordered_native_rescaled_stretched(seed: int) -> None:
    jacobians = random_jacobians(seed, 40)
    native, rescaled, stretched = (distortion_of(jacobians, p) for p in ("native", "rescaled", "stretched"))
    assert stretched <= rescaled + 1e-9 <= native + 2e-9


@given(st.integers(0, 1000), st.floats(0.01, 100))
def test_log_distortion_does_not_change_with_scale(seed: int, scale: float) -> None:
    jacobians = random_jacobians(seed, 30)
    scaled = Jacobians(jacobians.left * scale, jacobians.right * scale)
    assert log_distortion(scaled)["log_distortion"] == pytest.approx(
        log_distortion(jacobians)["log_distortion"], rel=1e-9
    )


def test_log_distortion_is_its_definition_and_splits_in_quadrature() -> None:
    jacobians = random_jacobians(3)
    logs = np.log(np.linalg.svd(jacobians.both, compute_uv=False))
    parts = log_distortion(jacobians)
    assert parts["log_distortion"] == pytest.approx(np.sqrt(np.mean((logs - logs.mean()) ** 2)), rel=1e-12)
    assert parts["log_distortion"] ** 2 == pytest.approx(
        parts["log_distortion_area"] ** 2 + parts["log_distortion_anisotropy"] ** 2
    )


def test_singular_values_are_those_of_numpy() -> None:
    J = random_jacobians(5).both
    np.testing.assert_allclose(
        np.stack(singular_values(*entries(J), np), -1), np.linalg.svd(J, compute_uv=False), rtol=1e-12
    )


def scaled_pinhole(left: tuple[float, float], right: tuple[float, float]) -> rb.Rectification:
    """A rectification whose images are scaled by (s_u, s_v), the right one a third the size of the left."""
    warps = []
    for (s_u, s_v), size in ((left, (90, 60)), (right, (30, 60))):
        lens = rb.Camera("pinhole", size, {"fx": 80, "fy": 80, "cx": 40, "cy": 30})
        matrix = np.array([[80 * s_u, 0, 40], [0, 80 * s_v, 30], [0, 0, 1.0]])
        warps.append(rb.Warp(lens, np.eye(3), rb.Perspective(matrix)))
    pair = rb.Rig(warps[0].source, warps[1].source, np.eye(3), np.array([-0.1, 0, 0]))
    return rb.Rectification(pair, warps[0], warps[1], (90, 60))


def delivered(rect: rb.Rectification) -> Jacobians:
    return Delivered.of(rect, ScoredView.of(rect.rig)).shown


def test_sampling_counts_lost_and_invented_pixels() -> None:
    result = sampling(delivered(scaled_pinhole(left=(0.5, 0.5), right=(2.0, 1.0))))
    # Each image counts as much as the other, and of the right one the frame shows a third.
    assert result["sampling_lost"] == pytest.approx(0.75, abs=0.02)
    assert result["sampling_invented"] == pytest.approx(0.25, abs=0.02)


def test_an_unchanged_image_loses_and_invents_nothing() -> None:
    shown = delivered(scaled_pinhole(left=(1, 1), right=(1, 1)))
    assert sampling(shown) == {"sampling_lost": 0.0, "sampling_invented": 0.0}
    assert float(distortion_of(shown)) == pytest.approx(0, abs=1e-9)  # of float32 entries


def test_distortion_of_what_is_shown_is_that_of_every_pixel() -> None:
    pair = rig("unified", size=(200, 140))
    rect = rb.rectify(pair)
    everywhere = pair.left.pixel_grid().reshape(-1, 2)
    expected = rb.metrics.distortion(rect, pair, pixels=everywhere)
    shown = Delivered.of(rect, ScoredView.of(pair)).shown
    assert distortion_of(shown) == pytest.approx(float(expected), rel=0.02)


def test_pixels_that_are_not_mapped_are_left_out_and_counted() -> None:
    jacobians = same_everywhere([[1, 0], [0, 1]], 10)
    jacobians.left[:5] = np.nan
    score = distortion_of(jacobians)
    assert score == 0
    assert score.valid_share == 0.75
    assert np.isnan(score.per_pixel["left"][:5]).all()


def test_nothing_mapped_scores_nan_not_zero() -> None:
    empty = Jacobians(np.full((4, 2, 2), np.nan), np.full((4, 2, 2), np.nan))
    assert math.isnan(distortion_of(empty))
    assert math.isnan(distortion_of(empty, "stretched"))
    assert all(math.isnan(value) for value in log_distortion(empty).values())


def test_an_unknown_protocol_is_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="expected one of native, rescaled, stretched"):
        distortion_of(random_jacobians(), "best")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("method", "protocol", "expected"),
    [
        ("conventional", "rescaled", 0.847),
        ("abraham", "native", 0.202),
        ("abraham", "rescaled", 0.115),
        ("local-homography", "native", 0.0607),
    ],
)
def test_the_figures_of_an_independent_computation_at_135_degrees(
    method: str, protocol: str, expected: float
) -> None:
    pair = aligned_rig(1920, 1080, 135)
    score = rb.metrics.distortion(rb.rectify(pair, method=method), pair, protocol=protocol)  # type: ignore[arg-type]
    assert score == pytest.approx(expected, rel=0.005)


def test_the_order_of_methods_at_180_degrees_is_that_of_an_independent_computation() -> None:
    pair = aligned_rig(1280, 1280, 180, max_angle_deg=90)
    methods = ("conventional", "abraham", "local-homography")
    rects = {m: rb.rectify(pair, method=m, margin_deg=0.01) for m in methods}
    scores = {m: float(rb.metrics.distortion(rect, pair, protocol="rescaled")) for m, rect in rects.items()}
    assert scores["conventional"] == pytest.approx(1, abs=0.01)
    assert scores["abraham"] == pytest.approx(0.900, abs=0.06)
    assert scores["local-homography"] == pytest.approx(0.622, abs=0.05)


def test_a_turn_about_the_baseline_changes_conventional_and_not_local_homography() -> None:
    level = rig(rotation_deg=(0, 0, 0), centre_m=(0.1, 0, 0))
    results = {}
    for method in ("conventional", "local-homography"):
        rect = rb.rectify(level, method=method)
        tilt = np.array([[1, 0, 0], [0, np.cos(0.2), -np.sin(0.2)], [0, np.sin(0.2), np.cos(0.2)]])
        turned = [rb.Warp(w.source, tilt @ w.R_rect_cam, w.target) for w in (rect.left, rect.right)]
        results[method] = [
            float(rb.metrics.distortion(rect, level, protocol="rescaled")),
            float(
                distortion_of(
                    Jacobians(*(w.jacobian(rb.evaluation_pixels(w.source)) for w in turned)), "rescaled"
                )
            ),
        ]
    before, after = results["conventional"]
    assert abs(before - after) > 0.01


def test_distortion_takes_pixels_and_reports_each() -> None:
    pair = rig()
    pixels = np.array([[100.0, 100], [200, 150], [300, 250]])
    score = rb.metrics.distortion(rb.rectify(pair, method="abraham"), pair, pixels=pixels)
    assert score.per_pixel["left"].shape == (3,)
    assert score.mean == float(score)
