"""Things have the size that such things have, and valid triangles."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from rectbench.rendering import blocks as b
from rectbench.rendering.blocks.shape import Finish, Model
from rectbench.rendering.world import Material

PLAIN = Finish("plain", Material(np.full((2, 2, 3), 0.5, dtype=np.float32)))
LEAVES = b.foliage(0)
SHEETS = b.posters(0)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def stone_house() -> Model:
    finishes = b.HouseFinishes(PLAIN, PLAIN, PLAIN, PLAIN, PLAIN, b.window_panes(0))
    return b.house(rng(), finishes, width=10.0, depth=8.0, storeys=2)


THINGS: dict[str, tuple[Callable[[], Model], tuple[float, float]]] = {
    "bare tree": (lambda: b.bare_tree(0, PLAIN, height=5), (4.0, 7.5)),
    "bench": (lambda: b.bench(PLAIN, PLAIN), (0.8, 1.0)),
    "bicycle": (lambda: b.bicycle(PLAIN, PLAIN), (0.95, 1.15)),
    "birch": (lambda: b.birch(0, PLAIN, LEAVES, height=10), (9.0, 12.5)),
    "bollard": (lambda: b.bollard(PLAIN), (0.9, 1.0)),
    "bookcase": (lambda: b.bookcase(rng(), PLAIN, b.book_spines(0), b.parcels(0)), (2.0, 2.3)),
    "broadleaf": (lambda: b.broadleaf(0, PLAIN, LEAVES, height=8), (7.0, 11.0)),
    "bush": (lambda: b.bush(0, PLAIN, LEAVES, height=1.2), (0.9, 2.4)),
    "cabinet": (lambda: b.cabinet(PLAIN, PLAIN), (0.78, 0.9)),
    "car": (lambda: b.car(PLAIN, PLAIN, PLAIN, PLAIN), (1.4, 1.55)),
    "chair": (lambda: b.chair(PLAIN, PLAIN), (0.85, 1.0)),
    "desk lamp": (lambda: b.desk_lamp(PLAIN, PLAIN), (0.4, 0.55)),
    "door": (lambda: b.door(PLAIN, PLAIN, PLAIN, SHEETS, 0), (2.1, 2.25)),
    "extinguisher": (lambda: b.extinguisher(PLAIN, PLAIN), (0.5, 0.65)),
    "fern": (lambda: b.fern(0, LEAVES), (0.2, 1.0)),
    "floor lamp": (lambda: b.floor_lamp(PLAIN, PLAIN), (1.5, 1.7)),
    "grass": (lambda: b.grass_tuft(0, LEAVES, height=0.2), (0.1, 0.35)),
    "hedge": (lambda: b.hedge(0, PLAIN, LEAVES, height=1.3), (1.2, 1.7)),
    "house": (stone_house, (9.0, 13.5)),
    "lamp post": (lambda: b.lamp_post(PLAIN, PLAIN), (4.5, 4.7)),
    "litter bin": (lambda: b.litter_bin(PLAIN, PLAIN), (0.75, 0.95)),
    "lockers": (lambda: b.lockers(PLAIN, PLAIN), (1.75, 1.85)),
    "log": (lambda: b.log(0, PLAIN), (0.3, 1.3)),
    "monitor": (lambda: b.monitor(PLAIN, SHEETS, 0), (0.4, 0.5)),
    "parcel": (lambda: b.parcel(b.parcels(0), (0.4, 0.3, 0.2), 3), (0.19, 0.21)),
    "pillar box": (lambda: b.pillar_box(PLAIN, PLAIN), (1.55, 1.65)),
    "potted plant": (lambda: b.potted_plant(0, PLAIN, PLAIN, LEAVES, height=1.0), (0.7, 1.6)),
    "rail fence": (lambda: b.rail_fence(PLAIN, rng(), length=6), (1.0, 1.5)),
    "railing": (lambda: b.railing(PLAIN, length=4), (1.05, 1.2)),
    "sofa": (lambda: b.sofa(PLAIN, PLAIN, PLAIN), (0.75, 1.0)),
    "spruce": (lambda: b.spruce(0, PLAIN, LEAVES, height=11), (10.0, 12.5)),
    "step ladder": (lambda: b.step_ladder(PLAIN, PLAIN), (1.65, 1.8)),
    "stool": (lambda: b.stool(PLAIN), (0.44, 0.49)),
    "table": (lambda: b.table(PLAIN), (0.73, 0.75)),
    "vase": (lambda: b.vase(PLAIN, height=0.3), (0.29, 0.31)),
}
"""What makes the thing, and between which heights it ends, metres."""


@pytest.mark.parametrize("name", THINGS)
def test_thing_is_as_high_as_such_things_are(name: str) -> None:
    make, (least, most) = THINGS[name]
    top = max(shape.vertices[:, 2].max() for shape, _ in make().parts)
    assert least <= top <= most


@pytest.mark.parametrize("name", THINGS)
def test_thing_has_valid_triangles(name: str) -> None:
    for mesh in b.meshes([THINGS[name][0]()]):
        assert np.isfinite(mesh.vertices).all()
        assert np.isfinite(mesh.uv).all()
        assert mesh.uv.shape == (len(mesh.vertices), 2)
        assert mesh.faces.min() >= 0
        assert mesh.faces.max() < len(mesh.vertices)


def test_a_seat_is_45_cm_high() -> None:
    _, (seat, _) = b.chair(PLAIN, PLAIN).parts
    assert seat.vertices[:, 2].max() == pytest.approx(0.45, abs=0.03)


def test_a_car_is_four_metres_long() -> None:
    corners = np.concatenate([shape.vertices for shape, _ in b.car(PLAIN, PLAIN, PLAIN, PLAIN).parts])
    assert np.ptp(corners[:, 0]) == pytest.approx(4.3, abs=0.2)
    assert corners[:, 2].min() == pytest.approx(0.0, abs=0.02)


def test_a_wall_is_open_where_its_windows_are() -> None:
    hole = b.Opening(-0.5, 0.5, 1.0, 2.0)
    wall = b.pierced_wall(4.0, 3.0, [hole])
    flat = np.abs(wall.vertices[wall.faces][..., 1]).max(axis=1) < 1e-9
    corners = wall.vertices[wall.faces[flat]]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert area.sum() == pytest.approx(4.0 * 3.0 - 1.0)


def test_less_detail_means_fewer_but_larger_leaves() -> None:
    fine, coarse = (b.broadleaf(0, PLAIN, LEAVES, detail=detail).parts[1][0] for detail in (1.0, 0.1))
    assert len(coarse.faces) < 0.15 * len(fine.faces)
    areas = [_area(shape) for shape in (fine, coarse)]
    assert areas[1] == pytest.approx(areas[0], rel=0.25)


def _area(shape: b.Shape) -> float:
    corners = shape.vertices[shape.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(normals, axis=1).sum())


def test_a_plant_grows_the_same_way_from_the_same_seed() -> None:
    first, again, other = (b.birch(seed, PLAIN, LEAVES, detail=0.2).parts[1][0] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.vertices, again.vertices)
    assert not np.array_equal(first.vertices, other.vertices)
