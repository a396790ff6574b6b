"""Row error of matches found in the images themselves."""

from __future__ import annotations

from rectbench.errors import PoseNotFound
from rectbench.metrics.row_error import equal_view_columns, on_equal_view, row_error
from rectbench.plugins.metric import Case, Column, Metric, Tolerance

PREFIX = "row_error_features"


class FeatureRowError(Metric):
    """Row error of SIFT matches found in the images."""

    name, topic = "row_error_features", "Row error"
    needs = frozenset({"images"})
    columns = (
        Column.pixels(
            "row_error_features_mean_px",
            "row error, SIFT",
            "Mean row error of SIFT matches found in the images; it holds the detector's own noise.",
            tolerance=Tolerance(0.1, 0.02),
            shown="summary",
            without_truth=True,
            promised=True,
            panel="of SIFT matches",
        ),
        Column.pixels(
            "row_error_features_median_px", "row error, SIFT, median", "Median row error of SIFT matches."
        ),
        Column.pixels(
            "row_error_features_source_mean_px",
            "row error, SIFT, source",
            "Mean row error of SIFT matches in pixels of the source images.",
            shown="summary",
            without_truth=True,
        ),
        Column.count(
            "row_error_features_matches", "SIFT matches", "SIFT matches that their row error is taken over."
        ),
        *equal_view_columns(PREFIX, "row error, SIFT", "the SIFT matches", shown="pairs"),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Nothing, and a remark why, where photographs tell no pose to free the matches of wrong ones."""
        try:
            matches = case.pair.features(by_estimate=case.pose_is_estimated)
        except PoseNotFound as failure:
            case.remarks["no_features"] = str(failure)
            return {}
        errors = row_error(case.rect, *matches)
        shown = {key.replace("row_error", PREFIX): value for key, value in errors.columns().items()}
        keys = {column.key for column in self.columns}
        return {k: v for k, v in shown.items() if k in keys} | on_equal_view(case, matches, errors, PREFIX)
