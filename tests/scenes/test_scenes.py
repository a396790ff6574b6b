"""The scenes are valid, repeatable, metric, clear of the cameras and well exposed."""

from __future__ import annotations

from functools import cache
from importlib import import_module

import numpy as np
import pytest

from rectbench.cameras import Camera
from rectbench.plugins.scene import Scene
from rectbench.rendering.pair import render_pair
from rectbench.rendering.world import World
from rectbench.rigs import Rig

NAMES = ("street", "corridor", "room", "forest")
SEEDS = (0, 1, 2)
CLEAR_M = 0.5
"""Least distance from a camera to any surface."""
BASELINES_M = (0.0, 0.2, 0.4, 0.6)


def scene(name: str) -> Scene:
    found: Scene = getattr(import_module(f"rectbench_scenes.{name}"), name)
    return found


@cache
def world(name: str, seed: int) -> World:
    return scene(name).build(seed)


def fisheye(size: int = 96) -> Camera:
    """All of 184 degrees within a square image."""
    focal = (size / 2) / np.radians(92.0)
    centre = size / 2 - 0.5
    params = {"fx": focal, "fy": focal, "cx": centre, "cy": centre}
    return Camera("equidistant", size=(size, size), params=params, max_angle_deg=92.0)


def sideways_rig(baseline_m: float = 0.1) -> Rig:
    return Rig(fisheye(), fisheye(), np.eye(3), np.array([-baseline_m, 0.0, 0.0]))


@pytest.mark.parametrize("name", NAMES)
def test_scene_says_what_it_shows(name: str) -> None:
    assert scene(name).name == name
    assert len(scene(name).summary) > 20


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_meshes_are_valid(name: str, seed: int) -> None:
    for mesh in world(name, seed).meshes:
        assert np.isfinite(mesh.vertices).all(), mesh.name
        assert np.isfinite(mesh.uv).all(), mesh.name
        assert mesh.uv.shape == (len(mesh.vertices), 2), mesh.name
        assert mesh.faces.min() >= 0, mesh.name
        assert mesh.faces.max() < len(mesh.vertices), mesh.name
        texels = np.asarray(mesh.material.reflectance)
        assert texels.min() >= 0.02 - 1e-6, mesh.name
        assert texels.max() <= 0.95 + 1e-6, mesh.name


@pytest.mark.parametrize("name", NAMES)
def test_same_seed_builds_the_same_world(name: str) -> None:
    first, again = world(name, 1), scene(name).build(1)
    np.testing.assert_array_equal(first.world_from_left, again.world_from_left)
    assert [mesh.name for mesh in first.meshes] == [mesh.name for mesh in again.meshes]
    for one, other in zip(first.meshes, again.meshes, strict=True):
        for field in ("vertices", "faces", "uv"):
            np.testing.assert_array_equal(getattr(one, field), getattr(other, field))
        np.testing.assert_array_equal(one.material.reflectance, other.material.reflectance)


@pytest.mark.parametrize("name", NAMES)
def test_another_seed_builds_another_world(name: str) -> None:
    first, second = world(name, 0), world(name, 1)
    assert not np.allclose(first.world_from_left, second.world_from_left)
    assert any(
        one.vertices.shape != other.vertices.shape or not np.allclose(one.vertices, other.vertices)
        for one, other in zip(first.meshes, second.meshes, strict=False)
    )


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_camera_stands_upright_at_eye_height(name: str, seed: int) -> None:
    pose = world(name, seed).world_from_left
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert 1.4 <= pose[2, 3] <= 1.9
    assert pose[1, 2] > 0.95  # looks north
    assert pose[2, 1] < -0.95  # y down


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_near_either_camera(name: str, seed: int) -> None:
    pose = world(name, seed).world_from_left
    corners = np.concatenate([mesh.vertices[mesh.faces] for mesh in world(name, seed).meshes])
    centre = pose[:3, 3]
    reach = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    near = np.linalg.norm(corners.mean(axis=1) - centre, axis=1) < reach + 2.0
    for baseline in BASELINES_M:
        point = centre + baseline * pose[:3, 0]
        assert distance_to_triangles(point, corners[near]) > CLEAR_M, f"baseline {baseline} m"


def distance_to_triangles(point: np.ndarray, corners: np.ndarray) -> float:
    """Least distance from a point to triangles [N, 3, 3]: to their edges, or to their plane inside."""
    start = corners
    edge = np.roll(corners, -1, axis=1) - start
    t = np.einsum("nkc,nkc->nk", point - start, edge) / np.maximum(
        np.einsum("nkc,nkc->nk", edge, edge), 1e-18
    )
    on_edge = start + np.clip(t, 0.0, 1.0)[..., None] * edge
    to_edges = np.linalg.norm(point - on_edge, axis=2).min()
    normal = np.cross(edge[:, 0], edge[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-18)
    inward = np.cross(normal[:, None], edge)
    inside = (np.einsum("nkc,nkc->nk", point - start, inward) > 0).all(axis=1)
    height = np.abs(np.einsum("nc,nc->n", point - start[:, 0], normal))
    return float(min(to_edges, height[inside].min(initial=np.inf)))


@pytest.mark.parametrize("name", NAMES)
def test_no_ray_below_the_horizon_escapes(name: str) -> None:
    _, truth = render_pair(world(name, 0), sideways_rig(), images=False, truth=True)
    rays, ok = fisheye().unproject(fisheye().pixel_grid())
    down = (rays @ world(name, 0).world_from_left[:3, :3].T)[..., 2]
    seen = np.isfinite(truth.depth_left)
    assert seen[ok & (down < -0.01)].all()
    if world(name, 0).sun is None:
        assert seen[ok].mean() > 0.95  # only the windows open


@pytest.mark.parametrize("name", NAMES)
def test_depths_span_from_half_a_metre_to_far(name: str) -> None:
    _, truth = render_pair(world(name, 0), sideways_rig(), images=False, truth=True)
    depth = truth.depth_left[np.isfinite(truth.depth_left)]
    assert depth.min() > CLEAR_M
    assert np.percentile(depth, 98) > (20.0 if world(name, 0).sun else 4.0)


@pytest.mark.parametrize("quality", ["fast", "path"])
@pytest.mark.parametrize("name", NAMES)
def test_image_is_well_exposed(name: str, quality: str) -> None:
    pair, _ = render_pair(world(name, 0), sideways_rig(), spp=16, quality=quality, truth=False)
    _, inside = fisheye().unproject(fisheye().pixel_grid())
    brightness = pair.left.mean(axis=2)[inside]
    assert 85 <= brightness.mean() <= 145
    assert (brightness < 8).mean() < 0.03
    assert (brightness > 247).mean() < 0.03
