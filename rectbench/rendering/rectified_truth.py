"""The ground truth at the pixels of a rectified left image: depth, disparity, visibility.

The rays of the rectified pixels themselves are cast, so nothing is resampled: a disparity is that of
the surface at the pixel's centre, at the edges of things as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidInput
from rectbench.types import BoolArray, FloatArray
from rectbench.warps import Rectification


@dataclass(frozen=True, eq=False)
class RectifiedView:
    """The rectified left image as pixels that are rays of the left camera's frame."""

    rect: Rectification

    @property
    def width(self) -> int:
        """Image width, pixels."""
        return self.rect.size[0]

    @property
    def height(self) -> int:
        """Image height, pixels."""
        return self.rect.size[1]

    def unproject(self, pixels: FloatArray) -> tuple[FloatArray, BoolArray]:
        """Unit rays [..., 3] of rectified pixels [..., 2]; and which of them the left image shows."""
        warp = self.rect.left
        rays_rect, ok = warp.target.unproject(pixels)
        rays: FloatArray = rays_rect @ warp.R_rect_cam
        seen: BoolArray = ok & warp.source.sees(rays)
        return rays, seen


@dataclass(frozen=True, eq=False)
class RectifiedTruth:
    """Depth and visibility at the pixel centres of the rectified left image, and what follows from them.

    `rect` belongs to the true rig. Raises InvalidInput for arrays that are not of its size.
    """

    rect: Rectification
    depth: NDArray[np.float32]
    """[H, W] distance from the left camera along the pixel's ray, metres; NaN where the left image shows
    nothing there, or the sky."""
    visible: BoolArray
    """[H, W] where the right camera sees the point of the pixel too."""

    def __post_init__(self) -> None:
        shape = self.rect.size[::-1]
        for name in ("depth", "visible"):
            if np.shape(getattr(self, name)) != shape:
                raise InvalidInput(f"{name} has shape {np.shape(getattr(self, name))}; expected {shape}")

    @cached_property
    def pixels(self) -> FloatArray:
        """[H, W, 2] the pixel centres."""
        width, height = self.rect.size
        u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
        return np.stack([u, v], axis=-1)

    @cached_property
    def points_left(self) -> FloatArray:
        """[H, W, 3] the points in the left camera's frame, metres; NaN where none."""
        rays, _ = RectifiedView(self.rect).unproject(self.pixels)
        return rays * self.depth[..., None].astype(np.float64)

    @cached_property
    def px_right(self) -> FloatArray:
        """[H, W, 2] rectified right pixels of the points, off that image too; NaN where there are none."""
        warp = self.rect.right
        points_rect = self.rect.rig.right_from_left(self.points_left) @ warp.R_rect_cam.T
        return warp.target.project(points_rect)[0]

    @cached_property
    def disparity_px(self) -> FloatArray:
        """[H, W] û_left - û_right, hidden from the right camera or not; NaN where there is no point."""
        return self.pixels[..., 0] - self.px_right[..., 0]

    @cached_property
    def matched(self) -> BoolArray:
        """[H, W] where the right camera sees the point, and the rectified right image has a place for it."""
        width, height = self.rect.size
        u, v = np.moveaxis(self.px_right, -1, 0)
        with np.errstate(invalid="ignore"):
            inside = (u >= -0.5) & (u <= width - 0.5) & (v >= -0.5) & (v <= height - 0.5)
        matched: BoolArray = self.visible & inside
        return matched

    @property
    def row_difference_px(self) -> float:
        """The greatest difference of rows between a pixel and its match; rounding, where rows are kept."""
        difference = np.abs(self.px_right[..., 1] - self.pixels[..., 1])[self.matched]
        return float(difference.max(initial=0.0))
