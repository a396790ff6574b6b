"""What a rectification is scored by: distortion, sampling, row error, coverage, order, uncertainty."""

from rectbench.metrics.coverage import coverage, dense_pixels
from rectbench.metrics.distortion import Distortion, distortion, distortion_of, log_distortion
from rectbench.metrics.energy import energy_convex_share
from rectbench.metrics.frame import frame_costs
from rectbench.metrics.order import order
from rectbench.metrics.reconstruction import reconstruction_scores
from rectbench.metrics.rows import RowError, row_error
from rectbench.metrics.sampling import every_pixel, per_pixel
from rectbench.metrics.scoring import distortion_columns, measure
from rectbench.metrics.uncertainty import Uncertainty, uncertainty
from rectbench.warps.jacobians import Jacobians

__all__ = [
    "Distortion",
    "Jacobians",
    "RowError",
    "Uncertainty",
    "coverage",
    "dense_pixels",
    "distortion",
    "distortion_columns",
    "distortion_of",
    "energy_convex_share",
    "every_pixel",
    "frame_costs",
    "log_distortion",
    "measure",
    "order",
    "per_pixel",
    "reconstruction_scores",
    "row_error",
    "uncertainty",
]
