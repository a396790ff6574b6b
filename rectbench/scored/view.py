"""The view that every rectification of a rig is scored on: the same source pixels, from its middle outwards.

For a share s, A_s is the s-share of an image's source pixels that are nearest to the middle of what both
images see: the image cropped about that middle, in its own proportions, until s of its pixels are left.
Distortion has a meaning on a stated part of the view alone: whoever shows less of it has less of it to
distort.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.cameras import Camera
from rectbench.cameras.projection import as_points
from rectbench.margin import MARGIN_DEG, WIDEST_MARGIN_DEG, checked_margin
from rectbench.rigs import Rig
from rectbench.store.keys import derived_seed
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.lookup.resampling import Side

SCORED_PIXELS = 10_000
"""Source pixels an image, by which is told what of the view is shown."""
MIDDLE_PIXELS = 2_000
"""Source pixels an image by which the middle of the view is found."""
SHARES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 0.95, 1.0)
"""The shares of the view that rows tell of."""
SLACK_DEG = 1.0
"""Beyond what is trimmed about the true epipoles as much is not scored; at most the margin once more."""
LEAST_REACH_PX = 0.5
EDGES_PX = 0.5 * np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
ROW_POINTS = 513
"""Along the middle row of the view."""


@dataclass(frozen=True, eq=False)
class ScoredPixels:
    """The scored source pixels of one image, the nearest to the middle of the view first.

    One in each cell of a grid over the view, at a random place in it. A_s is the first of them, by their
    share.
    """

    camera: Camera
    middle: FloatArray
    """[2], the source pixel that is the middle of the view."""
    reach: FloatArray
    """[2], how far the view reaches from there along columns and along rows, pixels."""
    pixels: FloatArray = field(repr=False)
    """[N, 2]"""
    distance: FloatArray = field(repr=False)
    """[N], rising: the larger of the distances along columns and along rows, as shares of `reach`."""
    cell_px: tuple[float, float]
    """Width and height of the grid's cells, source pixels."""

    @classmethod
    def of(cls, camera: Camera, ray: FloatArray, count: int = SCORED_PIXELS) -> ScoredPixels:
        """About `count` pixels of the camera's image; `ray` [3] is the middle of the view in its frame."""
        rng = np.random.default_rng(derived_seed("scored pixels", repr(camera)))
        cell_px, corners = _grid(camera, count)
        # To pixel centres at the image's edge, as far as its rows and columns reach.
        pixels = np.clip(_jittered(corners, cell_px, rng), 0, np.array(camera.size) - 1)
        pixels = pixels[_wholly_seen(camera, pixels)]
        middle, seen = camera.whole.project(ray)
        if not seen:  # cameras that look apart have no common middle
            middle = (np.array(camera.size) - 1) / 2
        reach = np.abs(pixels - middle).max(axis=0, initial=LEAST_REACH_PX)
        distance = _distance(pixels, middle, reach)
        order = np.argsort(distance, kind="stable")
        return cls(camera, middle, reach, pixels[order], distance[order], cell_px)

    @property
    def area_px(self) -> float:
        """Of the view, as far as pixel centres reach."""
        between_centres = math.prod(1 - 1 / side for side in self.camera.size)
        return len(self.pixels) * math.prod(self.cell_px) * between_centres

    def count(self, share: float) -> int:
        """How many of the pixels are A_s."""
        return math.ceil(share * len(self.pixels) - 1e-9)

    def edge(self, share: float) -> float:
        """The distance to which A_s reaches; 0 where there is no pixel in it."""
        count = self.count(share)
        return float(self.distance[count - 1]) if count > 0 else 0.0

    def within(self, px: FloatArray, share: float) -> BoolArray:
        """Mask [...] of the source pixels [..., 2] that belong to A_s."""
        near = _distance(px, self.middle, self.reach) <= self.edge(share)
        inside: BoolArray = near & self.camera.unproject(px)[1]
        return inside

    def across_deg(self, share: float) -> float:
        """The horizontal field of view of A_s, degrees: the angle between the ends of its middle row."""
        places, angles_rad = self._middle_row
        ends = self.edge(share) * np.array([-1.0, 1.0])
        return math.degrees(float(np.diff(np.interp(ends, places, angles_rad))[0]))

    @cached_property
    def _middle_row(self) -> tuple[FloatArray, FloatArray]:
        """Along the middle row, as shares of the reach [K]: the angle from its left end, radians [K].

        Steps are added up, so that it may pass 180°.
        """
        places = np.linspace(-1.0, 1.0, ROW_POINTS)
        rays, _ = self.camera.whole.unproject(self.middle + places[:, None] * np.array([self.reach[0], 0.0]))
        steps = 2 * np.arcsin(np.linalg.norm(np.diff(rays, axis=0), axis=-1) / 2)
        return places, np.concatenate([[0.0], np.cumsum(np.nan_to_num(steps))])

    def redrawn(self, chosen: NDArray[np.intp], rng: np.random.Generator) -> FloatArray:
        """Other places [K, 2] in the cells of the scored pixels of these numbers [K]."""
        cell = np.array(self.cell_px)
        corners = np.floor((self.pixels[chosen] + 0.5) / cell) * cell - 0.5
        return np.clip(_jittered(corners, self.cell_px, rng), 0, np.array(self.camera.size) - 1)


@dataclass(frozen=True, eq=False)
class ScoredView:
    """The scored pixels of both images of a rig, see `ScoredPixels`.

    >>> import rectbench as rb
    >>> view = rb.ScoredView.of(rb.load_rig("t265"))
    >>> [round(view.across_deg(share)) for share in (0.5, 0.95, 1.0)]
    [95, 143, 159]
    >>> view.matches_within([[420.0, 400.0], [60.0, 400.0]], [[420.0, 400.0], [60.0, 400.0]], 0.5)
    array([ True, False])
    """

    left: ScoredPixels
    right: ScoredPixels

    @classmethod
    def of(cls, rig: Rig, count: int = SCORED_PIXELS, margin_deg: float = MARGIN_DEG) -> ScoredView:
        """That of a rig, of about `count` pixels an image.

        What is trimmed of it by the margin is not scored, nor a seam about that, so that a method which was
        told a pose a little off can show all that is.
        """
        margin_deg = checked_margin(margin_deg)
        rig = rig.trimmed(min(margin_deg + min(SLACK_DEG, margin_deg), WIDEST_MARGIN_DEG))
        middle = view_middle(rig)
        return cls(
            ScoredPixels.of(rig.left, middle, count),
            ScoredPixels.of(rig.right, rig.R_right_left @ middle, count),
        )

    def side(self, side: Side) -> ScoredPixels:
        """The pixels of one image, by its name."""
        return self.left if side == "left" else self.right

    def across_deg(self, share: float) -> float:
        """The horizontal field of view of A_s, degrees, the mean of both images."""
        return (self.left.across_deg(share) + self.right.across_deg(share)) / 2

    def matches_within(self, px_left: ArrayLike, px_right: ArrayLike, share: float) -> BoolArray:
        """Mask [N] of the correspondences px_left ↔ px_right, [N, 2] each, both of which belong to A_s."""
        left, right = as_points(px_left, 2, "px_left"), as_points(px_right, 2, "px_right")
        both: BoolArray = self.left.within(left, share) & self.right.within(right, share)
        return both


def view_middle(rig: Rig) -> FloatArray:
    """The middle [3] of what both images see of points at infinity, a unit ray in the left camera's frame.

    The mean direction of the pixels that see what the other camera sees too; of all pixels where there are
    none.
    """
    rays_left, rays_right = (_rays(camera) for camera in (rig.left, rig.right))
    R_right_left = rig.R_right_left
    shared = [
        rays_left[rig.right.sees(rays_left @ R_right_left.T)],
        (rays_right @ R_right_left)[rig.left.sees(rays_right @ R_right_left)],
    ]
    directions = np.concatenate(shared if any(map(len, shared)) else [rays_left, rays_right @ R_right_left])
    towards = directions.sum(axis=0)
    length = float(np.linalg.norm(towards))
    middle: FloatArray = towards / length if length > 0 else np.array([0.0, 0.0, 1.0])
    return middle


def _rays(camera: Camera) -> FloatArray:
    cell_px, corners = _grid(camera, MIDDLE_PIXELS)
    rays, seen = camera.unproject(corners + np.array(cell_px) / 2)
    return rays[seen]


def _grid(camera: Camera, count: int) -> tuple[tuple[float, float], FloatArray]:
    """Cells over the image, so fine that about `count` lie in the view: their size and corners [N, 2]."""
    cell_px, corners = _cells(camera, count)
    seen = camera.unproject(corners + np.array(cell_px) / 2)[1].mean()
    return _cells(camera, count / seen) if 0 < seen < 1 else (cell_px, corners)


def _cells(camera: Camera, count: float) -> tuple[tuple[float, float], FloatArray]:
    across = max(1, round(math.sqrt(count * camera.width / camera.height)))
    down = max(1, round(count / across))
    width, height = camera.width / across, camera.height / down
    u, v = np.arange(across) * width - 0.5, np.arange(down) * height - 0.5
    return (width, height), np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)


def _jittered(corners: FloatArray, cell_px: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    places: FloatArray = corners + rng.random(corners.shape) * np.array(cell_px)
    return places


def _wholly_seen(camera: Camera, pixels: FloatArray) -> BoolArray:
    """Mask of the pixels [N, 2] that the lens sees to their edges: those of its rim belong to no view."""
    seen: BoolArray = np.all(camera.unproject(pixels[:, None] + EDGES_PX)[1], axis=-1)
    return seen


def _distance(pixels: FloatArray, middle: FloatArray, reach: FloatArray) -> FloatArray:
    far: FloatArray = (np.abs(pixels - middle) / reach).max(axis=-1)
    return far
