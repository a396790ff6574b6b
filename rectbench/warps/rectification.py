"""A rectified pair: two warps into one frame, with lookup tables, resampling and depth."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.frame import rectifying_rotations, signed_baseline_m
from rectbench.warps.lookup.resampling import Filter, Resampler, Side
from rectbench.warps.lookup.tables import Table, lookup_table, reads_source
from rectbench.warps.profiles import Profile
from rectbench.warps.targets import Epipolar, Target, Wrapped
from rectbench.warps.view.extent import Range, ViewAngles, view_angles
from rectbench.warps.warp import Warp

LARGEST_SIDE_PX = 32766
"""`cv2.remap` takes no larger image."""
SEAM_RAD = 1e-12
"""So near to β = ±180° the two ends of the rows are looked for."""
SEAM_COLUMNS = 65
"""Of an image, of which one is looked at that shows anything."""
SEAM_SLACK_PX, SEAM_ROUNDING_PX = 2.0, 1e-3
"""An image that lacks no more rows than this goes all around; and what turns of two images may differ by."""


@dataclass(frozen=True, eq=False)
class Rectification:
    """What a rectifier returns: where each pixel of both images goes.

    `rig` is the rig the rectifier believed in; depth is computed from it. `notes` are what the
    method tells of itself (energy, focal length, a warning), shown beside its row.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rect = rb.rectify(rig, method="abraham")
    >>> rect.size
    (800, 800)
    >>> map_x, map_y = rect.maps("left")
    >>> map_x.shape
    (800, 800)
    >>> rect.triangulate([400.0, 300.0], 5.0).round(2)  # metres
    array([ 0.02, -1.25,  3.45])
    """

    rig: Rig
    left: Warp
    right: Warp
    size: tuple[int, int]
    """(width, height) of both rectified images, pixels."""
    notes: Mapping[str, float | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        try:
            width, height = (int(value) for value in self.size)
        except (TypeError, ValueError, OverflowError):
            raise InvalidInput(f"size is {self.size!r}; expected (width, height) in pixels") from None
        if not (1 <= width <= LARGEST_SIDE_PX and 1 <= height <= LARGEST_SIDE_PX):
            raise InvalidInput(
                f"the rectified image would be {width}x{height} px; expected 1 to {LARGEST_SIDE_PX} a side"
            )
        object.__setattr__(self, "size", (width, height))
        object.__setattr__(self, "notes", {str(k): _note(k, v) for k, v in self.notes.items()})

    @classmethod
    def from_targets(
        cls,
        rig: Rig,
        left: Target,
        right: Target,
        size: tuple[int, int],
        notes: Mapping[str, float | str] | None = None,
    ) -> Rectification:
        """The usual case: both cameras turned into the rig's epipolar frame, then two targets."""
        R_rect_left, R_rect_right = rectifying_rotations(rig)
        warps = Warp(rig.left, R_rect_left, left), Warp(rig.right, R_rect_right, right)
        return cls(rig, *warps, size, notes or {})

    @classmethod
    def from_profiles(
        cls,
        rig: Rig,
        u_left: Profile,
        u_right: Profile,
        v: Profile,
        notes: Mapping[str, float | str] | None = None,
        *,
        view: ViewAngles | None = None,
    ) -> Rectification:
        """Columns û = u_left(γ) and u_right(γ), rows v̂ = v(β) of both, in a frame that just holds them.

        The profiles' own offsets do not matter: the least column and the least row come to the frame's edge,
        -0.5 px, and the frame reaches to the greatest, in whole pixels. Both images share it, so that the
        difference of their columns stays what the profiles make it.

        `view` are the angles that are shown, those of the rig's whole view where it is left out; of these
        each profile shows what lies in its range; where they go all around the baseline the rows begin again
        beyond the last one, see `turn_px`. Raises InvalidInput where they span no finite image.

        >>> import rectbench as rb
        >>> u, v = rb.Radial("stereographic", 300.0, 0.0), rb.Radial("equidistant", 300.0, 0.0)
        >>> rect = rb.Rectification.from_profiles(rb.load_rig("t265"), u, u, v)
        >>> rect.left.target.u == rect.right.target.u
        True
        """
        view = view or view_angles(rig)
        left, right = _shown(u_left, view.gamma_left), _shown(u_right, view.gamma_right)
        rows = _shown(v, view.beta)
        start = min(left[0], right[0])
        size = _whole_size(max(left[1], right[1]) - start, rows[1] - rows[0])
        v = v.framed(rows[0], 1.0)
        targets: list[Target] = [Epipolar(u.framed(start, 1.0), v) for u in (u_left, u_right)]
        if min(-view.beta.low, -v.low, view.beta.high, v.high) >= math.pi:
            targets = [Wrapped(target, -0.5, rows[1] - rows[0]) for target in targets]
        return cls.from_targets(rig, targets[0], targets[1], size, notes)

    @property
    def R_rect_left(self) -> FloatArray:
        """Rectified from left camera frame [3, 3]."""
        return self.left.R_rect_cam

    @property
    def R_rect_right(self) -> FloatArray:
        """Rectified from right camera frame [3, 3]."""
        return self.right.R_rect_cam

    def warp(self, side: Side) -> Warp:
        """The warp of one side, by name."""
        if side not in ("left", "right"):
            raise InvalidInput(f"side is {side!r}; expected 'left' or 'right'")
        return self.left if side == "left" else self.right

    @cached_property
    def turn_px(self) -> float | None:
        """After how many rows the images begin again, where these go all around the baseline; else None.

        First and last row are neighbours in space then: the images are cut there, along the seam β = ±180°.
        """
        turns = [_turn_px(warp.target, self.size) for warp in (self.left, self.right)]
        if None in turns or abs(turns[0] - turns[1]) > SEAM_ROUNDING_PX:  # type: ignore[operator]
            return None
        return turns[0]

    def rows_apart(self, v_left: ArrayLike, v_right: ArrayLike) -> FloatArray:
        """v̂_left - v̂_right [...], the shorter way around where rows go all around, see `turn_px`."""
        apart = np.asarray(v_left, dtype=float) - np.asarray(v_right, dtype=float)
        return across_seam(apart, self.turn_px)

    def curves_apart(self, px_left: FloatArray, px_right: FloatArray) -> FloatArray:
        """How far apart the epipolar curves of pixels [..., 2] of the two images are, in rectified pixels.

        Rows, v̂_left - v̂_right, but for targets that state other curves (`Target.curve_normals`). Of points p
        and q on one circle the sum of both normals halves the angle between them, at right angles to p - q:
        the part of p - q along it is 0 there, and between near circles their distance to first order.
        """
        normals = self.left.target.curve_normals(px_left) + self.right.target.curve_normals(px_right)
        with np.errstate(invalid="ignore"):
            apart = ((px_left - px_right) * normals).sum(axis=-1) / np.linalg.norm(normals, axis=-1)
        return across_seam(apart, self.turn_px)

    def scaled(self, factor: float) -> Rectification:
        """The same images `factor` times as large (sizes rounded to whole pixels), see `Framed`."""
        try:
            sides = [max(1, round(pixels * factor)) for pixels in self.size]
        except (TypeError, ValueError, OverflowError):
            sides = []
        if not sides or factor <= 0:
            raise InvalidInput(f"a rectification was scaled by {factor!r}; expected a finite number above 0")
        size = sides[0], sides[1]
        return self.windowed((-0.5, -0.5), self.size, size)

    def windowed(
        self, corner: tuple[float, float], extent: tuple[float, float], size: tuple[int, int]
    ) -> Rectification:
        """A window of the rectified images, at another size.

        `corner` and `extent` are the window's upper left corner and its width and height, in pixels of
        these images, whose own corner is (-0.5, -0.5); it may reach beyond them. The window's corners
        become those of images of `size` pixels.
        """
        scales = (new / old for new, old in zip(size, extent, strict=True))
        frame = (*corner, *scales)
        left, right = (replace(warp, target=warp.target.framed(*frame)) for warp in (self.left, self.right))
        return replace(self, left=left, right=right, size=size)

    def maps(self, side: Side) -> Table:
        """(map_x, map_y) [height, width] float32 for `cv2.remap`.

        Source pixels; those beyond the source image, or -16 where the lens sees nothing, read the
        border colour.
        """
        return lookup_table(self.warp(side), self.size)

    def valid(self, side: Side) -> NDArray[np.bool_]:
        """Mask [height, width] of rectified pixels that read nothing but source pixels."""
        return reads_source(*self.maps(side), self.warp(side).source.size)

    def remap(
        self,
        left: NDArray[np.generic],
        right: NDArray[np.generic],
        interpolation: int = cv2.INTER_LINEAR,
        filter: Filter = "point",
    ) -> tuple[NDArray[np.generic], NDArray[np.generic]]:
        """Both images resampled into the rectified frame, black where the source shows nothing.

        The filter is "point", `cv2.remap`'s, or "area", which does not alias where the warp shrinks
        the image; see `Resampler`, which also serves many images with one set of tables.
        """
        return (
            Resampler.of(self, "left", filter, interpolation)(left),
            Resampler.of(self, "right", filter, interpolation)(right),
        )

    def triangulate(self, px_rect: ArrayLike, disparity_px: ArrayLike) -> FloatArray:
        """Points [..., 3] in the left camera's frame, metres, from disparities û_left - û_right.

        `px_rect` [..., 2] are pixels of the rectified left image. The exact inverse of both warps
        gives the two rays, the believed pose the triangle (the paper's equation for 3-D
        reconstruction with atan2 in the place of arctan). NaN where the rays do not meet in front.
        """
        px_rect = as_points(px_rect, 2, "px_rect")
        try:
            disparity = np.broadcast_to(np.asarray(disparity_px, dtype=float), px_rect.shape[:-1])
        except (TypeError, ValueError):
            raise InvalidInput(
                f"disparity_px does not fit px_rect; expected {px_rect.shape[:-1]} numbers"
            ) from None
        shift = np.stack([disparity, np.zeros_like(disparity)], axis=-1)
        rays_left = self._camera_rays(self.left, px_rect)
        rays_right = self._camera_rays(self.right, px_rect - shift)
        R_epi_left, R_epi_right = rectifying_rotations(self.rig)
        x1, h1 = _along_and_off(rays_left @ R_epi_left.T)
        x2, h2 = _along_and_off(rays_right @ R_epi_right.T)
        with np.errstate(invalid="ignore", divide="ignore"):
            # r = b / (tan γ1 - tan γ2) with tan γ = x / h, times 1 / h1 for the length along the ray.
            distance = signed_baseline_m(self.rig) * h2 / (x1 * h2 - x2 * h1)
            distance = np.where(np.isfinite(distance) & (distance > 0), distance, np.nan)
        return rays_left * distance[..., None]

    @staticmethod
    def _camera_rays(warp: Warp, px_rect: FloatArray) -> FloatArray:
        return warp.target.unproject(px_rect)[0] @ warp.R_rect_cam


def across_seam(apart_px: FloatArray, turn_px: float | None) -> FloatArray:
    """Differences of rows [...], those of more than half a turn taken the other way around."""
    if turn_px is None:
        return apart_px
    nearer: FloatArray = apart_px - turn_px * np.round(apart_px / turn_px)
    return nearer


def _turn_px(target: Target, size: tuple[int, int]) -> float | None:
    """Rows from β = -180° to 180°, where an image of `size` has them all."""
    columns = np.linspace(0, size[0] - 1, SEAM_COLUMNS)
    rays, shown = target.unproject(np.stack([columns, np.full(SEAM_COLUMNS, (size[1] - 1) / 2)], axis=-1))
    if not shown.any():
        return None
    middle = rays[shown][shown.sum() // 2]
    off = math.hypot(middle[1], middle[2])
    ends, ok = target.project([[middle[0], -off * SEAM_RAD, -off], [middle[0], off * SEAM_RAD, -off]])
    turn_px = float(ends[1, 1] - ends[0, 1])
    return turn_px if ok.all() and size[1] / 2 < turn_px < size[1] + SEAM_SLACK_PX else None


def _shown(profile: Profile, angles: Range) -> tuple[float, float]:
    """The least and the greatest pixel coordinate of those angles that the profile has."""
    low, high = max(angles.low, profile.low), min(angles.high, profile.high)
    return float(profile(low)), float(profile(high))


def _whole_size(width: float, height: float) -> tuple[int, int]:
    try:
        return math.ceil(width), math.ceil(height)
    except (ValueError, OverflowError):
        raise InvalidInput(
            f"the profiles span {width} x {height} px over the view; expected finite numbers"
        ) from None


def _note(name: str, value: object) -> float | str:
    if isinstance(value, str):
        return value
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        kind = type(value).__name__
        raise InvalidInput(f"notes[{name!r}] is {kind}; expected text or a number") from None


def _along_and_off(rays: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Components of rays [..., 3] along the baseline and off it."""
    return rays[..., 0], np.hypot(rays[..., 1], rays[..., 2])


def in_frame(px_rect: FloatArray, size: tuple[int, int]) -> NDArray[np.bool_]:
    """Mask [...] of the rectified pixels [..., 2] that lie on an image of `size`; NaN does not."""
    (width, height), u, v = size, px_rect[..., 0], px_rect[..., 1]
    inside: NDArray[np.bool_] = (u >= -0.5) & (u <= width - 0.5) & (v >= -0.5) & (v <= height - 0.5)
    return inside
