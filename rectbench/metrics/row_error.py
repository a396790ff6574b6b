"""Row error: how far from one common row the two images of a point end up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.types import FloatArray, Matches
from rectbench.warps import Rectification, Warp
from rectbench.warps.jacobians import finite
from rectbench.warps.rectification import in_frame

SCORED_MATCHES = 10_000
"""True correspondences that it is taken over."""
EQUAL_SHARES = (0.5, 0.95)
"""Shares of the view on which methods are compared by the same correspondences."""


@dataclass(frozen=True, eq=False)
class RowError:
    """|v̂_left - v̂_right| of correspondences; NaN for those that do not land in both images.

    Of images whose epipolar curves are stated to be no rows, how far apart these are: `curves_apart`.
    """

    rectified_px: FloatArray
    """[N], pixels of the rectified image."""
    source_px: FloatArray
    """[N], divided by the mean |∇v̂| of the two images: shrinking an image shrinks only the first.

    To first order the distance of one point to the other's epipolar curve, in source pixels; a method cannot
    lower it, nor do two methods that know one pose differ in it.
    """

    def columns(self) -> dict[str, float]:
        """The row error columns of a result row, over all correspondences that are shown."""
        errors, in_source = finite(self.rectified_px), finite(self.source_px)
        count = errors.size
        if not count:
            errors = in_source = np.full(1, math.nan)
        return {
            "row_error_mean_px": float(errors.mean()),
            "row_error_median_px": float(np.median(errors)),
            "row_error_rms_px": float(np.sqrt(np.square(errors).mean())),
            "row_error_p95_px": float(np.quantile(errors, 0.95)),
            "row_error_max_px": float(errors.max()),
            "row_error_below_1px": float((errors <= 1).mean()) if count else math.nan,
            "row_error_source_mean_px": float(in_source.mean()),
            "row_error_source_median_px": float(np.median(in_source)),
            "row_error_source_p95_px": float(np.quantile(in_source, 0.95)),
            "row_error_matches": float(count),
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
    error = np.where(shown, np.abs(rect.curves_apart(*mapped)), np.nan)
    gradients = [_across(rect.left, left, mapped[0]), _across(rect.right, right, mapped[1])]
    return RowError(error, error / ((gradients[0] + gradients[1]) / 2))


def _across(warp: Warp, pixels: FloatArray, px_rect: FloatArray) -> FloatArray:
    """[N], rectified pixels across the epipolar curve, |∇v̂| where it is a row, a source pixel at the most."""
    normals = warp.target.curve_normals(px_rect)
    gradients = np.einsum("...i,...ij->...j", normals, warp.jacobian(pixels))
    across: FloatArray = np.linalg.norm(gradients, axis=-1) / np.linalg.norm(normals, axis=-1)
    return across


def on_equal_view(
    case: Case, matches: Matches, errors: RowError, prefix: str = "row_error"
) -> dict[str, float]:
    """Mean row errors of the correspondences on each of `EQUAL_SHARES` of the view that the method keeps.

    Both pixels of a correspondence lie in A_s, so that these are the same for all methods that have a number.
    """
    found: dict[str, float] = {}
    for share in EQUAL_SHARES:
        inside = case.pair.scored_view.matches_within(*matches, share)
        if not (case.delivered.keeps(share) and np.isfinite(errors.rectified_px[inside]).any()):
            continue
        percent = f"{100 * share:.0f}"
        found[f"{prefix}_{percent}_mean_px"] = float(np.nanmean(errors.rectified_px[inside]))
        found[f"{prefix}_source_{percent}_mean_px"] = float(np.nanmean(errors.source_px[inside]))
    return found


def equal_view_columns(prefix: str, heading: str, matches: str, **more: Any) -> tuple[Column, ...]:
    """The columns of `on_equal_view`; `more` is said of those in rectified pixels."""
    columns = []
    for share in EQUAL_SHARES:
        percent = f"{100 * share:.0f}"
        same = f"{matches} on the {percent} % of the view nearest to its middle, the same for all methods."
        columns += [
            Column.pixels(
                f"{prefix}_{percent}_mean_px", f"{heading}, {percent} %", f"Mean row error of {same}", **more
            ),
            Column.pixels(
                f"{prefix}_source_{percent}_mean_px",
                f"{heading}, source, {percent} %",
                f"Mean distance to the epipolar curve, in source pixels, of {same}",
                shown="pairs",
            ),
        ]
    return tuple(columns)


class RowErrorMetric(Metric):
    """Row error of true correspondences."""

    name, topic = "row_error", "Row error"
    needs = frozenset({"true_matches"})
    columns = (
        Column.pixels(
            "row_error_mean_px",
            "row error",
            "Mean distance in rows between those true correspondences that the method shows, in pixels of"
            " the "
            "rectified images. 0 for every calibrated method if the pose is exact.",
            tolerance=Tolerance(0.02, 1e-6),
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
            "Row error in pixels of the source images, the distance to the epipolar curve: shrinking the "
            "output "
            "gains nothing, and methods that know the same pose do not differ.",
            tolerance=Tolerance(0.02, 1e-6),
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
        *equal_view_columns(
            "row_error",
            "row error",
            "the true correspondences",
            tolerance=Tolerance(0.02, 1e-6),
            shown="summary",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of 10,000 exact correspondences."""
        matches = case.pair.true_matches
        errors = row_error(case.rect, *matches)
        return errors.columns() | on_equal_view(case, matches, errors)
