"""Shapes are metric, in their geometry and in their uv."""

from __future__ import annotations

import numpy as np
import pytest

from rectbench.rendering import blocks as b
from rectbench.rendering.blocks.shape import Shape


def extent(shape: Shape) -> np.ndarray:
    return np.ptp(shape.vertices, axis=0)


def test_box_has_its_size_and_stands_on_the_ground() -> None:
    shape = b.box(1.0, 2.0, 3.0)
    np.testing.assert_allclose(extent(shape), [1.0, 2.0, 3.0])
    assert shape.vertices[:, 2].min() == 0.0
    assert len(shape.faces) == 12


def test_uv_of_flat_faces_count_metres() -> None:
    wall = b.quads([[(0, 5, 0), (3, 5, 0), (3, 5, 2), (0, 5, 2)]])
    np.testing.assert_allclose(np.ptp(wall.uv, axis=0), [3.0, 2.0])


def test_u_runs_along_the_longest_side_of_a_plank() -> None:
    for size in ((2.0, 0.1, 0.1), (0.1, 2.0, 0.1), (0.1, 0.1, 2.0)):
        assert np.ptp(b.plank(*size).uv[:, 0]) == pytest.approx(2.0)


def test_tube_keeps_its_radius_round_a_bend() -> None:
    path = np.array([(0.0, 0, 0), (1, 0, 0.1), (2, 0, 0.4)])
    rings = b.tubes(path, 0.05, 8).vertices.reshape(3, 9, 3)
    np.testing.assert_allclose(np.linalg.norm(rings - path[:, None], axis=2), 0.05, atol=1e-12)


def test_moving_turns_counter_clockwise_then_shifts() -> None:
    point = b.boxes([1, 0, 0], [1, 0, 0]).at(10, 0, 5, turn_deg=90, scale=2).vertices[0]
    np.testing.assert_allclose(point, [10, 2, 5], atol=1e-12)


def test_tipping_keeps_distances() -> None:
    shape, tipped = b.box(1, 2, 3), b.box(1, 2, 3).tipped((1, 2, 3), 40)
    before, after = (np.linalg.norm(s.vertices - s.vertices[0], axis=1) for s in (shape, tipped))
    np.testing.assert_allclose(before, after)


@pytest.mark.parametrize(
    "shape",
    [
        b.box(1, 1, 1), b.cylinder(0.5, 1.0), b.ball(1, 1, 1), b.rod((0, 0, 0), (0, 0, 1), 0.1),
        b.cable((0, 0, 1), (1, 0, 1), 0.1), b.prism([(0, 0), (1, 0), (1, 1), (0, 1)], 0.5),
        b.boulder(np.random.default_rng(0), 1.0), b.floor((0, 1), (0, 1)), b.panel(1, 1),
    ],
)  # fmt: skip
def test_faces_name_existing_vertices(shape: Shape) -> None:
    assert np.isfinite(shape.vertices).all()
    assert np.isfinite(shape.uv).all()
    assert shape.uv.shape == (len(shape.vertices), 2)
    assert shape.faces.min() >= 0
    assert shape.faces.max() < len(shape.vertices)


def test_stand_looks_north_with_y_down() -> None:
    pose = b.stand(1, 2, 1.6)
    np.testing.assert_allclose(pose[:3, 2], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(pose[:3, 1], [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(pose[:3, 3], [1, 2, 1.6])
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)


def test_positive_yaw_looks_west_and_positive_pitch_up() -> None:
    assert b.stand(0, 0, yaw_deg=10)[0, 2] < 0
    assert b.stand(0, 0, pitch_deg=10)[2, 2] > 0


def test_meshes_join_what_shares_a_finish() -> None:
    oak, wool = b.timber(0), b.cloth(0, (0.2, 0.1, 0.1))
    joined = b.meshes([b.box(1, 1, 1).of(oak), b.box(1, 1, 1).of(wool), b.box(2, 2, 2).of(oak)])
    assert [mesh.name for mesh in joined] == ["timber", "cloth"]
    assert [len(mesh.faces) for mesh in joined] == [24, 12]


def test_equal_shapes_show_different_parts_of_a_texture() -> None:
    (mesh,) = b.meshes([b.box(1, 1, 1).of(finish) for finish in [b.timber(0)] * 2])
    first, second = mesh.uv.reshape(2, -1, 2)
    shift = second - first
    np.testing.assert_allclose(shift, np.broadcast_to(shift[0], shift.shape))
    assert (np.abs(shift[0]) > 0.1).all()


def test_copies_stand_where_they_are_placed() -> None:
    poses = [b.placement(0, 0, 0), b.placement(5, 0, 0, turn_deg=90, scale=2)]
    (mesh,) = b.meshes([b.copies(b.box(1, 1, 1).of(b.timber(0)), poses)])
    first, second = mesh.vertices.reshape(2, -1, 3)
    np.testing.assert_allclose(np.ptp(first, axis=0), 1.0)
    np.testing.assert_allclose(np.ptp(second, axis=0), 2.0)
    np.testing.assert_allclose(second.mean(axis=0), [5, 0, 1], atol=1e-12)


def test_copies_at_no_place_are_nothing() -> None:
    assert b.meshes([b.copies(b.box(1, 1, 1).of(b.timber(0)), np.empty((0, 4, 4)))]) == ()
