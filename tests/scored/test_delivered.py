"""What is scored are the lookup tables, on the view of the rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

import rectbench as rb
from rectbench.metrics import log_distortion, log_distortion_on_view
from rectbench.scored import Delivered, ScoredView, check_agreement
from rectbench.warps.jacobians import LogStretches
from tests.rigs_for_tests import rigs

SHARES = (0.3, 0.5, 0.95, 1.0)


@settings(max_examples=8, deadline=None)
@given(pair=rigs)
def test_a_piece_of_a_table_has_the_derivative_and_the_area_that_the_warp_has_there(pair: rb.Rig) -> None:
    rect = rb.rectify(pair, method="abraham")
    delivered = Delivered.of(rect, ScoredView.of(pair))
    for side in ("left", "right"):
        pieces, warp = delivered.side(side).pieces, rect.warp(side)
        inner = pair.left.contains(pieces.middles.T)
        exact = warp.jacobian(pieces.middles.T[inner])
        np.testing.assert_allclose(pieces.jacobians[inner], exact, atol=0.02 * np.abs(exact).max())
        off = np.linalg.norm(pieces.jacobians[inner] - exact, axis=(1, 2)) / np.linalg.norm(
            exact, axis=(1, 2)
        )
        assert np.median(off) < 1e-4


@settings(max_examples=8, deadline=None)
@given(pair=rigs)
def test_the_pieces_of_a_table_hold_as_much_of_the_view_as_is_asked_for(pair: rb.Rig) -> None:
    delivered = Delivered.of(rb.rectify(pair, method="abraham"), ScoredView.of(pair))
    for share in SHARES:
        for side in (delivered.left, delivered.right):
            assert side.shares(share).sum() == pytest.approx(share, abs=0.02)


def by_exact_derivatives(rect: rb.Rectification, view: ScoredView, share: float) -> float:
    """Log distortion on a regular grid of A_s by the warp's own derivative, and by other code."""
    J = []
    for warp, scored in ((rect.left, view.left), (rect.right, view.right)):
        reach = scored.edge(share) * scored.reach
        low, high = (
            np.maximum(scored.middle - reach, -0.5),
            np.minimum(scored.middle + reach, np.array(warp.source.size) - 0.5),
        )
        cells = (np.arange(250) + 0.5) / 250
        grid = np.stack(np.meshgrid(*(low + np.outer(cells, high - low)).T), axis=-1).reshape(-1, 2)
        J.append(warp.jacobian(grid[scored.within(grid, share)]))
    return float(np.std(np.log(np.linalg.svd(np.concatenate(J), compute_uv=False))))


@pytest.mark.parametrize("name", ["t265", "canon-8mm", "sony-as200v", "tumvi", "bumblebee2"])
@pytest.mark.parametrize("method", ["abraham", "local-homography", "conventional"])
def test_the_score_is_that_of_exact_derivatives_everywhere(name: str, method: str) -> None:
    pair = rb.load_rig(name)
    rect, view = rb.rectify(pair, method=method), ScoredView.of(pair)
    delivered = Delivered.of(rect, view)
    for share in {0.1, 0.4, 0.95, 1.0} & set(delivered.shares_kept):
        expected = by_exact_derivatives(rect, view, share)
        rel = 1e-3 if share == 0.95 else 6e-3  # a small part of the view has few pieces
        if pair.trimmed() != pair:  # rows are squeezed where the view goes up to the epipoles
            rel = 8e-3
        assert delivered.log_distortion(share) == pytest.approx(expected, rel=rel)


@pytest.mark.parametrize("width", [48, 96])
def test_a_small_image_is_scored_as_a_large_one(width: int) -> None:
    pair = rb.load_rig("t265")
    large, small = (
        Delivered.of(rb.rectify(p, method="abraham"), ScoredView.of(p)).log_distortion(0.95)
        for p in (pair, pair.scaled(width / pair.left.width))
    )
    assert small == pytest.approx(large, rel=0.04)  # half a pixel of rim is more of a small image


@pytest.mark.parametrize("name", rb.fisheye_rigs())
def test_what_is_shown_at_the_very_rim_of_a_frame_is_found_there(name: str) -> None:
    pair = rb.load_rig(name)
    pair = pair.scaled(640 / pair.left.width)
    found = Delivered.of(rb.rectify(pair, method="local-homography"), ScoredView.of(pair))
    assert found.left.shown.all()
    assert found.right.shown.all()


def test_a_method_that_shows_all_keeps_all_and_one_that_crops_does_not() -> None:
    pair = rb.load_rig("t265")
    view = ScoredView.of(pair)
    whole = Delivered.of(rb.rectify(pair, method="abraham"), view)
    assert whole.kept_share == 1.0
    assert all(whole.keeps(share) for share in SHARES)
    cropped = Delivered.of(rb.rectify(pair, method="conventional"), view)
    assert 0.3 < cropped.kept_share < 0.6
    assert cropped.keeps(0.3)
    assert not cropped.keeps(0.95)


def test_cropping_shrinking_and_turning_the_frame_gain_nothing() -> None:
    pair = rb.load_rig("sony-as200v").scaled(1 / 3)
    rect = rb.rectify(pair, method="abraham")
    honest = {share: log_distortion_on_view(rect, pair, share) for share in SHARES}
    for focal_px in (20.0, 100.0, 700.0):
        other = rb.framed(rect, rb.Framing(coverage=1.0, focal_px=focal_px))
        for share in SHARES[:-1]:  # a frame of whole pixels may cut the very rim
            assert log_distortion_on_view(other, pair, share) == pytest.approx(honest[share], rel=1e-3)
    for coverage in (0.9, 0.5):
        cropped = rb.framed(rect, rb.Framing(coverage=coverage))
        for share in SHARES:
            value = log_distortion_on_view(cropped, pair, share)
            assert np.isnan(value) or value == pytest.approx(honest[share], rel=1e-3)
        assert np.isnan(log_distortion_on_view(cropped, pair, 1.0))


def test_pixels_outside_the_frame_do_not_count() -> None:
    pair = rb.load_rig("t265")
    rect = rb.rectify(pair, method="conventional")
    wider = replace(rect, size=(4000, 4000))  # the corner stays, so more of the right and lower part is shown
    view = ScoredView.of(pair)
    shown, more = (log_distortion(Delivered.of(r, view).shown)["log_distortion"] for r in (rect, wider))
    assert shown == pytest.approx(0.346, abs=0.005)
    assert more > 1.2 * shown


def test_a_uniform_scale_has_no_log_distortion() -> None:
    lens = rb.Camera("pinhole", (320, 240), {"fx": 200, "fy": 200, "cx": 159.5, "cy": 119.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    warp = rb.Warp(lens, np.eye(3), rb.Perspective.from_focal(300.0, 239.5, 179.5))
    rect = rb.Rectification(pair, warp, warp, (480, 360))
    assert log_distortion_on_view(rect, pair, 1.0) == pytest.approx(0, abs=1e-5)  # of float32 entries


@pytest.mark.parametrize("size", [(1, 1), (1, 300), (2, 2), (7, 5)])
def test_frames_of_a_few_pixels_are_scored_as_larger_ones(size: tuple[int, int]) -> None:
    pair = rb.load_rig("t265").scaled(0.25)
    rect = rb.rectify(pair, method="abraham")
    tiny = rect.windowed((-0.5, -0.5), rect.size, size)
    found = [Delivered.of(r, ScoredView.of(pair)) for r in (rect, tiny)]
    check_agreement(tiny, found[1])
    whole, small = (delivered.within(0.95) for delivered in found)
    stretch = np.divide(rect.size, size)[:, None]
    expected = LogStretches.of(whole.both).distortion(whole.weights)[0]
    assert LogStretches.of(small.both * stretch).distortion(small.weights)[0] == pytest.approx(
        expected, rel=0.01
    )
