"""From a rectified pair to a cloud of coloured points (Zhou, Dai and Li, section IV-B)."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.errors import InvalidInput
from rectbench.matching.dense.disparity import NEAREST_BASELINES, PIXELS, Disparity, dense_disparity
from rectbench.matching.dense.matcher import USUAL_MATCHER, Image, Match
from rectbench.types import FloatArray
from rectbench.warps import Rectification

FARTHEST_BASELINES = 500.0
"""Farther points are left out: at 500 px a radian their disparity is a pixel, which hardly
tells them from the sky."""


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """What a pair tells of the scene: a point for each pixel of the rectified left image.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> rig = rb.Rig(camera, camera, np.eye(3), [-0.1, 0, 0])
    >>> rect = rb.rectify(rig, "conventional")
    >>> disparity = Disparity(rect, np.full((120, 160), 6.0, np.float32), np.zeros((120, 160, 3), np.uint8))
    >>> rb.Reconstruction(disparity).points_at([79.5, 59.5])[2].round(3)  # 120 px · 0.1 m / 6 px
    np.float64(2.0)
    """

    disparity: Disparity
    farthest_baselines: float = FARTHEST_BASELINES

    def __post_init__(self) -> None:
        if not 0 < self.farthest_baselines < math.inf:
            raise InvalidInput(
                f"farthest_baselines is {self.farthest_baselines!r}; expected a number above 0"
            )

    @cached_property
    def points(self) -> FloatArray:
        """[H, W, 3] in the left camera's frame, metres; NaN where there is none."""
        height, width = self.disparity.px.shape
        return self._triangulated(
            np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1), self.disparity.px
        )

    def points_at(self, px_rect: ArrayLike) -> FloatArray:
        """Points [..., 3] at any pixels [..., 2] of the rectified left image, likewise."""
        return self._triangulated(px_rect, self.disparity.at(px_rect))

    def _triangulated(self, px_rect: ArrayLike, disparity_px: ArrayLike) -> FloatArray:
        """By the exact inverse of the method's own warps; what is too far is left out."""
        points = self.rect.triangulate(px_rect, disparity_px)
        limit = self.farthest_baselines * self.rect.rig.baseline_m
        points[~(np.square(points).sum(axis=-1) <= limit**2)] = np.nan
        return points

    @property
    def rect(self) -> Rectification:
        """The rectification the pair was matched in."""
        return self.disparity.rect

    @property
    def colours(self) -> Image:
        """[H, W, 3] the rectified left image, RGB."""
        return self.disparity.image

    @cached_property
    def depth(self) -> NDArray[np.float32]:
        """[H, W] distance from the left camera along the pixel's ray, metres; NaN where there is none."""
        depth: NDArray[np.float32] = np.linalg.norm(self.points, axis=-1).astype(np.float32)
        return depth

    def cloud(self) -> tuple[FloatArray, Image]:
        """The points that exist [N, 3], left camera's frame, metres, and their colours [N, 3]."""
        exist = np.isfinite(self.depth)
        return self.points[exist], self.colours[exist]

    def ply(self) -> bytes:
        """The cloud as a binary PLY file (metres, x right, y down, z forward; RGB).

        Raises InvalidInput where there is no point to write.
        """
        from trimesh import PointCloud

        points, colours = self.cloud()
        if not len(points):
            raise InvalidInput(
                "no pixel of the pair has a depth; expected two views of one scene, and their true rig"
            )
        content: bytes = PointCloud(points, colours).export(file_type="ply")
        return content

    def save_ply(self, path: str | os.PathLike[str]) -> None:
        """Write that file."""
        Path(path).write_bytes(self.ply())


def reconstruct(
    rect: Rectification,
    left: NDArray[np.generic],
    right: NDArray[np.generic],
    matcher: str | Path | Match = USUAL_MATCHER,
    *,
    pixels: float = PIXELS,
    nearest_baselines: float = NEAREST_BASELINES,
    farthest_baselines: float = FARTHEST_BASELINES,
) -> Reconstruction:
    """Reconstruct what both images of a pair show.

    Parameters
    ----------
    rect : a rectification of the pair's rig, by any method, see `rectify`.
    left, right : the photographs, [H, W] or [H, W, 1 to 4 channels] (RGB, alpha last), of their
        cameras' sizes, 8 or 16 bits or float.
    matcher : `sgbm` (the default), `sgbm-5way`, `sgbm-8way`, `bm`, the path of a file with a matcher, or a
        function of your own: `(left, right, lowest, highest) -> disparities [H, W]`, given rectified
        uint8 RGB images and the range to search, NaN where it finds nothing; it is called twice, for a
        left-right check.
    pixels : a rectified image of more pixels is made smaller first.
    nearest_baselines, farthest_baselines : the distances from the left camera, in baselines, from
        which things are sought and to which points are kept.

    Returns the `Reconstruction`; that of two images that share nothing has no points. Raises
    InvalidInput, UnknownName, InvalidResult or Unavailable, see `dense_disparity`.

    >>> import cv2, numpy as np
    >>> import rectbench as rb
    >>> noise = np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)
    >>> image = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> rect = rb.rectify(rb.Rig(camera, camera, np.eye(3), [-0.1, 0, 0]), "conventional")
    >>> wall = rb.reconstruct(rect, image, np.roll(image, -6, axis=1))
    >>> round(float(np.nanmedian(wall.points[..., 2])), 1)  # metres: 120 px · 0.1 m / 6 px
    2.0
    """
    if not isinstance(rect, Rectification):
        raise InvalidInput(f"rect is {type(rect).__name__}; expected a Rectification, see rectbench.rectify")
    disparity = dense_disparity(
        rect, left, right, matcher=matcher, pixels=pixels, nearest_baselines=nearest_baselines
    )
    return Reconstruction(disparity, farthest_baselines)
