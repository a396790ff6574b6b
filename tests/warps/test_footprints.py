"""What rectified pixels cover in the source: derivatives, what is left to average, and how it is sampled."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rectbench as rb
from rectbench.warps.lookup import footprints
from rectbench.warps.lookup.footprints import Footprints, longest_px, remaining
from tests.rigs_for_tests import rig, rigs

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=6)
@given(rig=rigs)
def test_the_inverse_jacobian_is_the_slope_of_the_inverse(method: str, rig: rb.Rig) -> None:
    rect = rb.rectify(rig, method=method)
    u, v = np.meshgrid(np.linspace(0, rect.size[0] - 1, 15), np.linspace(0, rect.size[1] - 1, 11))
    places, h = np.stack([u, v], axis=-1), 1e-4
    for warp in (rect.left, rect.right):
        slopes = [
            (warp.inverse(places + step) - warp.inverse(places - step)) / (2 * h) for step in h * np.eye(2)
        ]
        exact = warp.inverse_jacobian(places)
        known = np.isfinite(exact).all(axis=(-1, -2)) & np.isfinite(slopes).all(axis=(0, -1))
        assert known.mean() > 0.5
        np.testing.assert_allclose(exact[known], np.stack(slopes, axis=-1)[known], rtol=1e-5, atol=1e-5)
        there = warp.jacobian(warp.inverse(places))[known]
        np.testing.assert_allclose(there @ exact[known], np.broadcast_to(np.eye(2), there.shape), atol=1e-7)


entries = st.lists(st.floats(-20, 20), min_size=4, max_size=4).map(lambda flat: np.reshape(flat, (2, 2)))


@settings(max_examples=200)
@given(A=entries)
def test_what_is_left_to_average_has_the_same_axes_and_lacks_one_pixel(A: np.ndarray) -> None:
    U, sigma, Vt = np.linalg.svd(A)
    assert longest_px(A) == pytest.approx(sigma[0], abs=1e-6)
    left = np.where(sigma**2 > footprints.UNSHRUNK, np.sqrt(np.maximum(sigma**2 - 1, 0)), 0)
    if np.abs(sigma**2 - footprints.UNSHRUNK).min() > 1e-6:
        np.testing.assert_allclose(remaining(A), U @ np.diag(left) @ Vt, atol=1e-5)


@pytest.mark.parametrize("scale", [0.3, 1.0, 1.004])
def test_nothing_is_left_where_the_warp_magnifies_or_turns(scale: float) -> None:
    turn = np.radians(33)
    A = scale * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    assert (remaining(A) == 0).all()


def test_samples_have_the_mean_and_the_covariance_of_the_area() -> None:
    sides = [(across, down) for across in range(1, 9) for down in range(1, 9)]
    arrangements = [footprints.TRIANGLE, *(footprints.ROW * across + down for across, down in sides)]
    for arrangement, (across, down) in zip(arrangements, [(2, 2), *sides], strict=True):
        samples = footprints._samples(arrangement)
        expected = np.diag([across > 1, down > 1]) / 12  # a side of one sample is a side of length 0
        np.testing.assert_allclose(samples.mean(axis=0), 0, atol=1e-12)
        np.testing.assert_allclose(samples.T @ samples / len(samples), expected, atol=1e-12)


@pytest.mark.parametrize("factor", [1.0, 0.4, 0.06])
def test_samples_are_no_more_than_a_pixel_apart_and_bounded_in_number(factor: float) -> None:
    rect = rb.rectify(rig(), method="abraham").scaled(factor)
    patches = Footprints.of(rect.left, rect.maps("left")).patches
    assert patches
    for patch in patches:
        count = len(patch.samples)
        assert 2 <= count <= footprints.MOST_SAMPLES
        x, y = (table.reshape(count, *patch.mask.shape)[:, patch.mask] for table in patch.maps())
        apart = np.hypot(x[:, None] - x, y[:, None] - y) + np.where(np.eye(count), np.inf, 0)[..., None]
        assert apart.min(axis=1).max() < 1.01


def test_the_numbers_for_people_are_those_of_the_derivatives() -> None:
    rect = rb.rectify(rig(), method="abraham")
    v, u = np.mgrid[: rect.size[1], : rect.size[0]]
    valid = rect.valid("left")
    longest = np.linalg.svd(rect.left.inverse_jacobian(np.stack([u, v], -1))[valid], compute_uv=False)[:, 0]
    found = Footprints.of(rect.left, rect.maps("left"))
    assert 0.1 < found.shrunk_share < 1
    assert found.shrunk_share == pytest.approx((longest**2 > footprints.UNSHRUNK).mean(), abs=1e-4)
    assert found.largest_px == pytest.approx(longest.max(), rel=1e-5)
    assert sum(int(patch.mask.sum()) for patch in found.patches) == round(found.shrunk_share * valid.sum())
