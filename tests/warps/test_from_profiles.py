"""A rectification of rising profiles: placed in the smallest frame that holds what the rig sees."""

import math

import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import rig


def angle(focal_px: float, offset_px: float = 0.0) -> rb.Radial:
    return rb.Radial("equidistant", focal_px, offset_px)


def test_the_frame_just_holds_the_view() -> None:
    pair = rig(rotation_deg=(2, -5, 3))
    view = rb.view_angles(pair)
    rect = rb.Rectification.from_profiles(pair, angle(200.0), angle(200.0), angle(150.0))
    u_left, u_right, v = rect.left.target.u, rect.right.target.u, rect.left.target.v
    assert min(u_left(view.gamma_left.low), u_right(view.gamma_right.low)) == pytest.approx(-0.5)
    assert v(view.beta.low) == pytest.approx(-0.5)
    greatest = max(u_left(view.gamma_left.high), u_right(view.gamma_right.high)), v(view.beta.high)
    assert rect.size == tuple(math.ceil(edge + 0.5) for edge in greatest)
    for warp in (rect.left, rect.right):
        seen = warp.forward(rb.evaluation_pixels(warp.source))
        assert (seen >= -0.5).all()
        assert (seen <= np.array(rect.size) - 0.5).all()


def test_where_the_profiles_begin_does_not_matter_but_their_difference_does() -> None:
    pair = rig(rotation_deg=(2, -5, 3))
    plain = rb.Rectification.from_profiles(pair, angle(200), angle(200), angle(150))
    moved = rb.Rectification.from_profiles(pair, angle(200, 55.25), angle(200, 55.25), angle(150, -999))
    np.testing.assert_allclose(moved.maps("left"), plain.maps("left"), atol=1e-4)
    assert moved.size == plain.size
    apart = rb.Rectification.from_profiles(pair, angle(200), angle(200, 7.5), angle(150))
    assert apart.right.target.u(0.1) - apart.left.target.u(0.1) == pytest.approx(7.5)


def test_a_profile_shows_no_more_than_its_range_and_no_more_than_the_view() -> None:
    pair = rig()
    view = rb.view_angles(pair)
    narrow = rb.Cubic(0.0, 100.0, 0.0, 0.0, -0.2, 0.3)
    assert rb.Rectification.from_profiles(pair, narrow, narrow, angle(100)).size[0] == 50
    part = view._replace(beta=view.beta._replace(low=-0.1, high=0.2))
    assert rb.Rectification.from_profiles(pair, narrow, narrow, angle(100), view=part).size == (50, 30)


def test_profiles_without_finite_ends_are_refused() -> None:
    endless = rb.Radial("equidistant", 1e308, 0.0)
    with pytest.raises(rb.InvalidInput, match="span inf x"):
        rb.Rectification.from_profiles(rig(), endless, endless, angle(100))
