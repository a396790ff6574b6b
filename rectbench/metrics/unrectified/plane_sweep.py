"""Plane sweeping: what depth the source images give unrectified, and what rectification gains or costs."""

from __future__ import annotations

import math

import numpy as np

from rectbench.matching import SweptDepth, plane_sweep, reconstruct
from rectbench.matching.dense.plane_sweep import PIXELS
from rectbench.metrics.reconstruction import (
    ANGLES_DEG,
    COMPLETE_WITHIN,
    counted_pixels,
    reconstruction_scores,
)
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rendering.truth import Truth
from rectbench.types import BoolArray


def sweep_scores(swept: SweptDepth, truth: Truth) -> dict[str, float]:
    """The columns of swept depth of a row, counted at the pixels that those of a reconstruction are.

    NaN where no pixel is counted.
    """
    left, pixels = truth.rig.left, counted_pixels(truth)
    u, v = pixels.astype(int).T
    error = np.abs(swept.at(pixels, left.size) / truth.depth_left[v, u] - 1)
    complete = error <= COMPLETE_WITHIN
    angle_deg = np.degrees(np.arccos(np.clip(left.unproject(pixels)[0][:, 2], -1, 1)))
    found = error[np.isfinite(error)]
    return {
        "sweep_density": _share(np.isfinite(error)),
        "sweep_completeness": _share(complete),
        **{
            f"sweep_completeness_{low}_{high}deg": _share(complete[(angle_deg >= low) & (angle_deg < high)])
            for low, high in ANGLES_DEG
        },
        "sweep_depth_error_median": float(np.median(found)) if found.size else math.nan,
    }


def _share(mask: BoolArray) -> float:
    return float(mask.mean()) if mask.size else math.nan


class PlaneSweep(Metric):
    """How much of what both cameras see a plane sweep on the source images finds; what rectifying gains."""

    name, topic = "plane_sweep", "Reconstruction"
    needs = frozenset({"truth", "images"})
    columns = (
        Column.share(
            "sweep_density",
            "density, unrectified",
            "higher",
            "Share of source pixels that get any depth by sweeping planes on the source images, which no "
            "method has a part in.",
        ),
        Column.share(
            "sweep_completeness",
            "completeness, unrectified",
            "higher",
            "Share of source pixels whose swept depth is within 5 % of the truth.",
            tolerance=Tolerance(0.0, 0.01),
        ),
        *(
            Column.share(
                f"sweep_completeness_{low}_{high}deg",
                f"completeness, unrectified, {low}–{high}°",
                "higher",
                f"That of the pixels {low}° to {high}° from the left camera's axis.",
                shown="pairs",
            )
            for low, high in ANGLES_DEG
        ),
        Column.share(
            "sweep_depth_error_median",
            "depth error, unrectified",
            "lower",
            "Median of |swept depth / true depth − 1|.",
        ),
        Column.share(
            "rectification_gain",
            "gain by rectifying",
            "higher",
            "Completeness of the rectified pair, matched by the report's matcher at as many pixels as are "
            "swept, less that of the sweep; below 0 rectifying costs surface. The matcher `ncc` scores as "
            "the sweep does, so that what is left is due to the maps.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """By a sweep with the true pose, and a reconstruction at its size."""
        images, truth = case.pair.images, case.pair.truth
        scores = sweep_scores(plane_sweep(truth.rig, images.left, images.right, pixels=PIXELS), truth)
        rectified = reconstruct(case.rect, images.left, images.right, case.matcher, pixels=PIXELS)
        complete = reconstruction_scores(rectified, truth)["reconstruction_completeness"]
        return {**scores, "rectification_gain": complete - scores["sweep_completeness"]}
