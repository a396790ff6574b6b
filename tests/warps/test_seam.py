"""Views that go round an epipole: where the seam lies, and what is right at it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rectbench as rb
from rectbench.metrics.row_misfit import simulated_matches
from rectbench.warps.frame import forward_rotations, signed_baseline_m
from tests.rigs_for_tests import rig

AROUND = ("abraham", "local-homography")
SEE_BEHIND = ("ocam", "tiscamera", "quadcam")
"""Rigs whose lenses see past 90° from their axes far enough to see behind the cones about their epipoles."""


def forward_rig(**kwargs: object) -> rb.Rig:
    """Both epipoles in the middle of both views."""
    return rig(rotation_deg=(2.0, -3.0, 1.0), centre_m=(0.03, 0.01, 0.3), **kwargs)


def beta_seen(pair: rb.Rig) -> np.ndarray:
    """Of all pixels of both images, degrees."""
    found = []
    for camera, R in zip((pair.left, pair.right), rb.rectifying_rotations(pair), strict=True):
        rays, seen = camera.unproject(camera.pixel_grid())
        _, y, z = (rays[seen] @ R.T).T
        found.append(np.degrees(np.arctan2(y, z)))
    return np.concatenate(found)


@pytest.mark.parametrize("name", [name for name in rb.rig_names() if name not in SEE_BEHIND])
def test_the_frame_of_a_rig_that_does_not_see_the_seam_is_not_turned(name: str) -> None:
    pair = rb.load_rig(name).trimmed()
    for turned, ahead in zip(rb.rectifying_rotations(pair), forward_rotations(pair), strict=True):
        np.testing.assert_array_equal(turned, ahead)


def test_the_seam_lies_in_the_middle_of_what_nobody_sees() -> None:
    # The epipole a little above the view's lower edge: what is below it is not seen.
    pair = rig(rotation_deg=(0, 0, 0), centre_m=(0.0, 0.3 * np.sin(0.62), 0.3 * np.cos(0.62))).trimmed(7)
    beta = np.sort(beta_seen(pair))
    gaps = np.diff(beta, append=beta[0] + 360)
    assert gaps.max() > 20
    assert gaps.argmax() == len(beta) - 1  # across ±180°
    assert 360 - beta[-1] - 180 == pytest.approx(180 + beta[0], abs=3)
    low, high = np.degrees(rb.view_angles(pair).beta)
    assert low <= beta[0]
    assert beta[-1] <= high < 178


def test_a_seam_that_has_to_cut_cuts_where_the_fewest_pixels_are() -> None:
    pair = forward_rig(size=(480, 240)).trimmed()
    counts, _ = np.histogram(beta_seen(pair), bins=36, range=(-180, 180))
    ends = (counts[0] + counts[-1]) / 2
    assert ends <= 1.15 * counts.min()
    np.testing.assert_allclose(np.degrees(rb.view_angles(pair).beta), [-180, 180])


@pytest.mark.parametrize("method", AROUND)
def test_rows_go_all_around_and_the_ends_are_neighbours(method: str) -> None:
    rect = rb.rectify(forward_rig(), method=method)
    assert rect.turn_px is not None
    assert rect.size[1] - 1 < rect.turn_px <= rect.size[1]
    assert rect.rows_apart(rect.turn_px - 1.5, -0.25) == pytest.approx(-1.25)
    beside = np.array([[1, -1e-6, -1], [1, 1e-6, -1]])
    (top, below), _ = rect.left.target.project(beside)
    assert abs(rect.rows_apart(top[1], below[1])) < 1e-2 < abs(top[1] - below[1])


@pytest.mark.parametrize("method", AROUND)
def test_no_correspondence_is_torn_apart_by_the_seam(method: str) -> None:
    pair = forward_rig()
    left, right = simulated_matches(pair, 20_000, 3, 30)
    # Rounding of the pose puts some of the two images on different sides of the seam.
    rect = rb.rectify(replace(pair, t_right_left=pair.t_right_left + 1e-9), method=method)
    assert rb.metrics.row_error(rect, left, right).columns()["row_error_max_px"] < 1e-4


@pytest.mark.parametrize("method", AROUND)
def test_tables_and_masks_at_the_seam_read_what_is_there(method: str) -> None:
    rect = rb.rectify(forward_rig(size=(320, 320)), method=method)
    for side in ("left", "right"):
        map_x, map_y = rect.maps(side)
        for row in (0, rect.size[1] - 1):
            places = np.column_stack([np.arange(rect.size[0]), np.full(rect.size[0], row)])
            source = rect.warp(side).inverse(places)
            known = np.isfinite(source).all(axis=1)
            assert known.sum() > 50
            read = np.stack([map_x[row], map_y[row]], axis=-1)
            np.testing.assert_allclose(read[known], source[known], atol=1e-3)
        first, last = (rect.valid(side)[row] for row in (0, -1))
        assert (first != last).mean() < 0.1


@pytest.mark.parametrize("method", AROUND)
def test_a_wrapped_seam_shows_once_more_what_lies_beyond_it(method: str) -> None:
    rect = rb.rectify(forward_rig(size=(320, 320)), method=method)
    wrapped = rb.framed(rect, rb.Framing(seam="wrap"))
    extra = (wrapped.size[1] - rect.size[1]) / 2
    assert extra == pytest.approx(rect.turn_px / 36, abs=1)
    pixels = rb.evaluation_pixels(wrapped.left.source, 2000)
    there = wrapped.left.forward(pixels)
    np.testing.assert_allclose(wrapped.left.inverse(there), pixels, atol=1e-6)
    # The same source pixel, a turn farther down where that is still in the image.
    again = there + np.array([0, wrapped.turn_px])
    again = again[again[:, 1] < wrapped.size[1] - 0.5]
    assert len(again) > 10
    np.testing.assert_allclose(
        wrapped.left.forward(wrapped.left.inverse(again)), again - [0, wrapped.turn_px], atol=1e-6
    )
    left, right = simulated_matches(forward_rig(size=(320, 320)), 3000, 3, 30)
    assert rb.metrics.row_error(wrapped, left, right).columns()["row_error_max_px"] < 1e-6


def test_where_there_is_no_seam_wrapping_changes_nothing() -> None:
    rect = rb.rectify(rb.load_rig("t265"), method="abraham")
    wrapped = rb.framed(rect, rb.Framing(seam="wrap"))
    assert rect.turn_px is None
    assert wrapped.size == rect.size
    np.testing.assert_array_equal(wrapped.maps("left"), rect.maps("left"))


def test_a_method_without_a_seam_says_so() -> None:
    rect = rb.rectify(forward_rig(), method="conventional")
    with pytest.raises(rb.InvalidInput, match="seam is 'wrap', but a perspective image has none"):
        rb.framed(rect, rb.Framing(seam="wrap"))
    with pytest.raises(rb.InvalidInput, match="seam is 'sew'; expected cut or wrap"):
        rb.Framing(seam="sew")  # type: ignore[arg-type]
    with pytest.raises(rb.InvalidInput, match="seam wrap stands beside crop"):
        rb.Framing(seam="wrap", crop="valid")


def test_a_rectification_with_a_seam_is_written_and_read_to_the_last_bit(tmp_path: Path) -> None:
    rect = rb.framed(rb.rectify(forward_rig(), method="abraham"), rb.Framing(seam="wrap", pixels=2e5))
    rb.save_rectification(rect, tmp_path / "rectified.yaml")
    again = rb.load_rectification(tmp_path / "rectified.yaml")
    assert again.rig == rect.rig
    assert again.turn_px == rect.turn_px
    for side in ("left", "right"):
        np.testing.assert_array_equal(again.maps(side), rect.maps(side))


@pytest.mark.parametrize(
    ("centre_m", "positive"),
    [
        ((0.0, 0.2, 0.0), True),
        ((-0.004, 0.2, 0.003), True),  # a vertical rig whose upper camera is a little to the left
        ((-0.004, -0.2, 0.0), True),
        ((-0.1, 0.12, 0.0), True),
        ((0.0, 0.0, 0.2), True),
        ((-0.01, 0.0, -0.2), True),
        ((-0.2, 0.01, 0.0), False),
    ],
)
def test_only_the_disparity_of_a_swapped_pair_is_negative(
    centre_m: tuple[float, float, float], positive: bool
) -> None:
    assert (signed_baseline_m(rig(centre_m=centre_m)) > 0) == positive
