"""A rectification at another size is the same rectification."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.warps import Target
from tests.rigs_for_tests import points_before, rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
FACTORS = (0.37, 2.0)


def on_scaled(px: np.ndarray, rect: rb.Rectification, scaled: rb.Rectification) -> np.ndarray:
    """Pixels of `rect` as those of `scaled`: the corners of both images are the same points."""
    return (px + 0.5) * (np.array(scaled.size) / rect.size) - 0.5


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("method", METHODS)
def test_a_scaled_rectification_maps_the_same_pixels(method: str, factor: float) -> None:
    rect = rb.rectify(rig("kannala-brandt"), method=method)
    scaled = rect.scaled(factor)
    assert scaled.size == tuple(round(side * factor) for side in rect.size)
    for side in ("left", "right"):
        plain, other = rect.warp(side), scaled.warp(side)
        pixels = rb.evaluation_pixels(plain.source, 200)
        mapped = other.forward(pixels)
        np.testing.assert_allclose(mapped, on_scaled(plain.forward(pixels), rect, scaled), atol=1e-9)
        np.testing.assert_allclose(other.inverse(mapped), plain.inverse(plain.forward(pixels)), atol=1e-6)
        stretch = np.diag(np.array(scaled.size) / rect.size)
        np.testing.assert_allclose(other.jacobian(pixels), stretch @ plain.jacobian(pixels), atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_depth_does_not_hang_on_the_size(method: str) -> None:
    pair = rig("double-sphere")
    rect = rb.rectify(pair, method=method)
    scaled = rect.scaled(0.4)
    _, px_left, px_right = points_before(pair, 80)
    left, right = rect.left.forward(px_left), rect.right.forward(px_right)
    disparity = left[:, 0] - right[:, 0]
    across = scaled.size[0] / rect.size[0]
    np.testing.assert_allclose(
        scaled.triangulate(on_scaled(left, rect, scaled), disparity * across),
        rect.triangulate(left, disparity),
        rtol=1e-6,
    )


@pytest.mark.parametrize("method", ["conventional", "local-homography"])
def test_the_tables_of_a_scaled_rectification_hold_its_inverse(method: str) -> None:
    scaled = rb.rectify(rig(), method=method).scaled(0.5)
    map_x, map_y = scaled.maps("right")
    v, u = np.mgrid[: scaled.size[1] : 5, : scaled.size[0] : 7]
    exact = scaled.right.inverse(np.stack([u, v], -1))
    seen = np.isfinite(exact).all(axis=-1)
    assert seen.mean() > 0.5
    assert np.abs(np.stack([map_x[v, u], map_y[v, u]], -1) - exact)[seen].max() < 1e-4


class Squeezed(Target):
    """A target of somebody else's: no more than the two formulas."""

    @property
    def constants(self) -> dict[str, float]:
        return {"f": 90.0}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> tuple[Any, Any, Any]:
        gamma, beta = xp.atan2(x, xp.hypot(y, z)), xp.atan2(y, z)
        return c.f * gamma + 150.0, 0.5 * c.f * beta + 60.0, z > 0.0

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
        gamma, beta = (u - 150.0) / c.f, (v - 60.0) / (0.5 * c.f)
        cos_gamma = xp.cos(gamma)
        return xp.sin(gamma), cos_gamma * xp.sin(beta), cos_gamma * xp.cos(beta), cos_gamma > 0.0


def test_anybodys_target_can_be_scaled() -> None:
    pair = rig()
    rect = rb.Rectification.from_targets(pair, Squeezed(), Squeezed(), (300, 120))
    scaled = rect.scaled(1.7)
    pixels = rb.evaluation_pixels(pair.left, 100)
    np.testing.assert_allclose(
        scaled.left.forward(pixels), on_scaled(rect.left.forward(pixels), rect, scaled), atol=1e-9
    )
    assert scaled.valid("left").mean() == pytest.approx(rect.valid("left").mean(), abs=0.01)


def test_scaling_twice_is_scaling_by_the_product() -> None:
    rect = rb.rectify(rig(), method="abraham")
    once, twice = rect.scaled(0.25), rect.scaled(0.5).scaled(0.5)
    assert once.size == twice.size
    pixels = rb.evaluation_pixels(rect.rig.left, 50)
    np.testing.assert_allclose(once.left.forward(pixels), twice.left.forward(pixels), atol=1e-9)


@pytest.mark.parametrize("factor", [0, -1.0, float("nan"), float("inf"), "half", None, 1e9])
def test_a_factor_that_makes_no_image_is_refused(factor: Any) -> None:
    with pytest.raises(rb.InvalidInput):
        rb.rectify(rig(), method="abraham").scaled(factor)
