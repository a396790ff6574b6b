"""A reconstruction seen from other places: each point a patch that reaches to its neighbours.

The points are those of an image's pixels, so that the neighbours of a pixel tell how large a patch
closes the surface there, however it is slanted and wherever it is seen from.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.types import FloatArray

Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]
BACKGROUND = 232
"""Grey: neither the white of a wall nor the black of a shadow."""
FINER = 2
"""Views are drawn that many times as large and then averaged."""
STEEPEST = 25.0
"""Neighbours more than that many times farther apart in distance than across lie on two surfaces."""
LARGEST_PX = 32
"""No side of a patch is drawn longer, in pixels of the finer picture."""
FRAMED = (0.04, 0.96)
"""Quantiles of the points across and down that a view shows, and of what is left and right of the eye."""
WIDEST = 1.6
"""Tangents across a view at most, some 77°: a wide lens sees more than a picture can show."""
OFF_AXIS = 0.1
"""Tangents that the middle of a view may lie off what is looked at."""
NEAREST = 0.1
"""What is nearer to the eye than this share of the way to what it looks at is in its way."""
MIDDLE = 0.4
"""Quantile of the points' distances at which a view looks."""
BESIDE, ABOVE = (0.3, -0.3, -0.6), (-0.25, -1.3, -0.7)
"""Where the eyes are, in multiples of that distance: right of the camera and behind it, and above it."""
CUT = 0.4
"""The view from above leaves out what is higher than this share of the height of the highest: ceilings."""
_MARGIN_PX = 3 * LARGEST_PX
"""Around the finer picture, so that no patch ends outside: one may begin off it, and has two sides."""
_NOTHING = np.uint64(2**64 - 1)


@dataclass(frozen=True, eq=False)
class Patches:
    """A parallelogram for each point, in the left camera's frame, metres."""

    points: Floats
    """[N, 3] a corner of each."""
    across: Floats
    """[N, 3] its sides: to the next point in the row,"""
    down: Floats
    """[N, 3] and in the column; 0 where there is none, or another surface."""
    colours: Picture
    """[N, 3] RGB."""


@dataclass(frozen=True, eq=False)
class View:
    """Where a cloud is seen from, in the left camera's frame.

    `R_view_left` [3, 3] turns into a frame that looks along +z, `eye` [3] is its origin, metres.
    """

    R_view_left: FloatArray
    eye: FloatArray
    width: float = 1.0
    """Tangents across the picture."""
    middle: tuple[float, float] = (0.0, 0.0)
    """Tangents in the middle of the picture."""
    nearest_m: float = 1e-6
    """Depth from which things are drawn."""
    highest_m: float = np.inf
    """Height over the left camera up to which things are drawn."""

    def turned(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Vectors [N, 3] along the view's axes."""
        x, y, z = self.R_view_left.astype(np.float32) @ points.T
        return x, y, z


def patches_of(points: FloatArray, colours: Picture) -> Patches:
    """The patches of an image's points [H, W, 3], NaN where there is none, in its colours [H, W, 3]."""
    corners = points.astype(np.float32)
    distance = np.sqrt(np.square(corners).sum(axis=-1))
    exist = np.isfinite(distance)
    across, down = (_sides(corners, distance, axis)[exist] for axis in (1, 0))
    return Patches(corners[exist], across, down, colours[exist])


def _sides(corners: Floats, distance: Floats, axis: int) -> Floats:
    """Vectors [H, W, 3] to the next point along an axis of the image, 0 where a surface ends."""
    sides = np.zeros_like(corners)
    here, there = np.s_[:, :-1] if axis else np.s_[:-1], np.s_[:, 1:] if axis else np.s_[1:]
    steps = corners[there] - corners[here]
    along = np.square(distance[there] - distance[here])
    joined = along < STEEPEST**2 * (np.einsum("hwi,hwi->hw", steps, steps) - along)
    sides[here][joined] = steps[joined]
    return sides


def looking_at(eye: FloatArray, aim: FloatArray) -> View:
    """A view from `eye` to `aim`, upright as the left camera is."""
    z = (aim - eye) / np.linalg.norm(aim - eye)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    return View(np.stack([x, np.cross(z, x), z]), eye)


def two_views(points: FloatArray | Floats, size: tuple[int, int]) -> tuple[View, View]:
    """A view of points [N, 3] (N from 1) from beside the left camera and one from above it.

    Pictures of `size` (width, height) hold nearly all points, or as many as a picture can show.
    """
    distance = float(np.quantile(np.linalg.norm(points, axis=1), MIDDLE))
    low, high = np.quantile(points, FRAMED, axis=0)
    aim = distance * np.array([0.0, 0.05, 1.0])
    # Not beyond the walls of a corridor, nor above its ceiling.
    beside = np.clip(distance * np.array(BESIDE), [low[0] / 2, low[1] / 2, -np.inf], [high[0] / 2, 0.0, 0.0])
    highest_m = CUT * max(-float(low[1]), 0.2 * distance)
    return (
        _framed(beside, aim, points, size),
        _framed(distance * np.array(ABOVE), aim, points, size, highest_m),
    )


def _framed(
    eye: FloatArray,
    aim: FloatArray,
    points: FloatArray | Floats,
    size: tuple[int, int],
    highest_m: float = np.inf,
) -> View:
    view = looking_at(eye, aim)
    nearest_m = NEAREST * float(np.linalg.norm(aim - eye))
    x, y, z = view.turned((points[points[:, 1] > -highest_m] - eye).astype(np.float32))
    ahead = z > nearest_m
    tangents = np.stack([x[ahead] / z[ahead], y[ahead] / z[ahead]], axis=-1)
    low, high = np.quantile(tangents, FRAMED, axis=0) if len(tangents) else np.array([[-0.5] * 2, [0.5] * 2])
    width = max(high[0] - low[0], (high[1] - low[1]) * size[0] / size[1], 1e-3)
    u, v = np.clip((low + high) / 2, -OFF_AXIS, OFF_AXIS)
    return View(
        view.R_view_left, eye, min(float(width), WIDEST), (float(u), float(v)), nearest_m, float(highest_m)
    )


def splat(patches: Patches, view: View, size: tuple[int, int]) -> Picture:
    """The patches on grey, [height, width, 3], the nearest one uppermost."""
    seen, corners, sides = _projected(patches, view, size)
    # Steps of at most a pixel along both sides.
    columns, rows = (np.maximum(np.ceil(np.hypot(du, dv)), 1) for du, dv, _ in sides)
    across, down = sides[0] / columns, sides[1] / rows
    columns, rows = (np.minimum(count, LARGEST_PX).astype(np.int64) for count in (columns, rows))

    stride, lines = (FINER * n + 2 * _MARGIN_PX for n in size)
    uppermost = np.full(lines * stride, _NOTHING)
    shape = columns * (LARGEST_PX + 1) + rows
    order = np.argsort(shape, kind="stable")
    for alike in np.split(order, np.flatnonzero(np.diff(shape[order])) + 1) if len(order) else ():
        i, j = (np.arange(count[alike[0]], dtype=np.float32)[:, None] for count in (columns, rows))
        u, v, z = (
            (corner[alike] + i * a[alike])[:, None] + j * d[alike]
            for corner, a, d in zip(corners, across, down, strict=True)
        )
        # Depth in the upper half, as the bits of a positive float sort like it; below, which patch.
        key = np.maximum(z, 0).view(np.uint32).astype(np.uint64) << np.uint64(32) | seen[alike]
        np.minimum.at(uppermost, v.astype(np.int32) * stride + u.astype(np.int32), key)
    inner = uppermost.reshape(lines, stride)[_MARGIN_PX:-_MARGIN_PX, _MARGIN_PX:-_MARGIN_PX]
    return _averaged(inner, patches.colours, size)


def _projected(
    patches: Patches, view: View, size: tuple[int, int]
) -> tuple[NDArray[np.uint64], Floats, tuple[Floats, Floats]]:
    """Which patches [N] may be seen; (u, v, depth) [3, N] of their corners and along their sides.

    u and v are pixels of the finer picture with its margin.
    """
    focal = np.float32(FINER * size[0] / view.width)
    u0, v0 = (
        np.float32(FINER * n / 2 + _MARGIN_PX - focal * m) for n, m in zip(size, view.middle, strict=True)
    )
    x, y, z = view.turned(patches.points - view.eye.astype(np.float32))
    drawn = (z > view.nearest_m) & (patches.points[:, 1] > -view.highest_m)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for place, end in ((focal * x / z + u0, size[0]), (focal * y / z + v0, size[1])):
            drawn &= (place > _MARGIN_PX - LARGEST_PX) & (place < FINER * end + _MARGIN_PX + LARGEST_PX)
    seen = np.flatnonzero(drawn)
    x, y, z = x[seen], y[seen], z[seen]
    corners = np.stack([focal * x / z + u0, focal * y / z + v0, z])

    def along(side: Floats) -> Floats:
        dx, dy, dz = view.turned(side[seen])
        scale = focal / np.maximum(z + dz, np.float32(view.nearest_m))
        ends = np.stack([scale * (x + dx) + u0, scale * (y + dy) + v0, z + dz])
        return ends - corners

    return seen.astype(np.uint64), corners, (along(patches.across), along(patches.down))


def _averaged(uppermost: NDArray[np.uint64], colours: Picture, size: tuple[int, int]) -> Picture:
    """The picture of the finer one's uppermost patches; what is half covered is closed."""
    hit = uppermost < _NOTHING
    fine = np.zeros((*hit.shape, 4), np.float32)
    fine[hit, :3] = colours[uppermost[hit] & np.uint64(0xFFFFFFFF)]
    fine[hit, 3] = 1.0
    mean = cv2.resize(fine, size, interpolation=cv2.INTER_AREA)
    covered = mean[..., 3:]
    colour = mean[..., :3] / np.maximum(covered, 1e-6)
    opaque = np.minimum(2 * covered, 1.0)
    picture: Picture = np.rint(opaque * colour + (1 - opaque) * BACKGROUND).astype(np.uint8)
    return picture
