"""All metrics of one rectification, as the columns of a result row."""

from __future__ import annotations

from rectbench.metrics.coverage import coverage
from rectbench.metrics.distortion import PROTOCOLS, distortion_of, log_distortion
from rectbench.metrics.order import order
from rectbench.metrics.rows import row_error
from rectbench.metrics.sampling import every_pixel
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
