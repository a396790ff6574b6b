"""The columns of a run as readers meet them: heading, unit, direction, digits, meaning.

One entry a column; tables, figures and the page's glossary all read it. A metric that is not listed
here (a plugin's own, a newer one) is shown too, under a heading made from its name.
"""

from __future__ import annotations

from rectbench.plugins.metric import Average, Better, Column


def _pixels(key: str, heading: str, meaning: str, average: Average = "mean") -> Column:
    return Column(key, heading, "px", "lower", meaning, average=average, floor=1e-6)


def _share(key: str, heading: str, better: Better | None, meaning: str) -> Column:
    return Column(key, heading, "%", better, meaning, scale=100.0)


def _distortion(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, "", "lower", meaning, floor=1e-6)


def _milliseconds(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, "ms", "lower", meaning, scale=1000.0)


def _relative(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, "%", "lower", meaning, scale=100.0)


def _count(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, meaning=meaning, is_count=True)


METRICS: tuple[Column, ...] = (
    _pixels(
        "row_error_mean_px",
        "row error",
        "Mean distance in rows between true correspondences that both cameras see, in pixels of the "
        "rectified images. 0 for every calibrated method if the pose is exact.",
    ),
    _pixels("row_error_median_px", "row error, median", "Median of the same distances."),
    _pixels("row_error_p95_px", "row error, p95", "95th percentile of the same distances."),
    _pixels("row_error_max_px", "row error, max", "Largest of the same distances.", "max"),
    _pixels("row_error_rms_px", "row error, RMS", "Root mean square of the same distances.", "rms"),
    _share("row_error_below_1px", "rows ≤ 1 px", "higher", "Share of correspondences at most one row apart."),
    _pixels(
        "row_error_source_mean_px",
        "row error, source",
        "Row error in pixels of the source images, so that shrinking the output gains nothing.",
    ),
    _pixels("row_error_source_median_px", "row error, source, median", "Median of those."),
    _pixels("row_error_source_p95_px", "row error, source, p95", "95th percentile of those."),
    _count("row_error_matches", "correspondences", "True correspondences that the row error is taken over."),
    _pixels(
        "row_error_board_mean_px",
        "row error, board",
        "Mean row error of a calibration board's corners, where both images show one: exact to some "
        "hundredths of a pixel, and the measure to trust where nobody knows the truth.",
    ),
    _pixels("row_error_board_median_px", "row error, board, median", "Median row error of these corners."),
    _pixels("row_error_board_p95_px", "row error, board, p95", "95th percentile of the same."),
    _pixels(
        "row_error_board_source_mean_px",
        "row error, board, source",
        "The same mean in pixels of the source images.",
    ),
    _count("row_error_board_points", "board corners", "Corners of a board that the row error is taken over."),
    _pixels(
        "row_error_features_mean_px",
        "row error, SIFT",
        "Mean row error of SIFT matches found in the images; it holds the detector's own noise.",
    ),
    _pixels("row_error_features_median_px", "row error, SIFT, median", "Median row error of SIFT matches."),
    _pixels(
        "row_error_features_source_mean_px",
        "row error, SIFT, source",
        "Mean row error of SIFT matches in pixels of the source images.",
    ),
    _count("row_error_features_matches", "SIFT matches", "SIFT matches that their row error is taken over."),
    _distortion(
        "log_distortion",
        "log distortion",
        "RMS of the logarithms of the local stretches σ1 ≥ σ2 about their common mean. Free of "
        "scale, not lowered by shrinking an image: methods are ranked by it.",
    ),
    _distortion("log_distortion_area", "log distortion, area", "The part of it that is change of area."),
    _distortion(
        "log_distortion_anisotropy",
        "log distortion, shape",
        "The part of it that is stretch in one direction.",
    ),
    _distortion(
        "distortion_native",
        "distortion, native",
        "The paper's mean L per pixel, at the scale each method's authors choose. An image shrunk to "
        "nothing has L = 1.",
    ),
    _distortion("distortion_rescaled", "distortion, rescaled", "L after the one scale that is best for it."),
    _distortion(
        "distortion_stretched", "distortion, stretched", "L after the best scales of width and of height."
    ),
    _distortion("distortion_native_median", "distortion, median", "Median of native L over the pixels."),
    _distortion("distortion_native_p95", "distortion, p95", "95th percentile of native L over the pixels."),
    _distortion(
        "distortion_native_all_pixels", "native, all pixels", "Native L over every pixel, not the grid."
    ),
    _distortion(
        "distortion_rescaled_all_pixels", "rescaled, all pixels", "The same after the one best scale."
    ),
    _distortion(
        "distortion_stretched_all_pixels",
        "stretched, all pixels",
        "The same after the best scales of width and of height.",
    ),
    _distortion("distortion_native_area", "distortion, area term", "The part of native L from (S − 1)²."),
    _distortion("distortion_native_ratio", "distortion, ratio term", "The part from ½(|w1| − |w2|)²."),
    _distortion("distortion_native_skew", "distortion, skew term", "The part from ½(w1·w2)²."),
    _share(
        "distortion_pixels_mapped",
        "grid mapped",
        "higher",
        "Share of the grid's pixels that are mapped at all.",
    ),
    _share(
        "sampling_lost", "pixels lost", "lower", "Share of source area squeezed (σ2 < 1): detail is lost."
    ),
    _share(
        "sampling_invented",
        "pixels invented",
        "lower",
        "Share of source area enlarged (σ1 > 1): interpolated.",
    ),
    Column(
        "output_pixels_per_source_pixel",
        "output / source",
        "px/px",
        None,
        "Pixels of output spent on one pixel of source.",
    ),
    _share("coverage_pixels", "pixels kept", "higher", "Share of source pixels that reach the output."),
    _share(
        "coverage_solid_angle",
        "field of view kept",
        "higher",
        "Share of the lens's solid angle that is kept.",
    ),
    _share(
        "coverage_overlap", "overlap kept", "higher", "Share of the view common to both cameras that is kept."
    ),
    _share("valid_output", "output used", "higher", "Share of the output that shows anything."),
    Column(
        "order_du_dgamma_min",
        "least ∂û/∂γ",
        "px/rad",
        None,
        "Least growth of the column along an epipolar line; below 0, points change places.",
        average="min",
    ),
    Column(
        "order_dv_dbeta_min",
        "least ∂v̂/∂β",
        "px/rad",
        None,
        "Least growth of the row from one epipolar line to the next; below 0, rows change places.",
        average="min",
    ),
    _share("order_upright", "upright", "higher", "Share of pixels that are not mirrored (det J > 0)."),
    _pixels("closure_px", "closure", "Largest |inverse(forward(x)) − x| in source pixels.", "max"),
    Column(
        "pose_rotation_error_deg",
        "rotation error",
        "°",
        "lower",
        "Angle between the estimated relative rotation and the true one.",
    ),
    Column(
        "pose_rotation_sigma_deg",
        "rotation σ",
        "°",
        None,
        "What the estimate believes of that: its standard deviation, from its own covariance.",
    ),
    Column(
        "pose_direction_error_deg",
        "direction error",
        "°",
        "lower",
        "Angle between the estimated direction of the baseline and the true one.",
    ),
    Column("pose_direction_sigma_deg", "direction σ", "°", None, "What the estimate believes of that."),
    Column(
        "pose_rotation_difference_deg",
        "rotation, difference",
        "°",
        None,
        "Angle between the relative rotation that the images tell and the calibration's.",
    ),
    Column(
        "pose_direction_difference_deg",
        "direction, difference",
        "°",
        None,
        "Angle between the baseline's direction that the images tell and the calibration's.",
    ),
    _count("pose_matches", "matches", "Matches that the pose was looked for in."),
    _count("pose_inliers", "inliers", "Matches that agree with the estimated pose."),
    _share("reconstruction_density", "density", "higher", "Share of source pixels that get any depth."),
    _share(
        "reconstruction_completeness",
        "completeness",
        "higher",
        "Share of source pixels whose depth is within 5 % of the truth. Counted, as all of these, at the "
        "pixels of the left source image that both cameras see.",
    ),
    *(
        _share(
            f"reconstruction_completeness_{low}_{high}deg",
            f"completeness, {low}–{high}°",
            "higher",
            f"Completeness of the pixels {low}° to {high}° from the left camera's axis.",
        )
        for low, high in ((0, 20), (20, 40), (40, 60), (60, 90))
    ),
    _relative("depth_error_median", "depth error, median", "Median of |depth / true depth - 1|."),
    _relative("depth_error_p95", "depth error, p95", "95th percentile of the same."),
    _pixels(
        "dense_epe_px",
        "disparity error",
        "Mean distance between a pixel's dense match and its true place, in right source pixels.",
    ),
    *(
        _share(
            f"dense_bad_{px}px",
            f"bad > {px} px",
            "lower",
            f"Share of source pixels whose dense match is missing or more than {px} px off.",
        )
        for px in (1, 2, 4)
    ),
    _share(
        "energy_convex_share",
        "energy convex",
        None,
        "Share of the energy's slices where the rows keep their order, out to ±50 % of the slope, on which "
        "L is convex.",
    ),
    _milliseconds("pose_s", "pose", "Time from the two images to their relative pose."),
    _milliseconds("fit_s", "fit", "Time to fit the rectification."),
    _milliseconds("maps_s", "maps", "Time to make both lookup tables."),
    _milliseconds("warp_s", "warp", "Time to warp both images, their tables included."),
    _milliseconds("total_s", "total", "Time from the two images to the rectified pair: pose, fit and warp."),
)
"""Every known metric, in the order in which tables show them."""

MAIN_KEYS = (
    "log_distortion",
    "distortion_native",
    "distortion_rescaled",
    "distortion_stretched",
    "row_error_mean_px",
    "row_error_p95_px",
    "row_error_source_mean_px",
    "coverage_pixels",
    "coverage_solid_angle",
    "sampling_lost",
    "fit_s",
    "maps_s",
)
"""Columns of the main table."""

PHOTOGRAPH_KEYS = (
    "log_distortion",
    "distortion_native",
    "distortion_rescaled",
    "distortion_stretched",
    "row_error_board_mean_px",
    "row_error_board_source_mean_px",
    "row_error_features_mean_px",
    "row_error_features_source_mean_px",
    "coverage_pixels",
    "coverage_solid_angle",
    "sampling_lost",
    "fit_s",
    "maps_s",
)
"""Columns of the main table where the images are photographs."""

DISTORTION_KEYS = (
    "log_distortion",
    "log_distortion_area",
    "log_distortion_anisotropy",
    "distortion_native",
    "distortion_rescaled",
    "distortion_stretched",
    "distortion_native_median",
    "distortion_native_p95",
)
"""Columns of the table that compares the protocols."""

ALL_PIXELS_KEYS = tuple(f"distortion_{name}_all_pixels" for name in ("native", "rescaled", "stretched"))
"""The same comparison over every pixel."""

PROTOCOLS = {
    "distortion_native": "native: as its authors scale it",
    "distortion_rescaled": "rescaled: best single scale",
    "distortion_stretched": "stretched: best width and height",
    "distortion_native_all_pixels": "native, over all pixels",
}
"""The ways to compare L, and what each is called above a panel."""

ROW_ERRORS = {
    "row_error_board_mean_px": "of a board's corners",
    "row_error_features_mean_px": "of SIFT matches",
    "row_error_mean_px": "of true correspondences",
}
"""The ways to measure row error that stand side by side."""

POSE_KEYS = (
    "pose_rotation_error_deg",
    "pose_rotation_difference_deg",
    "pose_rotation_sigma_deg",
    "pose_direction_error_deg",
    "pose_direction_difference_deg",
    "pose_direction_sigma_deg",
    "pose_matches",
    "pose_inliers",
)
ROW_KEYS = (
    "row_error_board_mean_px",
    "row_error_board_median_px",
    "row_error_board_p95_px",
    "row_error_board_source_mean_px",
    "row_error_board_points",
    "row_error_features_mean_px",
    "row_error_features_median_px",
    "row_error_features_source_mean_px",
    "row_error_features_matches",
    "row_error_mean_px",
    "row_error_median_px",
    "row_error_p95_px",
    "row_error_below_1px",
    "row_error_source_mean_px",
)
DEPTH_KEYS = (
    "reconstruction_density",
    "reconstruction_completeness",
    "reconstruction_completeness_0_20deg",
    "reconstruction_completeness_20_40deg",
    "reconstruction_completeness_40_60deg",
    "reconstruction_completeness_60_90deg",
    "depth_error_median",
    "depth_error_p95",
    "dense_epe_px",
    "dense_bad_1px",
    "dense_bad_2px",
    "dense_bad_4px",
)
"""Columns of the tables that speak of a pose, of rows, of depth."""

STAGES = {"pose_s": "pose", "fit_s": "fit", "warp_s": "warp", "total_s": "total"}
"""The stages of the pipeline by their columns; a table is part of the warp."""

RANKING_KEY = "log_distortion"
"""The metric methods are ranked by."""

_BY_KEY = {column.key: column for column in METRICS}
_UNITS = {"px": "px", "s": "s", "m": "m", "deg": "°"}


def column(key: str) -> Column:
    """The catalogue's entry for `key`, or one made from the name and its unit suffix."""
    if key in _BY_KEY:
        return _BY_KEY[key]
    stem, _, suffix = key.rpartition("_")
    if stem and suffix in _UNITS:
        return Column(key, stem.replace("_", " "), _UNITS[suffix])
    return Column(key, key.replace("_", " "))


def in_display_order(keys: set[str]) -> list[str]:
    """`keys` with the known ones first, in the catalogue's order, then the others by name."""
    return [c.key for c in METRICS if c.key in keys] + sorted(keys - _BY_KEY.keys())
