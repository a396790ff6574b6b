"""Row error of matches found on the rectified images, as Zhou, Dai and Li measure it."""

from __future__ import annotations

import numpy as np

from rectbench.errors import PoseNotFound
from rectbench.matching import match_features
from rectbench.matching.pose.epipolar import Pose, RayMatches, essential, sampson_px
from rectbench.metrics.row_error import row_error
from rectbench.plugins.metric import Case, Column, Metric
from rectbench.rigs import Rig
from rectbench.types import Matches
from rectbench.warps import Rectification

WORKING_PIXELS = 2_100_000
"""Features of a larger rectified image are found at this size, as those of a source image are."""
FARTHEST_PX = 3.0
"""Matches farther from the epipolar geometry, in source pixels, are gross outliers."""


class RectifiedFeatureRowError(Metric):
    """Row error of SIFT matches found on the rectified images."""

    name, topic = "row_error_rectified_features", "Row error"
    needs = frozenset({"images"})
    columns = (
        Column.pixels(
            "row_error_rectified_features_mean_px",
            "row error, SIFT on rectified",
            "Mean row error of SIFT matches found on the rectified images, each method's own; in pixels of "
            "the rectified images.",
        ),
        Column.pixels(
            "row_error_rectified_features_source_mean_px",
            "row error, SIFT on rectified, source",
            "The same in pixels of the source images.",
        ),
        Column.count(
            "row_error_rectified_features_matches",
            "SIFT matches on rectified",
            "Matches found on the rectified images, without gross outliers.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Nothing, and a remark why, where no pose tells wrong matches from right ones."""
        by_estimate = case.pose_is_estimated or not case.pair.knows_truth
        try:
            rig = case.pair.estimate.rig(case.rig) if by_estimate else case.rig
        except PoseNotFound as failure:
            case.remarks["no_features"] = str(failure)
            return {}
        images, rect = case.pair.images, case.rect
        found = match_features(*rect.remap(images.left, images.right), working_pixels=WORKING_PIXELS)
        errors = row_error(rect, *without_gross_outliers(source_matches(rect, found), rig)).columns()
        return {column.key: errors[column.key.replace("_rectified_features", "")] for column in self.columns}


def source_matches(rect: Rectification, found: Matches) -> Matches:
    """Source pixels [N, 2] each of matches between the rectified images, of those that show source pixels."""
    left, right = rect.left.inverse(found.left), rect.right.inverse(found.right)
    there = rect.left.source.contains(left) & rect.right.source.contains(right)
    return Matches(left[there], right[there])


def without_gross_outliers(matches: Matches, rig: Rig) -> Matches:
    """The matches at most 3 px (Sampson's distance, source pixels) from the rig's epipolar geometry."""
    seen, _ = RayMatches.of(rig.left, rig.right, matches)
    pose = Pose(rig.R_right_left, rig.t_right_left / rig.baseline_m)
    near = np.abs(sampson_px(seen.terms(), essential(pose))[0]) <= FARTHEST_PX
    return seen[near].pixels
