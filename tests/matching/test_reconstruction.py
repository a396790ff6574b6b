"""Reconstruction: the points are those of the scene, and the cloud is a file that others read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

import rectbench as rb
from tests.matching.sphere_room import CENTRE_BASELINES, RADIUS_BASELINES, sphere_pair, true_disparity
from tests.rigs_for_tests import rig

METHODS = ("conventional", "abraham", "local-homography", "hartley", "fusiello")
ROOM = rig("kannala-brandt", size=(240, 160))
PAIR = sphere_pair(ROOM)


def off_the_sphere(points: np.ndarray) -> np.ndarray:
    """How far points [N, 3] are from the surface, relative to its radius."""
    centre, radius = CENTRE_BASELINES * ROOM.baseline_m, RADIUS_BASELINES * ROOM.baseline_m
    return np.abs(np.linalg.norm(points - centre, axis=-1) / radius - 1)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_finds_the_surface(method: str) -> None:
    rect = rb.rectify(ROOM, method=method)
    found = rb.reconstruct(rect, PAIR.left, PAIR.right)
    points, colours = found.cloud()
    assert points.shape == colours.shape
    assert len(points) > 0.6 * rect.valid("left").sum()
    assert np.median(off_the_sphere(points)) < 0.02
    assert found.points.shape == (*found.disparity.px.shape, 3)
    np.testing.assert_allclose(
        found.depth[np.isfinite(found.depth)], np.linalg.norm(points, axis=1), rtol=1e-6
    )


@pytest.mark.parametrize("method", METHODS)
def test_the_true_disparity_gives_the_true_points_at_any_size(method: str) -> None:
    rect = rb.rectify(ROOM, method=method)
    # A homography fitted to matches is not exactly the rig's, so that its rows differ by a hair.
    tolerance = 1e-5 if method not in ("hartley", "fusiello") else 1e-2
    for factor in (1.0, 0.6):
        points, _ = rb.Reconstruction(true_disparity(rect.scaled(factor))).cloud()
        assert len(points) > 100
        assert off_the_sphere(points).max() < tolerance


def test_points_beyond_the_limit_are_left_out() -> None:
    disparity = true_disparity(rb.rectify(ROOM, method="abraham"))
    near = rb.Reconstruction(disparity, farthest_baselines=17.0)
    points, _ = near.cloud()
    distance = np.linalg.norm(points, axis=1) / ROOM.baseline_m
    assert distance.max() <= 17.0
    assert 0 < len(points) < len(rb.Reconstruction(disparity).cloud()[0])
    with pytest.raises(rb.InvalidInput, match="farthest_baselines is -1"):
        rb.Reconstruction(disparity, farthest_baselines=-1)


def test_colours_are_those_of_the_left_image() -> None:
    rect = rb.rectify(ROOM, method="abraham")
    found = rb.reconstruct(rect, PAIR.left, PAIR.right)
    shown, _ = rect.remap(PAIR.left, PAIR.right)
    exist = np.isfinite(found.depth)
    assert np.array_equal(found.colours[exist], shown[exist])


def test_the_ply_file_holds_points_and_colours(tmp_path: Path) -> None:
    found = rb.Reconstruction(
        replace(
            true_disparity(rect := rb.rectify(ROOM, method="abraham")),
            image=np.asarray(rect.remap(PAIR.left, PAIR.right)[0]),
        )
    )
    found.save_ply(tmp_path / "cloud.ply")
    cloud = trimesh.load(tmp_path / "cloud.ply")
    points, colours = found.cloud()
    np.testing.assert_allclose(cloud.vertices, points, rtol=1e-5, atol=1e-6)
    assert np.array_equal(np.asarray(cloud.colors)[:, :3], colours)


def test_a_cloud_without_points_is_no_file(tmp_path: Path) -> None:
    black = np.zeros((160, 240), np.uint8)
    nothing = rb.reconstruct(rb.rectify(ROOM), black, black, lambda left, *_: np.full(left.shape[:2], np.nan))
    assert len(nothing.cloud()[0]) == 0
    with pytest.raises(rb.InvalidInput, match="no pixel of the pair has a depth"):
        nothing.save_ply(tmp_path / "cloud.ply")
    assert not (tmp_path / "cloud.ply").exists()


def test_what_is_no_rectification_is_refused() -> None:
    with pytest.raises(rb.InvalidInput, match="rect is Rig; expected a Rectification"):
        rb.reconstruct(ROOM, PAIR.left, PAIR.right)  # type: ignore[arg-type]
