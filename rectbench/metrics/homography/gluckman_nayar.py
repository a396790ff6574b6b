"""Change of local area and of local aspect over the whole source image (Gluckman and Nayar 2001).

Gluckman and Nayar, Rectifying Transformations That Minimize Resampling Effects, CVPR 2001: J being the
derivative of the map, pixels are lost where |det J| is below 1, and invented where it is above; what is
minimised is how far it is from 1 over both images. The aspect is σ1/σ2 of the same J, 1 where squares stay
squares. Any smooth map has them; unlike the distortions of this harness they are taken over all that the
lenses see, shown in the frame or not, since a homography maps it all.
"""

from __future__ import annotations

import numpy as np

from rectbench.metrics.distortion import distortion_column
from rectbench.plugins.metric import Case, Metric, Tolerance
from rectbench.scored import dense_pixels
from rectbench.warps import Rectification, Warp
from rectbench.warps.jacobians import entries, losses, singular_values


def local_changes(rect: Rectification) -> tuple[float, float]:
    """Means over the source pixels of both images of (|det J| - 1)² and of σ1/σ2.

    NaN where a map leaves pixels out: what it does there has no derivative.

    >>> import rectbench as rb
    >>> [round(mean, 3) for mean in local_changes(rb.rectify(rb.load_rig("t265"), "abraham"))]
    [0.38, 1.533]
    """
    area, aspect = np.mean([_means(warp) for warp in (rect.left, rect.right)], axis=0)
    return float(area), float(aspect)


def _means(warp: Warp) -> tuple[float, float]:
    J = warp.jacobian(dense_pixels(warp.source))
    growth, _, _ = losses(*entries(J), np)
    large, small = singular_values(*entries(J), np)
    return float(np.mean(growth**2)), float(np.mean(large / small))


class GluckmanNayar(Metric):
    """How much the maps change area and aspect from place to place, over the whole source images."""

    name, topic = "gluckman_nayar", "Distortion"
    columns = (
        distortion_column(
            "gluckman_nayar_area",
            "local area",
            "Gluckman and Nayar's criterion: the mean of (|det J| − 1)² over all source pixels, "
            "shown or not.",
            tolerance=Tolerance(0.01, 1e-6),
        ),
        distortion_column(
            "gluckman_nayar_aspect",
            "local aspect",
            "Mean of σ1/σ2 over all source pixels, shown or not; 1 where squares stay squares.",
            tolerance=Tolerance(0.01, 1e-6),
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together."""
        return dict(zip((column.key for column in self.columns), local_changes(case.rect), strict=True))
