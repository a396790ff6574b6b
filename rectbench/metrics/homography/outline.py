"""The outline of an image, and what a map makes of it: what most papers on homographies measure by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from rectbench.plugins.metric import Column, Tolerance
from rectbench.types import FloatArray
from rectbench.warps import Warp

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
MIDDLES = np.array([[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]])
CENTRE = np.array([0.5, 0.5])

deviation = partial(Column, better="lower", floor=1e-6, tolerance=Tolerance(0.01, 1e-6))
"""A column of how far an outline is from the ideal one."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Corners, middles of the edges and centre of an image, pixels; NaN where a map has no place for them.

    The image is the whole source image, half a pixel beyond the centres of its outer pixels, whether the
    rectified frame holds it or not. A homography keeps its edges straight, and these nine points tell all of
    it; of another map they tell what they can, and nothing of how it bends what is between them. A lens
    that shows nothing in the corners has none there.

    >>> import numpy as np
    >>> Outline.of((640, 480)).across, Outline.of((640, 480)).down
    (array([640.,   0.]), array([  0., 480.]))
    """

    corners: FloatArray
    """[4, 2], from the upper left one clockwise: a, b, c, d."""
    middles: FloatArray
    """[4, 2] of the upper, right, lower and left edge."""
    centre: FloatArray
    """[2]"""

    @classmethod
    def of(cls, size: tuple[int, int]) -> Outline:
        """That of an image of (width, height) pixels."""
        corners, middles, centre = (np.array(size) * places - 0.5 for places in (CORNERS, MIDDLES, CENTRE))
        return cls(corners, middles, centre)

    @classmethod
    def rectified(cls, warp: Warp) -> Outline:
        """What a warp makes of its source image."""
        source = cls.of(warp.source.size)
        return cls(*(warp.forward(points) for points in (source.corners, source.middles, source.centre)))

    @property
    def across(self) -> FloatArray:
        """[2], from the middle of the left edge to that of the right one."""
        return np.asarray(self.middles[1] - self.middles[3])

    @property
    def down(self) -> FloatArray:
        """[2], from the middle of the upper edge to that of the lower one."""
        return np.asarray(self.middles[2] - self.middles[0])

    @property
    def area_px(self) -> float:
        """Of the quadrangle of the corners, square pixels."""
        (ax, ay), (bx, by) = self.corners[2] - self.corners[0], self.corners[3] - self.corners[1]
        return abs(float(ax * by - ay * bx)) / 2

    @property
    def corner_angles_deg(self) -> FloatArray:
        """[4], of that quadrangle."""
        ahead = np.roll(self.corners, -1, axis=0) - self.corners
        behind = np.roll(self.corners, 1, axis=0) - self.corners
        return np.array([angle_deg(*sides) for sides in zip(ahead, behind, strict=True)])


def angle_deg(x: FloatArray, y: FloatArray) -> float:
    """Between two vectors [2], from 0 to 180 degrees.

    >>> import numpy as np
    >>> angle_deg(np.array([2.0, 0.0]), np.array([1.0, 1.0]))
    45.0
    """
    return float(np.degrees(np.arctan2(abs(x[0] * y[1] - x[1] * y[0]), x @ y)))
