"""All metrics of one rectification, as the columns of a result row."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rectbench.errors import PoseNotFound
from rectbench.matching import reconstruct
from rectbench.metrics.coverage import coverage
from rectbench.metrics.distortion import PROTOCOLS, distortion_of, log_distortion
from rectbench.metrics.energy import energy_convex_share
from rectbench.metrics.order import order
from rectbench.metrics.reconstruction import reconstruction_scores
from rectbench.metrics.rows import row_error
from rectbench.metrics.sampling import every_pixel
from rectbench.metrics.stopwatch import timed, warm_seconds
from rectbench.plugins.metric import Case
from rectbench.rigs import Rig
from rectbench.types import Matches
from rectbench.warps import Rectification
from rectbench.warps.jacobians import Jacobians

BOARD_ERRORS = ("mean", "median", "p95", "source_mean")
"""What is told of the row errors of a board's corners."""


def measure(
    rect: Rectification,
    rig: Rig,
    *,
    geometry: bool = True,
    true_matches: Matches | None = None,
    feature_matches: Matches | None = None,
    board_matches: Matches | None = None,
) -> dict[str, float]:
    """The metric columns of a row.

    Parameters
    ----------
    rect : what the method made of the rig it believed in.
    rig : the true rig.
    geometry : whether to score distortion, sampling, coverage and order, which need no match.
    true_matches : exact correspondences, unoccluded in both images.
    feature_matches : correspondences found in the images; scored apart.
    board_matches : corners of a calibration board found in them; scored apart.
    """
    row: dict[str, float] = {}
    if true_matches is not None:
        row |= row_error(rect, *true_matches).columns()
    if feature_matches is not None:
        features = row_error(rect, *feature_matches).columns()
        names = (
            "row_error_mean_px",
            "row_error_median_px",
            "row_error_source_mean_px",
            "row_error_matches",
        )
        row |= {name.replace("row_error", "row_error_features"): features[name] for name in names}
    if board_matches is not None:
        board = row_error(rect, *board_matches).columns()
        row |= {f"row_error_board_{name}_px": board[f"row_error_{name}_px"] for name in BOARD_ERRORS}
        row["row_error_board_points"] = board["row_error_matches"]
    return row | _geometry(rect, rig) if geometry else row


def _geometry(rect: Rectification, rig: Rig) -> dict[str, float]:
    at_grid = Jacobians.at(rect)
    native = distortion_of(at_grid, "native")
    row = {
        **distortion_columns(at_grid),
        "distortion_native_median": native.median,
        "distortion_native_p95": native.p95,
        "distortion_pixels_mapped": at_grid.valid_share,
    }
    row |= {f"distortion_native_{term}": value for term, value in native.terms.items()}
    return row | every_pixel(rect) | log_distortion(at_grid) | coverage(rect, rig) | order(rect, rig)


def distortion_columns(at_grid: Jacobians) -> dict[str, float]:
    """L under each protocol, the cheapest of the metrics."""
    return {f"distortion_{protocol}": float(distortion_of(at_grid, protocol)) for protocol in PROTOCOLS}


def needs_of(asked: Sequence[str]) -> frozenset[str]:
    images = {"row_error_features", "row_error_board", "reconstruction"}
    return frozenset({"images"} if images & set(asked) else set())


def scoring_digest(asked: Sequence[str]) -> str:
    return ""


def score(case: Case, asked: Sequence[str]) -> dict[str, float]:
    pair, rig, rectification = case.pair, case.rig, case.rect
    columns: dict[str, float] = {}
    if "timing" in asked and case.fit:
        columns["fit_s"] = warm_seconds(case.fit, case.first_fit_s)
    features, board = None, pair.board if "row_error_board" in asked else None
    if board is not None:
        case.remarks["board"] = board.kind
    if "row_error_features" in asked:
        try:
            features = pair.features(by_estimate=case.pose_is_estimated)
        except PoseNotFound as failure:
            case.remarks["no_features"] = str(failure)
    columns |= measure(
        rectification,
        rig,
        geometry="geometry" in asked,
        true_matches=pair.true_matches if "row_error" in asked else None,
        feature_matches=features,
        board_matches=board.matches if board else None,
    )
    if "distortion" in asked:
        columns |= distortion_columns(case.jacobians)
    if case.pose_is_estimated:
        estimate = pair.estimate
        rotation_deg, direction_deg = estimate.difference_deg(rig)
        kind = "error" if pair.knows_truth else "difference"
        columns |= {
            f"pose_rotation_{kind}_deg": rotation_deg,
            f"pose_direction_{kind}_deg": direction_deg,
            "pose_rotation_sigma_deg": estimate.rotation_sigma_deg,
            "pose_direction_sigma_deg": estimate.direction_sigma_deg,
            "pose_inliers": float(len(estimate.inliers.left)),
            "pose_matches": float(estimate.given),
        }
        if not pair.knows_truth and (contradiction := estimate.contradiction(rig)):
            case.remarks["contradiction"] = contradiction
    if "energy" in asked:
        columns["energy_convex_share"] = energy_convex_share(rectification)
    if "reconstruction" in asked:
        found = reconstruct(rectification, pair.images.left, pair.images.right)
        columns |= reconstruction_scores(found, pair.truth)
    if "timing" in asked:
        _, columns["maps_s"] = timed(lambda: (rectification.maps("left"), rectification.maps("right")))
        left, right = (
            np.full((camera.height, camera.width, 3), 127, dtype=np.uint8)
            for camera in (rectification.left.source, rectification.right.source)
        )
        _, columns["warp_s"] = timed(lambda: rectification.remap(left, right))
        if case.pose_is_estimated:
            columns["pose_s"] = pair.pose_seconds()
            columns["total_s"] = columns["pose_s"] + columns["fit_s"] + columns["warp_s"]
    return columns
