"""Log distortion: how unevenly a rectification stretches, whatever its scale."""

from __future__ import annotations

import math

import numpy as np

from rectbench.metrics.distortion import distortion_column
from rectbench.plugins.metric import Case, Metric, Tolerance
from rectbench.warps.jacobians import Jacobians, entries, singular_values


def log_distortion(jacobians: Jacobians) -> dict[str, float]:
    """RMS of log σ1 and log σ2 after their common mean over both images is removed, and its split.

    `log_distortion`² = `log_distortion_area`² + `log_distortion_anisotropy`²: what changes in size
    from place to place, and what is squeezed. No scale of the image changes it, collapse included.

    >>> import rectbench as rb
    >>> rect = rb.rectify(rb.load_rig("t265"), method="abraham")
    >>> found = log_distortion(Jacobians.at(rect))
    >>> round(found["log_distortion_area"] / found["log_distortion"], 1) < 1
    True
    """
    large, small = singular_values(*entries(jacobians.both), np)
    if not large.size or not (small > 0).all():
        return {column.key: math.nan for column in LogDistortion.columns}
    size = (np.log(large) + np.log(small)) / 2
    squeeze = (np.log(large) - np.log(small)) / 2
    area, anisotropy = float(np.std(size)), float(np.sqrt(np.square(squeeze).mean()))
    return {
        "log_distortion": math.hypot(area, anisotropy),
        "log_distortion_area": area,
        "log_distortion_anisotropy": anisotropy,
    }


class LogDistortion(Metric):
    """RMS of the logarithms of the local stretches about their common mean, and its two parts."""

    name, topic = "log_distortion", "Distortion"
    columns = (
        distortion_column(
            "log_distortion",
            "log distortion",
            "RMS of the logarithms of the local stretches σ1 ≥ σ2 about their common mean. Free of "
            "scale, not lowered by shrinking an image: methods are ranked by it.",
            tolerance=Tolerance(0.01, 1e-6),
            shown="summary",
            promised=True,
            ranks=True,
        ),
        distortion_column(
            "log_distortion_area", "log distortion, area", "The part of it that is change of area."
        ),
        distortion_column(
            "log_distortion_anisotropy",
            "log distortion, shape",
            "The part of it that is stretch in one direction.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """At the evaluation pixels of both images."""
        return log_distortion(case.jacobians)
