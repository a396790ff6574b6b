from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.errors import InvalidInput
from rectbench.metrics import distortion
from rectbench.metrics.energy import (
    COEFFICIENTS,
    EnergySlice,
    energy_convex_share,
    energy_curve,
    energy_slice,
)
from rectbench.warps import Cubic, Epipolar, Rectification
from rectbench.warps.profiles import least_slope


@pytest.fixture(scope="module")
def fitted() -> Rectification:
    return rb.rectify(rb.load_rig("sony-as200v"), "local-homography")


def mean_slope(cubic: Cubic) -> float:
    return float(cubic(cubic.high) - cubic(cubic.low)) / (cubic.high - cubic.low)


def moved(cubic: Cubic, changes: dict[int, float]) -> Cubic:
    """The cubic with each c_k changed so that the far end's slope turns by so many mean slopes."""
    far = max(abs(cubic.low), abs(cubic.high))
    steps = {f"c{k}": by * mean_slope(cubic) / (k * far ** (k - 1)) for k, by in changes.items()}
    return replace(cubic, **{name: getattr(cubic, name) + step for name, step in steps.items()})


def changed(rect: Rectification, changes: dict[str, float]) -> Rectification:
    """The rectification with coefficients moved, by hand."""
    by_axis = {axis: {int(n[1]): by for n, by in changes.items() if n[0] == axis} for axis in "uv"}
    left, right = (warp.target for warp in (rect.left, rect.right))
    assert isinstance(left, Epipolar)
    assert isinstance(right, Epipolar)
    new: dict[str, Any] = {axis: moved(getattr(left, axis), by_axis[axis]) for axis in "uv"}
    left = replace(left, **new)
    right = replace(right, v=left.v)
    return replace(rect, left=replace(rect.left, target=left), right=replace(rect.right, target=right))


@pytest.mark.parametrize(("first", "second"), [("u1", "v1"), ("u1", "u3"), ("v2", "v3"), ("u2", "v3")])
def test_a_slice_is_the_distortion_of_the_changed_rectification(
    fitted: Rectification, first: str, second: str
) -> None:
    grid = energy_slice(fitted, first, second, span=0.3, count=3)
    for i, a in enumerate(grid.steps):
        for j, b in enumerate(grid.steps):
            expected = float(distortion(changed(fitted, {first: a, second: b}), fitted.rig))
            assert grid.energy[i, j] == pytest.approx(expected, rel=1e-12)


def test_the_fit_is_the_least_of_every_curve(fitted: Rectification) -> None:
    for name in COEFFICIENTS:
        curve = energy_curve(fitted, name, span=0.2, count=41)
        assert curve.energy.argmin() == 20
        assert curve.energy[20] == pytest.approx(float(distortion(fitted, fitted.rig)), rel=1e-12)


def test_feasible_is_where_both_cubics_rise(fitted: Rectification) -> None:
    grid = energy_slice(fitted, "u1", "u3", span=1.5, count=7)
    target = fitted.left.target
    assert isinstance(target, Epipolar)
    u = target.u
    assert isinstance(u, Cubic)
    far = max(abs(u.low), abs(u.high))
    slope = mean_slope(u)
    for i, a in enumerate(grid.steps):
        for j, b in enumerate(grid.steps):
            c = np.array([u.c1 + a * slope, u.c2, u.c3 + b * slope / (3 * far**2)])
            assert grid.feasible[i, j] == (least_slope(c, u.low, u.high) > 0)
    assert grid.feasible.any()
    assert not grid.feasible.all()


def test_convexity_is_told_of_a_bowl_a_saddle_and_a_ridge() -> None:
    steps = np.linspace(-1, 1, 5)
    a, b = np.meshgrid(steps, steps, indexing="ij")
    everywhere = np.ones((5, 5), dtype=bool)
    shares = [
        EnergySlice("u1", "v1", steps, energy, everywhere).convex_share
        for energy in (a**2 + b**2 + a * b, a * b, a**2 - b**2, a**2 + b**2 + 3 * a * b)
    ]
    assert shares == [1.0, 0.0, 0.0, 0.0]


def test_what_is_not_feasible_does_not_count() -> None:
    steps = np.linspace(-1, 1, 5)
    a, b = np.meshgrid(steps, steps, indexing="ij")
    energy = np.where(a < 0, -(a**2), a**2) + b**2
    assert EnergySlice("u1", "v1", steps, energy, a >= 0.4).convex_share == 1.0
    assert math.isnan(EnergySlice("u1", "v1", steps, energy, a > 2).convex_share)


def test_the_energy_is_convex_about_the_fit(fitted: Rectification) -> None:
    assert energy_convex_share(fitted, span=0.05, count=11) == 1.0


def test_only_cubics_have_a_shape() -> None:
    rect = rb.rectify(rb.load_rig("sony-as200v"), "abraham")
    assert math.isnan(energy_convex_share(rect))
    with pytest.raises(InvalidInput, match="no pair of cubics"):
        energy_slice(rect, "u1", "v1")


def test_an_unknown_coefficient_is_named(fitted: Rectification) -> None:
    with pytest.raises(InvalidInput, match="'u4'"):
        energy_slice(fitted, "u4", "v1")
