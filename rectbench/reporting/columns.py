"""The columns of a run as readers meet them: heading, unit, direction, digits, meaning.

One entry a column; tables, figures and the page's glossary all read it. A metric that is not listed
here (a plugin's own, a newer one) is shown too, under a heading made from its name.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Average = Literal["mean", "rms", "max", "min"]


@dataclass(frozen=True)
class Column:
    """How one metric of the rows is shown.

    Parameters
    ----------
    key : the column's name in `results.parquet`.
    heading, unit : what stands above it; the shown number is the stored one times `scale`.
    better : which way is good, None where neither is.
    average : how cells are averaged. RMS values are pooled as such, a maximum stays one.
    floor : shown numbers below this are shown as "<floor".
    is_count : whether the number counts things, and is shown whole.
    meaning : one sentence for the glossary.
    """

    key: str
    heading: str
    unit: str = ""
    better: Literal["lower", "higher"] | None = None
    meaning: str = ""
    scale: float = 1.0
    average: Average = "mean"
    floor: float = 0.0
    is_count: bool = False

    @property
    def is_percentage(self) -> bool:
        """Whether the number is a share, shown with one decimal."""
        return self.unit == "%"

    @property
    def full_heading(self) -> str:
        """Heading with the unit in brackets."""
        return f"{self.heading} [{self.unit}]" if self.unit else self.heading


def _pixels(key: str, heading: str, meaning: str, average: Average = "mean") -> Column:
    return Column(key, heading, "px", "lower", meaning, average=average, floor=1e-6)


def _share(key: str, heading: str, better: Literal["lower", "higher"] | None, meaning: str) -> Column:
    return Column(key, heading, "%", better, meaning, scale=100.0)


def _distortion(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, "", "lower", meaning, floor=1e-6)


def _milliseconds(key: str, heading: str, meaning: str) -> Column:
    return Column(key, heading, "ms", "lower", meaning, scale=1000.0)


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
    _pixels("row_error_source_p95_px", "row error, source, p95", "95th percentile of those."),
    _count("row_error_matches", "correspondences", "True correspondences that the row error is taken over."),
    _pixels(
        "row_error_features_mean_px",
        "row error, SIFT",
        "Mean row error of SIFT matches found in the images; it holds the detector's own noise.",
    ),
    _pixels("row_error_features_median_px", "row error, SIFT, median", "Median row error of SIFT matches."),
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
        "distortion_native_all_pixels", "distortion, all pixels", "Native L over every pixel, not the grid."
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
    _milliseconds("fit_s", "fit", "Time to fit the rectification."),
    _milliseconds("maps_s", "maps", "Time to make both lookup tables."),
    _milliseconds("warp_s", "warp", "Time to warp both images."),
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
