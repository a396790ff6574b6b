"""Simple shapes, metric, to build everything else from: boxes, tubes, turned and lofted surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from rectbench.rendering.blocks.shape import Shape
from rectbench.types import FloatArray

_BOX_FACES = np.array([
    [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]],  # south
    [[1, 1, 0], [0, 1, 0], [0, 1, 1], [1, 1, 1]],  # north
    [[0, 1, 0], [0, 0, 0], [0, 0, 1], [0, 1, 1]],  # west
    [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]],  # east
    [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],  # top
    [[0, 1, 0], [1, 1, 0], [1, 0, 0], [0, 0, 0]],  # bottom
])  # fmt: skip


def quads(corners: ArrayLike) -> Shape:
    """Flat four-cornered faces [N, 4, 3], corners in order around each.

    uv are metres in the plane, u horizontal and v up the slope, so that textures run on from one
    face to the next in the same plane.
    """
    corners = np.asarray(corners, dtype=float).reshape(-1, 4, 3)
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    along = np.cross((0.0, 0.0, 1.0), normal)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length < 1e-6, (1.0, 0.0, 0.0), along / np.maximum(length, 1e-6))
    up = np.cross(normal, along)
    uv = np.stack([np.einsum("nkc,nc->nk", corners, axis) for axis in (along, up)], axis=-1)
    return Shape(corners.reshape(-1, 3), _quad_faces(len(corners)), uv.reshape(-1, 2))


def cards(corners: ArrayLike) -> Shape:
    """Four-cornered faces [N, 4, 3] whose uv run 0..1 from the first corner, for prints."""
    corners = np.asarray(corners, dtype=float).reshape(-1, 4, 3)
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return Shape(corners.reshape(-1, 3), _quad_faces(len(corners)), np.tile(unit, (len(corners), 1)))


def _quad_faces(count: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    first = 4 * np.arange(count, dtype=np.int64)[:, None]
    return np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])])


def panel(width: float, height: float) -> Shape:
    """An upright card that faces south, its lower left corner at the origin; uv 0..1."""
    return cards([[(0, 0, 0), (width, 0, 0), (width, 0, height), (0, 0, height)]])


def boxes(low: ArrayLike, high: ArrayLike) -> Shape:
    """Axis-aligned boxes between corners [N, 3] and [N, 3]; u runs horizontally on every side."""
    low, high = np.atleast_2d(np.asarray(low, dtype=float)), np.atleast_2d(np.asarray(high, dtype=float))
    corners = np.where(_BOX_FACES, high[:, None, None, :], low[:, None, None, :])
    return quads(corners)


def box(width: float, depth: float, height: float) -> Shape:
    """A box standing on z = 0, centred on the origin."""
    return boxes([-width / 2, -depth / 2, 0.0], [width / 2, depth / 2, height])


def plank(width: float, depth: float, height: float) -> Shape:
    """A `box` whose u follows its longest side: the way grain runs in timber."""
    shape = box(width, depth, height)
    axis = int(np.argmax((width, depth, height)))
    others = [k for k in range(3) if k != axis]
    v = shape.vertices
    return Shape(v, shape.faces, np.stack([v[:, axis], v[:, others[0]] + v[:, others[1]]], axis=1))


def loft(sections: ArrayLike, closed: bool = True) -> Shape:
    """The skin through sections [K, N, 3]; `closed` joins each section's last point to its first.

    u runs around and v from section to section, in metres.
    """
    sections = np.asarray(sections, dtype=float)
    if closed:
        sections = np.concatenate([sections, sections[:, :1]], axis=1)
    rows, columns = sections.shape[:2]
    around = np.linalg.norm(np.diff(sections, axis=1), axis=2).sum(axis=1).max() * np.linspace(0, 1, columns)
    step = np.linalg.norm(np.diff(sections, axis=0), axis=2).mean(axis=1)
    along = np.concatenate([[0.0], np.cumsum(step)])
    uv = np.stack(np.meshgrid(around, along), axis=-1)
    return Shape(sections.reshape(-1, 3), _grid_faces(rows, columns), uv.reshape(-1, 2))


def _grid_faces(rows: int, columns: int) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    first = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).reshape(-1, 1)
    return np.concatenate([
        first + np.array([0, 1, columns + 1]), first + np.array([0, columns + 1, columns])
    ]).astype(np.int64)  # fmt: skip


def tubes(paths: ArrayLike, radii: ArrayLike, sides: int = 8) -> Shape:
    """Round tubes along polylines [B, K, 3] with radii [B, K] (or one radius), metres.

    u runs around and v along, in metres.
    """
    paths = np.asarray(paths, dtype=float)
    paths = paths[None] if paths.ndim == 2 else paths
    count, knots = paths.shape[:2]
    radius = np.broadcast_to(np.asarray(radii, dtype=float), (count, knots))
    first, second = _frames(paths)
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    ring = np.cos(angle)[:, None] * first[:, :, None, :] + np.sin(angle)[:, None] * second[:, :, None, :]
    vertices = paths[:, :, None, :] + radius[:, :, None, None] * ring
    step = np.linalg.norm(np.diff(paths, axis=1), axis=2)
    along = np.concatenate([np.zeros((count, 1)), np.cumsum(step, axis=1)], axis=1)
    around = radius.max(axis=1)[:, None, None] * angle
    uv = np.stack(np.broadcast_arrays(around, along[:, :, None]), axis=-1)
    per_tube = knots * (sides + 1)
    faces = _grid_faces(knots, sides + 1) + per_tube * np.arange(count)[:, None, None]
    return Shape(vertices.reshape(-1, 3), faces.reshape(-1, 3), uv.reshape(-1, 2))


def _frames(paths: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two unit vectors [B, K, 3] across the paths, steady along each."""
    ahead = np.gradient(paths, axis=1)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=2, keepdims=True), 1e-12)
    overall = paths[:, -1] - paths[:, 0]
    upright = np.abs(overall[:, 2]) > 0.7 * np.linalg.norm(overall, axis=1)
    reference = np.where(upright[:, None], (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))[:, None, :]
    first = np.cross(ahead, reference)
    first /= np.maximum(np.linalg.norm(first, axis=2, keepdims=True), 1e-12)
    return first, np.cross(ahead, first)


def rod(start: Sequence[float], end: Sequence[float], radius: float, sides: int = 8) -> Shape:
    """A straight round bar between two points."""
    return tubes([[start, end]], radius, sides)


def cable(start: Sequence[float], end: Sequence[float], sag: float, radius: float = 0.006) -> Shape:
    """A hanging cable that dips `sag` metres below the straight line."""
    t = np.linspace(0.0, 1.0, 17)[:, None]
    line = np.asarray(start) + t * (np.asarray(end) - np.asarray(start))
    return tubes(line - [0.0, 0.0, 1.0] * (4.0 * sag * t * (1.0 - t)), radius, 6)


def turned(profile: Sequence[tuple[float, float]], sides: int = 24) -> Shape:
    """A profile of (radius, z) metres turned about the z axis, as on a lathe."""
    radius, z = np.asarray(profile, dtype=float).T
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    level = np.broadcast_to(z[:, None], (len(z), sides))
    sections = np.stack([np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle)), level], axis=-1)
    return loft(sections)


def cylinder(radius: float, height: float, sides: int = 24) -> Shape:
    """A closed cylinder standing on z = 0."""
    return turned([(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)], sides)


def ball(width: float, depth: float, height: float, roundness: float = 1.0) -> Shape:
    """An ellipsoid standing on z = 0; below 1, `roundness` squares it off into a cushion."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, 13)
    longitude = np.linspace(0, 2 * np.pi, 24, endpoint=False)

    def bent(values: FloatArray) -> FloatArray:
        return np.sign(values) * np.abs(values) ** roundness

    level = bent(np.cos(latitude))[:, None]
    sections = np.stack([
        width / 2 * level * bent(np.cos(longitude)),
        depth / 2 * level * bent(np.sin(longitude)),
        np.broadcast_to(height / 2 * (1.0 + bent(np.sin(latitude)))[:, None], (13, 24)),
    ], axis=-1)  # fmt: skip
    return loft(sections)


def prism(outline: Sequence[tuple[float, float]], depth: float) -> Shape:
    """An outline of (x, z) metres, star-shaped about its mean, drawn out along y by `depth`."""
    ring = np.asarray(outline, dtype=float)
    near = np.stack([ring[:, 0], np.full(len(ring), -depth / 2), ring[:, 1]], axis=1)
    far = near + np.array([0.0, depth, 0.0])
    caps = [np.broadcast_to(end.mean(axis=0), end.shape) for end in (near, far)]
    return loft(np.stack([caps[0], near, far, caps[1]]))


def terrain(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Shape:
    """Ground with heights z [len(y), len(x)] metres over a grid; uv are (x, y)."""
    grid_x, grid_y = np.meshgrid(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    vertices = np.stack([grid_x, grid_y, np.broadcast_to(np.asarray(z, dtype=float), grid_x.shape)], axis=-1)
    return Shape(
        vertices.reshape(-1, 3), _grid_faces(*grid_x.shape), np.stack([grid_x, grid_y], -1).reshape(-1, 2)
    )


def floor(x: tuple[float, float], y: tuple[float, float], z: float = 0.0) -> Shape:
    """A level rectangle; uv are (x, y)."""
    return terrain(x, y, np.full((2, 2), z))


def boulder(rng: np.random.Generator, size: float) -> Shape:
    """A weathered stone about `size` metres across, sunk a little into the ground."""
    shape = ball(size, 0.8 * size, 0.65 * size, 0.8)
    bumps = rng.normal(0.0, 1.0, (9, 3)) * 5.0 / size
    phase = rng.uniform(0.0, 2.0 * np.pi, 9)
    swell = 1.0 + 0.035 * np.sin(shape.vertices @ bumps.T + phase).sum(axis=1, keepdims=True)
    return Shape(shape.vertices * swell, shape.faces, shape.uv).at(z=-0.1 * size)
