"""Surfaces that rise along γ, and maps to scan lines whose columns change from row to row."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline

import rectbench as rb
from rectbench.warps.lookup import tables
from tests.rigs_for_tests import rig

BETA, GAMMA = (-1.2, 1.0), (-1.3, 1.4)


def surface(seed: int = 0, steps: tuple[float, float] = (-1.0, 1.0)) -> rb.SplineSurface:
    """Of 4 by 5 intervals, its rises anywhere between powers of ten."""
    rng = np.random.default_rng(seed)
    rises = 100 * 10 ** rng.uniform(*steps, (7, 8))
    return rb.SplineSurface.of(BETA, GAMMA, np.cumsum(rises, axis=1) + rng.uniform(0, 50, (7, 1)))


def warp_of(columns: rb.SplineSurface) -> rb.Warp:
    pair = rig("double-sphere", (3, -6, 4))
    target = rb.ScanLines(columns, rb.Radial("equidistant", 200.0, 0.0))
    return rb.Warp(pair.left, rb.rectifying_rotations(pair)[0], target)


def test_a_surface_is_the_product_of_b_splines() -> None:
    columns = surface()
    rng = np.random.default_rng(1)
    beta, gamma = rng.uniform(*BETA, 200), rng.uniform(*GAMMA, 200)
    by_beta, by_gamma = (
        BSpline.design_matrix(angle, np.pad(np.linspace(*ends, k + 1), 3, mode="edge"), 3).toarray()
        for angle, ends, k in ((beta, BETA, 4), (gamma, GAMMA, 5))
    )
    expected = np.einsum("ni,ij,nj->n", by_beta, np.array(columns.coefficients), by_gamma)
    np.testing.assert_allclose(columns(beta, gamma), expected, rtol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_it_rises_between_the_knots_too(seed: int) -> None:
    columns = surface(seed, (-6, 2))
    beta, gamma = np.linspace(*BETA, 101), np.linspace(*GAMMA, 5001)
    assert (np.diff(columns(beta[:, None], gamma), axis=1) > 0).all()


def test_a_surface_that_does_not_rise_is_refused() -> None:
    falling = np.array(surface().coefficients)
    falling[2, 3] = falling[2, 4]
    with pytest.raises(rb.InvalidInput, match="rise by 0 px; expected all above 0"):
        rb.SplineSurface.of(BETA, GAMMA, falling)
    with pytest.raises(rb.InvalidInput, match="expected 4 or more rows and columns"):
        rb.SplineSurface.of(BETA, GAMMA, falling[:3])
    with pytest.raises(rb.InvalidInput, match=r"gamma from 1\.0 to 1\.0"):
        rb.SplineSurface.of(BETA, (1, 1), surface().coefficients)


def test_the_inverse_comes_back_and_the_jacobian_is_the_difference() -> None:
    warp = warp_of(surface())
    pixels = rb.evaluation_pixels(warp.source, 300)
    there = warp.forward(pixels)
    shown = np.isfinite(there).all(axis=1)
    assert shown.mean() > 0.8
    np.testing.assert_allclose(warp.inverse(there[shown]), pixels[shown], atol=1e-9)
    steps = 1e-4 * np.eye(2)
    inner = shown & np.isfinite([warp.forward(pixels + s * d) for d in steps for s in (-1, 1)]).all((0, 2))
    differences = [(warp.forward(pixels + d) - warp.forward(pixels - d)) / 2e-4 for d in steps]
    np.testing.assert_allclose(
        warp.jacobian(pixels)[inner], np.stack(differences, axis=-1)[inner], rtol=1e-6, atol=1e-6
    )


def test_beyond_the_ends_of_a_line_there_is_nothing() -> None:
    target = rb.ScanLines(surface(), rb.Radial("equidistant", 200.0, 0.0))
    first, last = surface()(0.1, GAMMA)
    _, shown = target.unproject([[first - 0.01, 20.0], [first + 0.01, 20.0], [last + 0.01, 20.0]])
    assert shown.tolist() == [False, True, False]


def test_many_points_and_tables_are_those_of_few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    warp = warp_of(surface())
    warp = replace(warp, target=warp.target.framed(0.0, -200.0, 0.3, 0.5))
    many = rb.evaluation_pixels(warp.source, 5000)
    few = [warp.forward(part) for part in np.array_split(many, 10)]
    np.testing.assert_allclose(warp.forward(many), np.concatenate(few), rtol=1e-12)
    compiled = tables.lookup_table(warp, (300, 200))
    monkeypatch.setattr(tables.llvm, "available", lambda: False)
    for ours, theirs in zip(compiled, tables.lookup_table(warp, (300, 200)), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-4)


def test_a_window_moves_and_scales_the_image() -> None:
    warp = warp_of(surface())
    pixels = rb.evaluation_pixels(warp.source, 50)
    framed = replace(warp, target=warp.target.framed(10.0, -20.0, 2.0, 0.5))
    expected = (warp.forward(pixels) - [10.0, -20.0]) * [2.0, 0.5] - 0.5
    np.testing.assert_allclose(framed.forward(pixels), expected, rtol=1e-12)
