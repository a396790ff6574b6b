"""What is scored is the map that is shown, by differences over a pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

import rectbench as rb
from rectbench.metrics import log_distortion_on_view
from rectbench.scored import Delivered, ScoredView
from rectbench.warps.jacobians import log_distortion_parts
from tests.rigs_for_tests import rig, rigs

SHARES = (0.3, 0.5, 0.95, 1.0)


@settings(max_examples=8, deadline=None)
@given(pair=rigs)
def test_differences_over_a_pixel_are_the_derivative(pair: rb.Rig) -> None:
    rect = rb.rectify(pair, method="abraham")
    delivered = Delivered.of(rect, ScoredView.of(pair, count=400))
    for side in ("left", "right"):
        found = delivered.side(side)
        exact = rect.warp(side).jacobian(found.scored.pixels[found.shown])
        np.testing.assert_allclose(found.jacobians[found.shown], exact, atol=2e-3 * np.abs(exact).max())


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
            assert log_distortion_on_view(other, pair, share) == pytest.approx(honest[share], rel=1e-6)
    for coverage in (0.9, 0.5):
        cropped = rb.framed(rect, rb.Framing(coverage=coverage))
        for share in SHARES:
            value = log_distortion_on_view(cropped, pair, share)
            assert np.isnan(value) or value == pytest.approx(honest[share], rel=1e-9)
        assert np.isnan(log_distortion_on_view(cropped, pair, 1.0))


def test_pixels_outside_the_frame_do_not_count() -> None:
    pair = rb.load_rig("t265")
    rect = rb.rectify(pair, method="conventional")
    wider = replace(rect, size=(4000, 4000))  # the corner stays, so more of the right and lower part is shown
    view = ScoredView.of(pair)
    shown, more = (log_distortion_parts(Delivered.of(r, view).shown.both)[0] for r in (rect, wider))
    assert shown == pytest.approx(0.346, abs=0.005)
    assert more > 1.2 * shown


def test_a_uniform_scale_has_no_log_distortion() -> None:
    lens = rb.Camera("pinhole", (320, 240), {"fx": 200, "fy": 200, "cx": 159.5, "cy": 119.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    warp = rb.Warp(lens, np.eye(3), rb.Perspective.from_focal(300.0, 239.5, 179.5))
    rect = rb.Rectification(pair, warp, warp, (480, 360))
    assert log_distortion_on_view(rect, pair, 1.0) == pytest.approx(0, abs=1e-9)


def test_the_number_of_pixels_hardly_changes_the_score() -> None:
    pair = rig("kannala-brandt")
    rect = rb.rectify(pair, method="abraham")
    few, many = (
        log_distortion_parts(Delivered.of(rect, ScoredView.of(pair, count=count)).within(0.95).both)[0]
        for count in (10_000, 150_000)
    )
    assert few == pytest.approx(many, rel=2e-3)
