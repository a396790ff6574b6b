"""How good a pose is that was estimated from the images, and how good it believes to be."""

from __future__ import annotations

from rectbench.plugins.metric import Case, Column, Metric, Tolerance


def _degrees(key: str, heading: str, meaning: str, tolerance: Tolerance | None = None) -> Column:
    return Column(key, heading, "°", "lower" if tolerance else None, meaning, tolerance=tolerance)


class Pose(Metric):
    """How far the pose that the images tell is from the true one; of photographs, from the calibration's."""

    name, topic = "pose", "Poses"
    needs = frozenset({"images"})
    columns = (
        _degrees(
            "pose_rotation_error_deg",
            "rotation error",
            "Angle between the estimated relative rotation and the true one.",
            Tolerance(0.05, 0.002),
        ),
        _degrees(
            "pose_rotation_difference_deg",
            "rotation, difference",
            "Angle between the relative rotation that the images tell and the calibration's.",
        ),
        _degrees(
            "pose_rotation_sigma_deg",
            "rotation σ",
            "What the estimate believes of that: its standard deviation, from its own covariance.",
        ),
        _degrees(
            "pose_direction_error_deg",
            "direction error",
            "Angle between the estimated direction of the baseline and the true one.",
            Tolerance(0.05, 0.01),
        ),
        _degrees(
            "pose_direction_difference_deg",
            "direction, difference",
            "Angle between the baseline's direction that the images tell and the calibration's.",
        ),
        _degrees("pose_direction_sigma_deg", "direction σ", "What the estimate believes of that."),
        Column.count("pose_matches", "matches", "Matches that the pose was looked for in."),
        Column.count("pose_inliers", "inliers", "Matches that agree with the estimated pose."),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Errors where the truth is known. Else differences: neither pose is the truth, and where they
        contradict each other that becomes a remark.
        """
        estimate, is_known = case.pair.estimate, case.pair.knows_truth
        rotation_deg, direction_deg = estimate.difference_deg(case.rig)
        if not is_known and (contradiction := estimate.contradiction(case.rig)):
            case.remarks["contradiction"] = contradiction
        kind = "error" if is_known else "difference"
        return {
            f"pose_rotation_{kind}_deg": rotation_deg,
            f"pose_direction_{kind}_deg": direction_deg,
            "pose_rotation_sigma_deg": estimate.rotation_sigma_deg,
            "pose_direction_sigma_deg": estimate.direction_sigma_deg,
            "pose_inliers": float(len(estimate.inliers.left)),
            "pose_matches": float(estimate.given),
        }
