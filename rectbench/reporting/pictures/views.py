"""A reconstruction seen from other places: pixels of an image as small surfaces, painted from far to near.

The points are those of an image's pixels, so that neighbouring pixels tell how a surface goes on between
them, however it is slanted and wherever it is seen from.
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
_SUBPIXEL_BITS = 4


@dataclass(frozen=True, eq=False)
class Patches:
    """What an image's points show of surfaces, in the left camera's frame, metres."""

    points: Floats
    """[N, 3] all of the points."""
    corners: Floats
    """[M, 4, 3] four neighbours each that lie on one surface, round the patch between them."""
    colours: Picture
    """[M, 3] RGB of the patches."""


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

    def seen(self, points: Floats) -> Floats:
        """Points [..., 3] in the view's frame."""
        turned: Floats = (points - self.eye.astype(np.float32)) @ self.R_view_left.T.astype(np.float32)
        return turned


def patches_of(points: FloatArray, colours: Picture) -> Patches:
    """The patches between an image's points [H, W, 3], NaN where there is none, in its colours [H, W, 3]."""
    grid = points.astype(np.float32)
    corners = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    sides = np.roll(corners, -1, axis=2) - corners
    distance = np.linalg.norm(corners, axis=-1)
    along = np.square(np.roll(distance, -1, axis=2) - distance)
    joined = (along < STEEPEST**2 * (np.square(sides).sum(axis=-1) - along)).all(axis=-1)
    return Patches(grid[np.isfinite(grid[..., 0])], corners[joined], colours[:-1, :-1][joined])


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
    x, y, z = view.seen(points[points[:, 1] > -highest_m].astype(np.float32)).T
    ahead = z > nearest_m
    tangents = np.stack([x[ahead] / z[ahead], y[ahead] / z[ahead]], axis=-1)
    low, high = np.quantile(tangents, FRAMED, axis=0) if len(tangents) else np.array([[-0.5] * 2, [0.5] * 2])
    width = max(high[0] - low[0], (high[1] - low[1]) * size[0] / size[1], 1e-3)
    u, v = np.clip((low + high) / 2, -OFF_AXIS, OFF_AXIS)
    return View(
        view.R_view_left, eye, min(float(width), WIDEST), (float(u), float(v)), nearest_m, float(highest_m)
    )


def painted(patches: Patches, view: View, size: tuple[int, int]) -> Picture:
    """The patches on grey, [height, width, 3], the nearest one uppermost."""
    fine = FINER * np.array(size, np.float32)
    corners = view.seen(patches.corners)
    depth = corners[..., 2]
    drawn = (depth > view.nearest_m).all(axis=1) & (patches.corners[..., 1] > -view.highest_m).all(axis=1)
    corners, depth, colours = corners[drawn], depth[drawn].max(axis=1), patches.colours[drawn]
    tangents = corners[..., :2] / corners[..., 2:] - np.array(view.middle, np.float32)
    places = fine[0] / np.float32(view.width) * tangents + fine / 2
    inside = ((places.max(axis=1) > 0) & (places.min(axis=1) < fine)).all(axis=1)
    farthest_first = np.flatnonzero(inside)[np.argsort(-depth[inside], kind="stable")]
    # OpenCV's (0, 0) is the middle of a pixel; what reaches far out is cut where nobody sees it.
    shown = np.clip(places[farthest_first], -fine, 2 * fine) - 0.5
    outlines = np.rint(shown * 2**_SUBPIXEL_BITS).astype(np.int32)
    picture = np.full((int(fine[1]), int(fine[0]), 3), BACKGROUND, np.uint8)
    for outline, colour in zip(outlines, colours[farthest_first].tolist(), strict=True):
        cv2.fillConvexPoly(picture, outline, colour, shift=_SUBPIXEL_BITS)
    averaged: Picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    return averaged
