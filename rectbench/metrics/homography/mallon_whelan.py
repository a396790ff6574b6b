"""Orthogonality and aspect ratio of the rectified outline (Mallon and Whelan 2005).

Mallon and Whelan, Projective Rectification from the Fundamental Matrix, Image and Vision Computing 23(7),
2005: E_O is the angle between the lines that join the middles of opposite edges, 90° in an image that is not
skewed; E_A the ratio of the diagonals, 1 there. Both are defined by where points go, for a map of any kind.
"""

from __future__ import annotations

import numpy as np

from rectbench.metrics.homography.outline import Outline, angle_deg, deviation
from rectbench.plugins.metric import Case, Metric


def orthogonality_deg(outline: Outline) -> float:
    """E_O, degrees; 90 is best.

    >>> orthogonality_deg(Outline.of((640, 480)))
    90.0
    """
    return angle_deg(outline.across, outline.down)


def aspect_ratio(outline: Outline) -> float:
    """E_A, the diagonal that rises to the right over the one that falls; 1 is best.

    >>> aspect_ratio(Outline.of((640, 480)))
    1.0
    """
    a, b, c, d = outline.corners
    return float(np.linalg.norm(b - d) / np.linalg.norm(c - a))


class MallonWhelan(Metric):
    """How far the rectified source images are from rectangles, by Mallon and Whelan's two measures."""

    name, topic = "mallon_whelan", "Distortion"
    columns = (
        deviation(
            "orthogonality_off_deg",
            "orthogonality, off",
            unit="°",
            meaning="|E_O − 90°| of Mallon and Whelan: the angle between the lines that join the middles of "
            "opposite edges of the source image, as rectified; mean of both images.",
        ),
        deviation(
            "aspect_ratio_off",
            "aspect ratio, off",
            meaning="|E_A − 1| of Mallon and Whelan: the ratio of the diagonals of the source image, as "
            "rectified; mean of both images. None where a lens shows nothing in the corners.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """NaN where a map has no place for one of the points."""
        outlines = [Outline.rectified(warp) for warp in (case.rect.left, case.rect.right)]
        return {
            "orthogonality_off_deg": float(np.mean([abs(orthogonality_deg(o) - 90) for o in outlines])),
            "aspect_ratio_off": float(np.mean([abs(aspect_ratio(o) - 1) for o in outlines])),
        }
