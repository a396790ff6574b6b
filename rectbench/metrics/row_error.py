"""Row error: how far from one common row the two images of a point end up."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.types import FloatArray
from rectbench.warps import Rectification
from rectbench.warps.jacobians import finite
from rectbench.warps.rectification import in_frame

SCORED_MATCHES = 10_000
"""True correspondences that it is taken over."""


@dataclass(frozen=True, eq=False)
class RowError:
    """|v̂_left - v̂_right| of correspondences; NaN for those that do not land in both images."""

    rectified_px: FloatArray
    """[N], pixels of the rectified image."""
    source_px: FloatArray
    """[N], divided by the mean |∇v̂| of the two images: shrinking an image shrinks only the first."""

    def columns(self) -> dict[str, float]:
        """The row error columns of a result row."""
        errors, in_source = finite(self.rectified_px), finite(self.source_px)
        names = [column.key for column in RowErrorMetric.columns]
        if not errors.size:
            return {**dict.fromkeys(names, math.nan), "row_error_matches": 0.0}
        return {
            "row_error_mean_px": float(errors.mean()),
            "row_error_median_px": float(np.median(errors)),
            "row_error_rms_px": float(np.sqrt(np.square(errors).mean())),
            "row_error_p95_px": float(np.quantile(errors, 0.95)),
            "row_error_max_px": float(errors.max()),
            "row_error_below_1px": float((errors <= 1).mean()),
            "row_error_source_mean_px": float(in_source.mean()),
            "row_error_source_median_px": float(np.median(in_source)),
            "row_error_source_p95_px": float(np.quantile(in_source, 0.95)),
            "row_error_matches": float(errors.size),
        }


def row_error(rect: Rectification, px_left: ArrayLike, px_right: ArrayLike) -> RowError:
    """Row error of the correspondences px_left ↔ px_right, [N, 2] source pixels each.

    >>> import rectbench as rb
    >>> rect = rb.rectify(rb.load_rig("t265"), method="abraham")
    >>> same_place = [[400.0, 380.0]]
    >>> row_error(rect, same_place, same_place).rectified_px.shape
    (1,)
    """
    left, right = as_points(px_left, 2, "px_left"), as_points(px_right, 2, "px_right")
    if left.shape != right.shape:
        raise InvalidInput(f"px_left has shape {left.shape}, px_right {right.shape}; expected the same")
    mapped = rect.left.forward(left), rect.right.forward(right)
    shown = in_frame(mapped[0], rect.size) & in_frame(mapped[1], rect.size)
    error = np.where(shown, np.abs(mapped[0][..., 1] - mapped[1][..., 1]), np.nan)
    gradients = [
        np.hypot(J[..., 1, 0], J[..., 1, 1]) for J in (rect.left.jacobian(left), rect.right.jacobian(right))
    ]
    return RowError(error, error / ((gradients[0] + gradients[1]) / 2))


class RowErrorMetric(Metric):
    """Row error of true correspondences."""

    name, topic = "row_error", "Row error"
    needs = frozenset({"truth"})
    columns = (
        Column.pixels(
            "row_error_mean_px",
            "row error",
            "Mean distance in rows between true correspondences that both cameras see, in pixels of the "
            "rectified images. 0 for every calibrated method if the pose is exact.",
            tolerance=Tolerance(0.02, 1e-6),
            shown="summary",
            promised=True,
            panel="of true correspondences",
        ),
        Column.pixels(
            "row_error_median_px", "row error, median", "Median of the same distances.", promised=True
        ),
        Column.pixels(
            "row_error_p95_px",
            "row error, p95",
            "95th percentile of the same distances.",
            tolerance=Tolerance(0.05, 1e-6),
            shown="page",
            promised=True,
        ),
        Column.pixels(
            "row_error_max_px",
            "row error, max",
            "Largest of the same distances.",
            average="max",
            shown="pairs",
            promised=True,
        ),
        Column.pixels(
            "row_error_rms_px",
            "row error, RMS",
            "Root mean square of the same distances.",
            average="rms",
            shown="pairs",
        ),
        Column.share(
            "row_error_below_1px",
            "rows ≤ 1 px",
            "higher",
            "Share of correspondences at most one row apart.",
            promised=True,
        ),
        Column.pixels(
            "row_error_source_mean_px",
            "row error, source",
            "Row error in pixels of the source images, so that shrinking the output gains nothing.",
            tolerance=Tolerance(0.02, 1e-6),
            shown="page",
        ),
        Column.pixels(
            "row_error_source_median_px", "row error, source, median", "Median of those.", shown="pairs"
        ),
        Column.pixels(
            "row_error_source_p95_px", "row error, source, p95", "95th percentile of those.", shown="pairs"
        ),
        Column.count(
            "row_error_matches",
            "correspondences",
            "True correspondences that the row error is taken over.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of 10,000 exact correspondences, unoccluded in both images."""
        return row_error(case.rect, *case.pair.true_matches).columns()
