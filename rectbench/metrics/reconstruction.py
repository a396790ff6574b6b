"""Reconstruction: how much of what both cameras see is found, where, and how far off it is."""

from __future__ import annotations

import math

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.matching import Reconstruction, reconstruct
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rendering.truth import Truth
from rectbench.scored import dense_pixels
from rectbench.types import BoolArray, FloatArray

BAD_PX = (1, 2, 4)
COMPLETE_WITHIN = 0.05
"""A pixel is reconstructed where its depth is off by no more than this share of the true one."""
ANGLES_DEG = ((0, 20), (20, 40), (40, 60), (60, 90))


def reconstruction_scores(reconstruction: Reconstruction, truth: Truth) -> dict[str, float]:
    """The reconstruction columns of a row.

    Counted at source pixels of the left image that both cameras really see, so that methods compare
    whatever the size and field of view of their images: a pixel that a method cuts off is one it
    did not find. In a large image every n-th pixel each way is looked at, about 150,000 in all.

    - `dense_bad_1px` (2, 4): share whose match is more than so far off in the right source image,
      in its pixels, or that have none. `dense_epe_px`: mean distance of those that have one.
    - `reconstruction_density`: share that have a depth. `reconstruction_completeness`: share whose
      depth, along the ray, is within 5 % of the true one; the same by angle from the left axis, in
      degrees. `depth_error_median`, `depth_error_p95`: relative, of those that have a depth.

    NaN where no pixel is counted. Raises InvalidInput for a truth about other cameras.
    """
    rect, left = reconstruction.rect, truth.rig.left
    pixels = counted_pixels(truth)
    u, v = pixels.astype(int).T
    error = depth_errors(reconstruction, truth, pixels)

    px_rect = rect.left.forward(pixels)
    disparity = reconstruction.disparity.at(px_rect)
    match = rect.right.inverse(px_rect - np.stack([disparity, np.zeros_like(disparity)], axis=-1))
    miss_px = np.linalg.norm(match - truth.right_pixels(u, v), axis=-1)
    complete = error <= COMPLETE_WITHIN
    z = left.unproject(pixels)[0][:, 2]
    angle_deg = np.degrees(np.arccos(np.clip(z, -1, 1)))
    rings = {
        f"reconstruction_completeness_{low}_{high}deg": _share(
            complete[(angle_deg >= low) & (angle_deg < high)]
        )
        for low, high in ANGLES_DEG
    }
    return {
        **{f"dense_bad_{limit}px": _share(~(miss_px <= limit)) for limit in BAD_PX},
        "dense_epe_px": _mean(miss_px),
        "reconstruction_density": _share(np.isfinite(error)),
        "reconstruction_completeness": _share(complete),
        "depth_error_median": _quantile(error, 0.5),
        "depth_error_p95": _quantile(error, 0.95),
        **rings,
    }


def counted_pixels(truth: Truth) -> FloatArray:
    """The pixels [N, 2] of the left source image that depth is scored at: those that both cameras see."""
    pixels = dense_pixels(truth.rig.left)
    u, v = pixels.astype(int).T
    counted: BoolArray = truth.visible_left[v, u] & np.isfinite(truth.depth_left[v, u])
    return np.asarray(pixels[counted])


def depth_errors(reconstruction: Reconstruction, truth: Truth, pixels: FloatArray) -> FloatArray:
    """|depth / true depth - 1| [N] at whole pixels [N, 2] of the left source image; NaN without a depth.

    Raises InvalidInput for a truth about other cameras.
    """
    source, left = reconstruction.rect.left.source, truth.rig.left
    if source.size != left.size:
        raise InvalidInput(
            f"the reconstruction is of {source.width}x{source.height} px images, "
            f"the truth of {left.width}x{left.height}"
        )
    u, v = pixels.astype(int).T
    depth = np.linalg.norm(reconstruction.points_at(reconstruction.rect.left.forward(pixels)), axis=-1)
    return np.asarray(np.abs(depth / truth.depth_left[v, u] - 1), dtype=np.float64)


def _share(mask: BoolArray) -> float:
    return float(mask.mean()) if mask.size else math.nan


def _mean(values: FloatArray) -> float:
    found = values[np.isfinite(values)]
    return float(found.mean()) if found.size else math.nan


def _quantile(values: FloatArray, q: float) -> float:
    found = values[np.isfinite(values)]
    return float(np.quantile(found, q)) if found.size else math.nan


class DenseReconstruction(Metric):
    """How much of what both cameras see dense matching on the rectified pair finds, and how far off."""

    name, topic = "reconstruction", "Reconstruction"
    needs = frozenset({"truth", "images"})
    columns = (
        Column.share(
            "reconstruction_density", "density", "higher", "Share of source pixels that get any depth."
        ),
        Column.share(
            "reconstruction_completeness",
            "completeness",
            "higher",
            "Share of source pixels whose depth is within 5 % of the truth. Counted, as all of these, at the "
            "pixels of the left source image that both cameras see.",
            tolerance=Tolerance(0.0, 0.01),
        ),
        *(
            Column.share(
                f"reconstruction_completeness_{low}_{high}deg",
                f"completeness, {low}–{high}°",
                "higher",
                f"Completeness of the pixels {low}° to {high}° from the left camera's axis.",
            )
            for low, high in ANGLES_DEG
        ),
        Column.share(
            "depth_error_median", "depth error, median", "lower", "Median of |depth / true depth - 1|."
        ),
        Column.share("depth_error_p95", "depth error, p95", "lower", "95th percentile of the same."),
        Column.pixels(
            "dense_epe_px",
            "disparity error",
            "Mean distance between a pixel's dense match and its true place, in right source pixels.",
        ),
        *(
            Column.share(
                f"dense_bad_{px}px",
                f"bad > {px} px",
                "lower",
                f"Share of source pixels whose dense match is missing or more than {px} px off.",
            )
            for px in BAD_PX
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """By the report's matcher on the images as the method rectifies them."""
        images = case.pair.images
        found = reconstruct(case.rect, images.left, images.right, case.matcher)
        return reconstruction_scores(found, case.pair.truth)
