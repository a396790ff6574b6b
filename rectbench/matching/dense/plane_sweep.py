"""Depth without rectification: planes swept through the scene, on images as their lenses took them.

Gallup, Frahm, Mordohai, Yang and Pollefeys, Real-Time Plane-Sweeping Stereo with Multiple Sweeping
Directions, CVPR 2007: planes n·X = d of several directions n are hypotheses for what each pixel shows; each
maps the right image onto the left one, and the plane under which both look most alike wins. Of pinhole images
that map is a homography. Häne, Heng, Lee, Sizov and Pollefeys, Real-Time Direct Dense Matching on Fisheye
Images Using Plane-Sweeping Stereo, 3DV 2014: with a lens's own projection in its place none is undistorted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.cameras import Camera
from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput, argument
from rectbench.images.reading import grey8
from rectbench.matching.dense.correlation import LEAST_SCORE, FloatMap, correlation, most_alike
from rectbench.matching.dense.disparity import AGREEMENT_PX, NEAREST_BASELINES, settled
from rectbench.matching.dense.reconstruction import FARTHEST_BASELINES
from rectbench.rigs import Rig
from rectbench.types import BoolArray, FloatArray

PIXELS = 2.5e5
"""Larger images are made smaller first, to about this many pixels: every plane maps a whole image."""
DIRECTIONS = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0))
"""Planes ahead, to both sides, below and above, in each camera's frame: the walls of a box around it."""
LEAST_COSINE = 0.25
"""A ray is asked of the planes that it meets at no more than 75° from their normal: of a ground plane, what
lies 15° below the horizon. Every ray meets some of the box's walls at 55° or less."""
STEP_PX = 1.0
"""From one plane to the next no pixel moves by more in the other image (both papers)."""
SPEED_RAYS, SPEED_DEPTHS = 2_000, 9
"""Rays, and depths on each, by which it is told how fast pixels move."""


@dataclass(frozen=True, eq=False)
class SweptDepth:
    """How far away what each pixel of the left source image shows is."""

    rig: Rig
    """The rig at the size that was swept."""
    depth: FloatMap = field(repr=False)
    """[H, W] distance from the left camera along the pixel's ray, metres; NaN where nothing was found."""

    def at(self, px: ArrayLike, size: tuple[int, int]) -> FloatArray:
        """Depths [...] at pixels [..., 2] of the left image of (width, height): the nearest swept ones."""
        swept = np.array(self.rig.left.size)
        place = np.rint((as_points(px, 2, "px") + 0.5) * (swept / np.array(size)) - 0.5).astype(int)
        u, v = np.moveaxis(np.clip(place, 0, swept - 1), -1, 0)
        return np.asarray(self.depth[v, u], dtype=np.float64)


def plane_sweep(
    rig: Rig,
    left: NDArray[np.generic],
    right: NDArray[np.generic],
    *,
    directions: Sequence[Sequence[float]] = DIRECTIONS,
    pixels: float = PIXELS,
    nearest_baselines: float = NEAREST_BASELINES,
    farthest_baselines: float = FARTHEST_BASELINES,
) -> SweptDepth:
    """Depth of the left image of any rig, of its source pixels, without rectifying anything.

    Parameters
    ----------
    rig : the rig, its lenses of any model.
    left, right : the photographs, of the cameras' sizes, as `reconstruct` takes them.
    directions : normals [3] of the planes that are swept, in each camera's frame, of any length.
    pixels : larger images are made smaller first.
    nearest_baselines, farthest_baselines : distances from the camera, in baselines, from which things are
        sought and to which they are kept.

    Both images are swept, and a depth counts where the right one's leads back to within two pixels; its
    inverse is then smoothed as a disparity is, see `dense_disparity`. Raises InvalidInput for images that are
    not the rig's, a normal of no length, or a number that makes no sense.

    >>> import cv2, numpy as np
    >>> import rectbench as rb
    >>> noise = np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)
    >>> image = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> rig = rb.Rig(camera, camera, np.eye(3), [-0.1, 0, 0])
    >>> swept = rb.plane_sweep(rig, image, np.roll(image, -6, axis=1), directions=[(0, 0, 1)])
    >>> round(float(swept.depth[60, 80]), 1)  # metres: 120 px · 0.1 m / 6 px
    2.0
    """
    numbers = {"pixels": pixels, "nearest_baselines": nearest_baselines}
    for name, number in {**numbers, "farthest_baselines": farthest_baselines}.items():
        if not (isinstance(number, int | float | np.number) and 0 < number < math.inf):
            raise InvalidInput(f"{argument(name)} is {number!r}; expected a number above 0")
    normals = _unit_normals(directions)
    greys = _grey(rig.left, left, "left"), _grey(rig.right, right, "right")
    rig = rig.scaled(min(1.0, math.sqrt(pixels / math.prod(rig.left.size))))
    small = [
        cv2.resize(grey, camera.size, interpolation=cv2.INTER_AREA).astype(np.float32)
        for grey, camera in zip(greys, (rig.left, rig.right), strict=True)
    ]
    farthest_m, nearest_m = (n * rig.baseline_m for n in (farthest_baselines, nearest_baselines))
    there, step = _nearness(rig, small[0], small[1], normals, nearest_m)
    back, _ = _nearness(_exchanged(rig), small[1], small[0], normals, nearest_m)
    there[~(there >= 1 / farthest_m)] = np.nan
    back[~(back >= 1 / farthest_m)] = np.nan
    confirmed = np.where(_leads_back(rig, there, back), there, np.float32(np.nan))
    nearness = step * settled((confirmed / step).astype(np.float32), small[0].astype(np.uint8))
    return SweptDepth(rig, (1 / nearness).astype(np.float32))


def _nearness(
    rig: Rig, left: FloatMap, right: FloatMap, normals: FloatArray, nearest_m: float
) -> tuple[FloatMap, float]:
    """1/depth [H, W] of the left image, 1/m, NaN where no plane makes both alike; and one step of it."""
    rays, seen = rig.left.unproject(rig.left.pixel_grid())
    found, score = np.full(left.shape, np.nan, np.float32), np.full(left.shape, LEAST_SCORE, np.float32)
    steps = []
    for normal in normals:
        cosines = rays @ normal
        asked = seen & (cosines >= LEAST_COSINE)
        if not asked.any():
            continue
        part = np.ix_(*(_extent(asked.any(axis=axis)) for axis in (1, 0)))
        step = _step(rig, rays[asked], cosines[asked], nearest_m)
        steps.append(step)
        family = _Family(
            rig, left[part], right, rays[part], np.where(asked, cosines, np.nan)[part], nearest_m
        )
        nearness, likeness = family.best(step)
        wins = likeness > score[part]
        found[part] = np.where(wins, nearness, found[part])
        score[part] = np.where(wins, likeness, score[part])
    return found, min(steps, default=1.0)


@dataclass(frozen=True, eq=False)
class _Family:
    """All planes of one normal, before a part of the left image."""

    rig: Rig
    left: FloatMap
    right: FloatMap
    rays: FloatArray
    cosines: FloatArray
    """Of the rays to the normal; NaN for those that are not asked."""
    nearest_m: float

    def best(self, step: float) -> tuple[FloatMap, FloatMap]:
        """1/depth [H, W] under the plane that makes both images most alike, and how alike they are then.

        The planes are `step` apart in 1/d, from just beyond infinity to just nearer than the nearest depth.
        """
        last = 1 / (self.nearest_m * np.nanmin(self.cosines)) + 2 * step
        place, score = most_alike(map(self.score, np.arange(-step, last, step)), self.left.shape)
        return ((place - 1) * step * self.cosines).astype(np.float32), score

    def score(self, inverse: float) -> FloatMap:
        """How alike both images are [H, W] under the plane n·X = 1/`inverse`; -1 where nothing is seen so."""
        nearness = inverse * self.cosines
        seen = nearness * self.nearest_m <= 1
        places, there = on_the_right(self.rig, self.rays[seen], nearness[seen])
        px = np.full((*seen.shape, 2), -1.0, np.float32)
        px[seen] = np.where(there[:, None], places, -1.0)
        seen[seen] = there
        mapped = cv2.remap(self.right, px, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return np.where(seen, correlation(self.left, mapped.astype(np.float32)), np.float32(-1))


def on_the_right(rig: Rig, rays: FloatArray, nearness: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Right pixels [..., 2] of what left rays [..., 3] show at depths 1/`nearness` [...]; which are seen.

    A point r / q lies along R r + q t from the right camera, which has no fault at infinity, q = 0.
    """
    towards = rays @ rig.R_right_left.T + nearness[..., None] * rig.t_right_left
    px, seen = rig.right.project(towards)
    return px, seen & rig.right.contains(px)


def _step(rig: Rig, rays: FloatArray, cosines: FloatArray, nearest_m: float) -> float:
    """The difference in 1/d, 1/m, by which no pixel that both cameras see moves more than STEP_PX."""
    some = slice(None, None, max(1, len(rays) // SPEED_RAYS))
    rays, cosines = rays[some], cosines[some]
    nearness = np.linspace(0, 1 / nearest_m, SPEED_DEPTHS)
    px, seen = on_the_right(rig, rays[:, None], np.broadcast_to(nearness, (len(rays), SPEED_DEPTHS)))
    px = np.where(seen[..., None], px, np.nan)
    moves = np.linalg.norm(np.diff(px, axis=1), axis=-1) / nearness[1]
    speeds = (moves * cosines[:, None])[np.isfinite(moves)]
    fastest = float(speeds.max(initial=0.0))
    return STEP_PX / fastest if fastest > 0 else 1 / nearest_m


def _leads_back(rig: Rig, there: FloatMap, back: FloatMap) -> BoolArray:
    """[H, W], where the right pixel that a left one leads to has a depth that leads back to it."""
    pixels = rig.left.pixel_grid()
    px, seen = on_the_right(rig, rig.left.unproject(pixels)[0], there.astype(np.float64))
    u, v = np.moveaxis(np.where(seen[..., None], np.rint(px), 0).astype(int), -1, 0)
    rays_right, _ = rig.right.unproject(np.stack([u, v], axis=-1).astype(float))
    returned, _ = on_the_right(_exchanged(rig), rays_right, back[v, u].astype(np.float64))
    near = np.linalg.norm(returned - pixels, axis=-1) <= AGREEMENT_PX
    return np.asarray(seen & near)


def _exchanged(rig: Rig) -> Rig:
    """The rig with its cameras the other way around."""
    R, t = rig.R_right_left, rig.t_right_left
    return Rig(rig.right, rig.left, R.T, -R.T @ t)


def _grey(camera: Camera, image: NDArray[np.generic], side: str) -> NDArray[np.uint8]:
    grey = grey8(image, side)
    if grey.shape[::-1] != camera.size:
        (height, width), (w, h) = grey.shape, camera.size
        raise InvalidInput(f"the {side} image is {width}x{height} px; its camera has {w}x{h}")
    return grey


def _unit_normals(directions: Sequence[Sequence[float]]) -> FloatArray:
    normals = np.array(directions, dtype=np.float64)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True) if normals.ndim == 2 else np.zeros(1)
    if normals.ndim != 2 or normals.shape[1] != 3 or not np.isfinite(normals).all() or not lengths.all():
        raise InvalidInput(f"directions are {directions!r}; expected normals [N, 3] of planes")
    unit: FloatArray = normals / lengths
    return unit


def _extent(occupied: BoolArray) -> NDArray[np.intp]:
    """From the first to the last."""
    places = np.flatnonzero(occupied)
    return np.arange(places[0], places[-1] + 1)
