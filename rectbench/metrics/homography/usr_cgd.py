"""Aspect ratio, skewness, rotation, size ratio and vertex distance of the rectified outline (Ko et al.).

Ko, Shim, Choi and Kuo, Robust Uncalibrated Stereo Rectification with Constrained Geometric Distortions
(USR-CGD), 2016: aspect ratio ½ (a'o'/c'o' + b'o'/d'o'), ideally 1, of the distances from the centre o' to
the corners; skewness, the mean of |90° - corner angle|; rotation, the angle by which the line from the centre
to the middle of the right edge turns; size ratio, the area of the outline over the source image's, ideally 1.
The normalised vertex distance is how far the corners move, as a share of the image's diagonal; Xiao et al.
(DSR, 2018) compare by it too. All are defined by where points go, for a map of any kind; the last two depend
on how a method sizes and frames its images, the very last on where it puts them.
"""

from __future__ import annotations

import numpy as np

from rectbench.metrics.homography.outline import Outline, angle_deg, deviation
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.warps import Warp


def aspect_ratio(outline: Outline) -> float:
    """½ (a'o'/c'o' + b'o'/d'o'); 1 is best.

    >>> aspect_ratio(Outline.of((640, 480)))
    1.0
    """
    a, b, c, d = np.linalg.norm(outline.corners - outline.centre, axis=1)
    return float((a / c + b / d) / 2)


def skewness_deg(outline: Outline) -> float:
    """Mean of |90° - corner angle|, degrees; 0 is best.

    >>> skewness_deg(Outline.of((640, 480)))
    0.0
    """
    return float(np.mean(np.abs(90 - outline.corner_angles_deg)))


def rotation_deg(source: Outline, outline: Outline) -> float:
    """Angle by which the line from the centre to the right edge's middle turns, degrees; 0 is best."""
    return angle_deg(source.middles[1] - source.centre, outline.middles[1] - outline.centre)


def size_ratio(source: Outline, outline: Outline) -> float:
    """Area over the source's; 1 is best."""
    return outline.area_px / source.area_px


def vertex_distance(source: Outline, outline: Outline) -> float:
    """Mean distance of the corners from where they were, as a share of the source's diagonal; 0 is best."""
    moved = np.linalg.norm(outline.corners - source.corners, axis=1)
    return float(moved.mean() / np.linalg.norm(source.corners[2] - source.corners[0]))


class UsrCgd(Metric):
    """What the rectification does to the outline of the source images, by the measures of USR-CGD."""

    name, topic = "usr_cgd", "Distortion"
    columns = (
        deviation(
            "usr_cgd_aspect_off",
            "USR-CGD aspect, off",
            meaning="|½ (a'o'/c'o' + b'o'/d'o') − 1| of the rectified corners a' to d' of the source image "
            "and its centre o'; this and what follows of USR-CGD is the mean of both images, and there only "
            "where the lens shows the corners.",
        ),
        deviation(
            "usr_cgd_skewness_deg",
            "USR-CGD skewness",
            unit="°",
            meaning="Mean of how far the angles in the rectified corners are from 90°.",
        ),
        deviation(
            "usr_cgd_rotation_deg",
            "USR-CGD rotation",
            unit="°",
            meaning="Angle by which the line from the image's centre to the middle of its right edge turns.",
        ),
        Column(
            "usr_cgd_size_ratio",
            "USR-CGD size ratio",
            meaning="Area of the rectified outline over that of the source image; 1 is what they seek. It "
            "depends on the focal length that a method chooses.",
            average="geometric",
        ),
        Column.share(
            "usr_cgd_vertex_distance",
            "vertex distance",
            "lower",
            "Normalised vertex distance: the mean of how far the corners of the source image move, pixels of "
            "both frames taken alike, as a share of its diagonal. It depends on where the frame is "
            "too.",
            tolerance=Tolerance(0.01, 1e-6),
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """NaN where a map has no place for one of the points."""
        sides = [_measures(warp) for warp in (case.rect.left, case.rect.right)]
        keys = [column.key for column in self.columns]
        return dict(zip(keys, np.mean(sides, axis=0).tolist(), strict=True))


def _measures(warp: Warp) -> list[float]:
    """Of one image, in the order of the columns."""
    source, outline = Outline.of(warp.source.size), Outline.rectified(warp)
    return [
        abs(aspect_ratio(outline) - 1),
        skewness_deg(outline),
        rotation_deg(source, outline),
        size_ratio(source, outline),
        vertex_distance(source, outline),
    ]
