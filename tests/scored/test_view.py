"""The scored view is the same for every method, dense, and nested from its middle outwards."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings

import rectbench as rb
from rectbench.scored import SHARES, ScoredView
from rectbench.scored.view import view_middle
from tests.rigs_for_tests import rig, rigs

SIDES = ("left", "right")


@pytest.mark.parametrize("name", ["t265", "sony-as200v", "bumblebee2", "canon-8mm"])
def test_an_image_is_scored_at_about_ten_thousand_pixels_that_the_lens_sees(name: str) -> None:
    pair = rb.load_rig(name)
    view = ScoredView.of(pair)
    for side in SIDES:
        scored, camera = view.side(side), getattr(pair, side)
        assert len(scored.pixels) == pytest.approx(10_000, rel=0.01)
        assert camera.unproject(scored.pixels)[1].all()
        assert camera.contains(scored.pixels).all()


@settings(max_examples=10, deadline=None)
@given(pair=rigs)
def test_a_share_holds_its_share_of_the_pixels_and_lies_in_every_larger_one(pair: rb.Rig) -> None:
    view = ScoredView.of(pair, count=1000)
    for side in SIDES:
        scored = view.side(side)
        everywhere = getattr(pair, side).pixel_grid().reshape(-1, 2)
        seen = getattr(pair, side).unproject(everywhere)[1]
        inside = [scored.within(everywhere, share) for share in SHARES]
        for share, mask in zip(SHARES[:-1], inside[:-1], strict=True):
            assert mask.sum() / seen.sum() == pytest.approx(share, abs=0.03)
        assert all((smaller <= larger).all() for smaller, larger in itertools.pairwise(inside))
        first = scored.pixels[: scored.count(0.5)]
        assert scored.within(first, 0.5).all()
        assert not scored.within(scored.pixels[scored.count(0.5) :], 0.5).any()


def test_the_middle_is_where_both_cameras_look() -> None:
    ahead = rig(rotation_deg=(0, 0, 0), centre_m=(0.1, 0, 0))
    np.testing.assert_allclose(view_middle(ahead), [0, 0, 1], atol=0.02)
    turned = rig(rotation_deg=(0, 20, 0), centre_m=(0.1, 0, 0))
    middle = view_middle(turned)
    angles = [np.degrees(np.arccos(ray[2])) for ray in (middle, turned.R_right_left @ middle)]
    np.testing.assert_allclose(angles, 10, atol=1.5)


def test_the_field_of_view_is_the_lens_s() -> None:
    lens = rb.Camera("equidistant", (640, 480), {"fx": 200, "fy": 200, "cx": 319.5, "cy": 239.5})
    pair = rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]))
    view = ScoredView.of(pair)
    for share in (0.25, 0.5, 1.0):  # a crop in the image's proportions
        assert view.across_deg(share) == pytest.approx(np.degrees(640 / 200) * np.sqrt(share), rel=0.01)


def test_pixels_depend_on_the_camera_alone() -> None:
    lens = rb.load_rig("t265").left
    pairs = [
        rb.Rig(lens, lens, np.eye(3), np.array([-b, 0, 0]), name) for b, name in ((0.1, "a"), (0.2, "b"))
    ]
    first, second = (ScoredView.of(pair).left.pixels for pair in pairs)
    np.testing.assert_array_equal(first, second)


def test_no_share_of_the_view_holds_no_pixel() -> None:
    scored = ScoredView.of(rb.load_rig("t265").scaled(0.25)).left
    assert scored.edge(0.0) == 0.0
    assert not scored.within(scored.pixels, 0.0).any()
