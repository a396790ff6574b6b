"""Projective and shear criteria of a pair of homographies (Loop and Zhang 1999).

Loop and Zhang, Computing Rectifying Homographies for Stereo Vision, CVPR 1999. A homography is affine where
the weights w, the third coordinates of its homogeneous images, are all alike: their projective criterion is
the sum over pixels of ((w - w_c) / w_c)², w_c being the weight at the mean pixel. Here it is the mean, so
that it does not grow with the image. Their shear is chosen so that the lines x and y that join the middles of
opposite edges stay at right angles, x·y = 0, and in proportion, x·x / y·y = (width / height)²; what is left
of either is measured.

Weights are those of a homography, hence of a perspective rectified image alone, and of the source image as an
ideal pinhole with the lens's axis would have taken it: no other map has any, nor a lens that sees 180°. The
two lines are there for any map that shows the middles of the edges.
"""

from __future__ import annotations

import math

import numpy as np

from rectbench.metrics.homography.outline import Outline, deviation
from rectbench.metrics.view import perspective_matrix
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.scored import dense_pixels
from rectbench.warps import Warp


def projective_criterion(warp: Warp) -> float:
    """Mean over the source pixels of ((w - w_c) / w_c)²; 0 for an affine map, NaN where w means nothing.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("bumblebee2")
    >>> [round(projective_criterion(rb.rectify(rig, m).left), 4) for m in ("conventional", "abraham")]
    [0.0, nan]
    """
    pixels = dense_pixels(warp.source)
    rays, _ = warp.source.unproject(pixels)
    P = perspective_matrix(warp, pixels)
    if P is None or rays[:, 2].min() <= 0:
        return math.nan
    w = rays / rays[:, 2:] @ P[2]
    return float(np.var(w) / np.mean(w) ** 2)  # w is affine, so that its mean is that at the mean pixel


def perpendicularity(outline: Outline) -> float:
    """|cos| of the angle between x and y; 0 is best."""
    x, y = outline.across, outline.down
    return float(abs(x @ y) / np.linalg.norm(x) / np.linalg.norm(y))


def proportion(outline: Outline, size: tuple[int, int]) -> float:
    """(x·x / y·y) / (width / height)² of an image that had (width, height) pixels; 1 is best.

    >>> proportion(Outline.of((640, 480)), (640, 480))
    1.0
    """
    x, y = outline.across, outline.down
    return float((x @ x) / (y @ y) / (size[0] / size[1]) ** 2)


class LoopZhang(Metric):
    """How projective the two maps are, and how sheared what is left of them, by Loop and Zhang's criteria."""

    name, topic = "loop_zhang", "Distortion"
    columns = (
        Column(
            "loop_zhang_projective",
            "projective criterion",
            "",
            "lower",
            "Loop and Zhang's criterion: the mean over pixels of ((w − w_c) / w_c)², w being the third "
            "homogeneous coordinate of the rectified pixel; sum of both images. None where a rectified image "
            "is not a perspective one.",
            average="geometric",
            floor=1e-9,
            tolerance=Tolerance(0.01, 1e-9),
        ),
        deviation(
            "loop_zhang_perpendicularity",
            "shear, perpendicularity",
            meaning="|cos| of the angle between the lines that join the middles of opposite edges of the "
            "source image, as rectified, which Loop and Zhang's shear makes 0; mean of both images.",
        ),
        deviation(
            "loop_zhang_proportion_off",
            "shear, proportion off",
            meaning="How far the ratio of these lines' squared lengths is from that in the source image, "
            "which Loop and Zhang's shear keeps, as a share of it; mean of both images.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """NaN where a criterion means nothing of one of the maps."""
        warps = case.rect.left, case.rect.right
        outlines = [Outline.rectified(warp) for warp in warps]
        proportions = [proportion(o, w.source.size) for o, w in zip(outlines, warps, strict=True)]
        return {
            "loop_zhang_projective": sum(map(projective_criterion, warps)),
            "loop_zhang_perpendicularity": float(np.mean([perpendicularity(o) for o in outlines])),
            "loop_zhang_proportion_off": float(np.mean([abs(p - 1) for p in proportions])),
        }
