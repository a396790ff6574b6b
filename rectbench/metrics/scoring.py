"""All metrics of one rectification, as the columns of a result row."""

from __future__ import annotations

from rectbench.metrics.coverage import coverage
from rectbench.metrics.distortion import PROTOCOLS, distortion_of, log_distortion
from rectbench.metrics.jacobians import Jacobians
from rectbench.metrics.order import order
from rectbench.metrics.rows import row_error
from rectbench.metrics.sampling import every_pixel
from rectbench.rigs import Rig
from rectbench.warps import Matches, Rectification


def measure(
    rect: Rectification,
    rig: Rig,
    *,
    true_matches: Matches | None = None,
    feature_matches: Matches | None = None,
) -> dict[str, float]:
    """The metric columns of a row.

    Parameters
    ----------
    rect : what the method made of the rig it believed in.
    rig : the true rig.
    true_matches : exact correspondences, unoccluded in both images.
    feature_matches : correspondences found in the images; scored apart.
    """
    at_grid = Jacobians.at(rect)
    scores = {protocol: distortion_of(at_grid, protocol) for protocol in PROTOCOLS}
    row: dict[str, float] = {}
    if true_matches is not None:
        row |= row_error(rect, *true_matches).columns()
    if feature_matches is not None:
        features = row_error(rect, *feature_matches).columns()
        names = ("row_error_mean_px", "row_error_median_px", "row_error_matches")
        row |= {name.replace("row_error", "row_error_features"): features[name] for name in names}
    row |= {f"distortion_{protocol}": float(score) for protocol, score in scores.items()}
    row |= {
        "distortion_native_median": scores["native"].median,
        "distortion_native_p95": scores["native"].p95,
        "distortion_pixels_mapped": at_grid.valid_share,
    }
    row |= {f"distortion_native_{term}": value for term, value in scores["native"].terms.items()}
    return row | every_pixel(rect) | log_distortion(at_grid) | coverage(rect, rig) | order(rect, rig)
