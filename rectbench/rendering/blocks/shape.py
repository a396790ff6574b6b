"""Shapes, what covers them, and models made of both.

A `Shape` is triangles whose uv counts metres on the surface; a `Finish` is a texture that knows how
many metres one repeat covers. So bricks come out 24 cm long whatever they are laid on.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.rendering.world import Material, Mesh
from rectbench.types import FloatArray

GOLDEN_STEPS = np.array([0.7548776662, 0.5698402910])
"""Multiples of these, modulo 1, fill the unit square evenly (Roberts' R2 sequence)."""


@dataclass(frozen=True, eq=False)
class Finish:
    """A material and the metres (along u, along v) that one repeat of its texture covers."""

    name: str
    material: Material
    tile_m: tuple[float, float] = (1.0, 1.0)
    seamless: bool = True
    """The texture has no edges, so every shape may start elsewhere on it and none repeats another."""


@dataclass(frozen=True, eq=False)
class Shape:
    """Triangles without a material: vertices [V, 3] metres, faces [F, 3], uv [V, 2] metres."""

    vertices: FloatArray
    faces: NDArray[np.int64]
    uv: FloatArray

    def at(
        self, x: float = 0.0, y: float = 0.0, z: float = 0.0, *, turn_deg: float = 0.0, scale: float = 1.0
    ) -> Shape:
        """The shape scaled, turned counter-clockwise about z (seen from above), then moved."""
        moved = self.vertices @ (scale * turn(turn_deg)).T + (x, y, z)
        return Shape(moved, self.faces, self.uv * scale)

    def tipped(self, axis: Sequence[float], angle_deg: float) -> Shape:
        """The shape turned by `angle_deg` about an axis through the origin."""
        return Shape(self.vertices @ rotation(axis, angle_deg).T, self.faces, self.uv)

    def of(self, finish: Finish) -> Model:
        """The shape covered with `finish`."""
        return Model(((self, finish),))

    def __add__(self, other: Shape) -> Shape:
        return join((self, other))


@dataclass(frozen=True, eq=False)
class Model:
    """Shapes with their finishes; models move as one and add up to larger ones."""

    parts: tuple[tuple[Shape, Finish], ...] = ()

    def at(
        self, x: float = 0.0, y: float = 0.0, z: float = 0.0, *, turn_deg: float = 0.0, scale: float = 1.0
    ) -> Model:
        """The model scaled, turned counter-clockwise about z, then moved; see `Shape.at`."""
        return Model(tuple((s.at(x, y, z, turn_deg=turn_deg, scale=scale), f) for s, f in self.parts))

    def tipped(self, axis: Sequence[float], angle_deg: float) -> Model:
        """The model turned about an axis through the origin."""
        return Model(tuple((s.tipped(axis, angle_deg), f) for s, f in self.parts))

    def __add__(self, other: Model) -> Model:
        return Model(self.parts + other.parts)


def turn(angle_deg: float) -> FloatArray:
    """Rotation [3, 3] about z, counter-clockwise seen from above."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation(axis: Sequence[float], angle_deg: float) -> FloatArray:
    """Rotation [3, 3] about `axis` (Rodrigues' formula)."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.radians(angle_deg)
    matrix: FloatArray = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    return matrix


def join(shapes: Iterable[Shape]) -> Shape:
    """One shape out of several."""
    shapes = tuple(shapes)
    counts = [len(shape.vertices) for shape in shapes]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    return Shape(
        np.concatenate([shape.vertices for shape in shapes]),
        np.concatenate([shape.faces + start for shape, start in zip(shapes, starts, strict=True)]),
        np.concatenate([shape.uv for shape in shapes]),
    )


def together(models: Iterable[Model]) -> Model:
    """One model out of several."""
    return Model(tuple(part for model in models for part in model.parts))


def meshes(models: Iterable[Model]) -> tuple[Mesh, ...]:
    """One mesh a finish: few large meshes load and trace faster than many small ones.

    Shapes with a seamless finish are laid on different places of its texture, so that two chairs of
    one wood do not look the same to a feature matcher.
    """
    by_finish: dict[int, tuple[Finish, list[Shape]]] = {}
    for shape, finish in together(models).parts:
        by_finish.setdefault(id(finish), (finish, []))[1].append(shape)
    return tuple(_mesh(finish, shapes) for finish, shapes in by_finish.values())


def _mesh(finish: Finish, shapes: list[Shape]) -> Mesh:
    laid = []
    for index, shape in enumerate(shapes):
        uv = shape.uv / finish.tile_m
        if finish.seamless:
            uv = uv + (index * GOLDEN_STEPS) % 1.0
        laid.append(Shape(shape.vertices, shape.faces, uv))
    whole = join(laid)
    return Mesh(finish.name, whole.vertices, whole.faces, whole.uv, finish.material)


def copies(model: Model, placements: ArrayLike) -> Model:
    """`model` at every placement [K, 4, 4].

    Real copies: Mitsuba compiles every `Instances` placement into the kernel, so that a wood of them
    takes a minute to compile, while a million triangles load in a second.
    """
    poses = np.asarray(placements, dtype=np.float64).reshape(-1, 4, 4)
    return Model(tuple((_copied(shape, poses), finish) for shape, finish in model.parts if len(poses)))


def _copied(shape: Shape, poses: FloatArray) -> Shape:
    count, size = len(poses), len(shape.vertices)
    vertices = shape.vertices @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
    faces = shape.faces + size * np.arange(count, dtype=np.int64)[:, None, None]
    return Shape(vertices.reshape(-1, 3), faces.reshape(-1, 3), np.tile(shape.uv, (count, 1)))


def placement(x: float, y: float, z: float = 0.0, turn_deg: float = 0.0, scale: float = 1.0) -> FloatArray:
    """World from mesh [4, 4]: scaled, turned about z, moved to (x, y, z) metres."""
    matrix = np.eye(4)
    matrix[:3, :3] = scale * turn(turn_deg)
    matrix[:3, 3] = x, y, z
    return matrix


def scattered(
    rng: np.random.Generator, places: ArrayLike, scale: tuple[float, float] = (0.8, 1.2)
) -> FloatArray:
    """Placements [K, 4, 4] at places [K, 3] metres, each turned and scaled by chance."""
    poses = [
        placement(float(x), float(y), float(z), rng.uniform(0.0, 360.0), rng.uniform(*scale))
        for x, y, z in np.asarray(places, dtype=float).reshape(-1, 3)
    ]
    return np.array(poses).reshape(-1, 4, 4)


def stand(x: float, y: float, z: float = 1.6, *, yaw_deg: float = 0.0, pitch_deg: float = 0.0) -> FloatArray:
    """World from camera [4, 4] of a camera at (x, y, z) metres that looks north.

    `yaw_deg` turns it to the left (west), `pitch_deg` up. Camera axes: x right, y down, z forward.
    """
    level = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    matrix = np.eye(4)
    matrix[:3, :3] = turn(yaw_deg) @ rotation((1.0, 0.0, 0.0), pitch_deg) @ level
    matrix[:3, 3] = x, y, z
    return matrix
