"""Depth, visibility and correspondences against geometry that can be written down."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_worlds import facing_wall, world_of

from rectbench.errors import InvalidInput
from rectbench.rendering.mitsuba_scene import fast_scene
from rectbench.rendering.tracing import trace_truth
from rectbench.rendering.truth import Truth
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import Material, World
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

GREY = Material((0.5, 0.5, 0.5))


@pytest.fixture(scope="module")
def truth(yard: World, rig: Rig) -> Truth:
    return trace_truth(fast_scene(yard), rig, yard.world_from_left)


def rays_of(rig: Rig) -> FloatArray:
    return rig.left.unproject(rig.left.pixel_grid())[0]


@pytest.mark.parametrize("distance", [0.5, 20.0, 300.0])
def test_a_plane_has_its_analytic_depth(rig: Rig, distance: float) -> None:
    world = world_of(facing_wall(distance, 10 * distance, GREY))
    truth = trace_truth(fast_scene(world), rig, world.world_from_left)
    rays = rays_of(rig)
    with np.errstate(invalid="ignore", divide="ignore"):
        expected = distance / rays[..., 2]
        on_wall = (expected > 0) & (np.abs(expected[..., None] * rays[..., :2]).max(axis=-1) < 9 * distance)
    assert on_wall.sum() > 1000
    np.testing.assert_allclose(truth.depth_left[on_wall], expected[on_wall], rtol=1e-5)
    assert np.isnan(truth.depth_left[~(rays[..., 2] > 0)]).all()
    assert np.isfinite(truth.points_left[on_wall]).all()


def test_a_sphere_has_its_analytic_depth_and_hides_its_back(rig: Rig) -> None:
    mi = mitsuba()
    rig = rig.scaled(2)
    centre, radius = np.array([0.2, -0.1, 2.5]), 1.8
    scene = mi.load_dict(
        {"type": "scene", "ball": {"type": "sphere", "center": list(centre), "radius": radius}}
    )
    truth = trace_truth(scene, rig, np.eye(4))
    along = rays_of(rig) @ centre
    with np.errstate(invalid="ignore"):
        square = radius**2 - (centre @ centre - along**2)
        hit = (square > 1e-3) & (along > 0)
        expected = along - np.sqrt(square)
    np.testing.assert_allclose(truth.depth_left[hit], expected[hit], rtol=1e-5)
    # A point of the sphere is seen from the right where its normal faces the right camera.
    normal = truth.points_left - centre
    facing = ((rig.centre_right_in_left - truth.points_left) * normal).sum(axis=-1)
    np.testing.assert_array_equal(truth.visible_left[hit], facing[hit] > 0)
    assert 0 < (facing[hit] < 0).sum() < hit.sum()


def test_what_a_post_hides_from_the_other_camera_is_not_visible(rig: Rig) -> None:
    post, far = 2.0, 5.0
    world = world_of(facing_wall(far, 40.0, GREY), facing_wall(post, 0.25, GREY))
    truth = trace_truth(fast_scene(world), rig, world.world_from_left)
    points = truth.points_left
    on_wall = np.abs(points[..., 2] - far) < 1e-3
    centre = rig.centre_right_in_left
    way = points - centre
    crossing = centre + way * ((post - centre[2]) / way[..., 2])[..., None]
    hidden = np.abs(crossing[..., :2]).max(axis=-1) < 0.25
    in_view = rig.right.sees(rig.right_from_left(np.where(on_wall[..., None], points, 1.0)))
    assert (hidden & on_wall).sum() > 10
    np.testing.assert_array_equal(truth.visible_left[on_wall], (~hidden & in_view)[on_wall])


def test_points_project_back_onto_their_pixel_even_from_float32(rig: Rig) -> None:
    world = world_of(facing_wall(20.0, 100.0, GREY))
    fine = rig.scaled(8)
    truth = trace_truth(fast_scene(world), fine, world.world_from_left)
    stored = truth.points_left.astype(np.float32).astype(np.float64)
    seen = np.isfinite(stored).all(axis=-1)
    pixels, _ = fine.left.project(stored[seen])
    assert np.abs(pixels - fine.left.pixel_grid()[seen]).max() < 1e-3
    # The same with the wall's own points: the error that the renderer's float32 adds.
    exact = stored[seen].copy()
    exact *= 20.0 / exact[:, 2:]
    pixels_right, ok = fine.right.project(fine.right_from_left(exact))
    error = np.linalg.norm(pixels_right - truth.px_right_of_left[seen], axis=-1)
    assert np.nanmax(error[ok]) < 0.02


def test_correspondences_lie_on_epipolar_lines_to_rounding(truth: Truth, rig: Rig) -> None:
    left, right = truth.matches(500, seed=1)
    ray_left, ray_right = rig.left.unproject(left)[0], rig.right.unproject(right)[0]
    assert np.abs(np.einsum("ni,ij,nj->n", ray_right, rig.essential_matrix, ray_left)).max() < 1e-9


def test_the_two_sides_tell_the_same(truth: Truth, rig: Rig) -> None:
    left, right = truth.matches(2000)
    nearest = np.round(right).astype(int)
    depth_right = truth.depth_right[nearest[:, 1], nearest[:, 0]]
    u, v = left.astype(int).T
    distance = np.linalg.norm(rig.right_from_left(truth.points_left[v, u]), axis=-1)
    close = np.abs(depth_right - distance) < 0.1 * distance
    assert close.mean() > 0.9
    back = truth.px_left_of_right[nearest[:, 1], nearest[:, 0]][close]
    assert np.nanmedian(np.linalg.norm(back - left[close], axis=-1)) < 1.0


def test_matches_are_visible_spread_and_repeatable(truth: Truth) -> None:
    left, right = truth.matches(300, seed=5)
    assert left.shape == right.shape == (300, 2)
    u, v = left.astype(int).T
    np.testing.assert_array_equal(left, np.stack([u, v], axis=-1))
    assert truth.visible_left[v, u].all()
    np.testing.assert_allclose(right, truth.px_right_of_left[v, u], atol=1e-9)
    assert len(np.unique(left, axis=0)) == 300
    np.testing.assert_array_equal(left, truth.matches(300, seed=5)[0])
    assert not np.array_equal(left, truth.matches(300, seed=6)[0])

    # Every block of the image where enough is visible gets its share, which chance alone would not give.
    blocks = truth.visible_left[:72, :96].reshape(6, 12, 8, 12).mean(axis=(1, 3))
    counts, _, _ = np.histogram2d(v, u, bins=[np.arange(0, 73, 12), np.arange(0, 97, 12)])
    assert counts[blocks > 0.9].min() >= 0.4 * 300 / 48


def test_fewer_visible_points_than_asked_for_gives_them_all(truth: Truth) -> None:
    left, _ = truth.matches(10**6)
    assert len(left) == truth.visible_left.sum()


def test_noise_on_matches_has_the_stated_size(truth: Truth) -> None:
    clean_left, clean_right = truth.matches(2000, seed=2)
    left, right = truth.matches(2000, seed=2, noise_px=0.5)
    for noise in (left - clean_left, right - clean_right):
        assert noise.std() == pytest.approx(0.5, rel=0.05)
        assert abs(noise.mean()) < 0.03


def test_no_common_point_is_a_clear_error(rig: Rig) -> None:
    world = world_of(facing_wall(3.0, 1.0, GREY))
    turned = replace(rig, R_right_left=np.diag([-1.0, 1.0, -1.0]))
    truth = trace_truth(fast_scene(world), turned, world.world_from_left)
    with pytest.raises(InvalidInput, match="no point is seen by both cameras"):
        truth.matches()


@pytest.mark.parametrize(("n", "noise"), [(0, 0.0), (10, -1.0), (10, float("nan"))])
def test_matches_refuses_what_makes_no_sense(truth: Truth, n: int, noise: float) -> None:
    with pytest.raises(InvalidInput, match="expected n from 1"):
        truth.matches(n, noise_px=noise)


def test_a_saved_truth_comes_back_the_same(truth: Truth, tmp_path: Path) -> None:
    truth.save(tmp_path / "truth.npz")
    loaded = Truth.load(tmp_path / "truth.npz")
    assert loaded.rig == truth.rig
    for name in (
        "depth_left",
        "depth_right",
        "visible_left",
        "visible_right",
        "points_left",
        "px_left_of_right",
    ):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(truth, name))
    with np.load(tmp_path / "truth.npz", allow_pickle=False) as file:
        assert file["points_right"].dtype == np.float32
        np.testing.assert_array_equal(file["px_other_left"], truth.px_right_of_left.astype(np.float32))


def test_exr_files_hold_named_channels(truth: Truth, tmp_path: Path) -> None:
    truth.save_exr(tmp_path)
    mi = mitsuba()
    bitmap = mi.Bitmap(str(tmp_path / "right.exr"))
    channels = {field.name: i for i, field in enumerate(bitmap.struct_())}
    assert set(channels) == {"depth", "point.x", "point.y", "point.z", "px.u", "px.v", "visible"}
    values = np.array(bitmap)
    np.testing.assert_array_equal(values[..., channels["depth"]], truth.depth_right)
    np.testing.assert_array_equal(
        values[..., channels["px.v"]], truth.px_left_of_right[..., 1].astype(np.float32)
    )
    np.testing.assert_array_equal(values[..., channels["visible"]] == 1, truth.visible_right)


@pytest.mark.parametrize("content", [b"", b"not a zip", None])
def test_a_file_that_is_no_truth_is_a_clear_error(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "truth.npz"
    if content is None:
        np.savez(path, depth_left=np.zeros(3))
    else:
        path.write_bytes(content)
    with pytest.raises(InvalidInput, match="not a truth file"):
        Truth.load(path)


def test_arrays_of_the_wrong_size_are_refused(truth: Truth) -> None:
    with pytest.raises(InvalidInput, match="depth_left has shape"):
        replace(truth, depth_left=truth.depth_left[1:])


def test_large_images_are_traced_in_bands_without_a_seam(
    yard: World, rig: Rig, truth: Truth, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rectbench.rendering.tracing.RAYS_AT_ONCE", 1000)
    banded = trace_truth(fast_scene(yard), rig, yard.world_from_left)
    np.testing.assert_allclose(banded.depth_left, truth.depth_left, rtol=1e-6)
    assert (banded.visible_left != truth.visible_left).mean() < 1e-3
