"""What a rectification is scored by: one file a metric, their catalogue, and what scores by them.

Imports plugins and what is below.
"""

from rectbench.metrics.analyses.frame import frame_costs
from rectbench.metrics.analyses.uncertainty import Uncertainty, uncertainty
from rectbench.metrics.coverage import coverage, dense_pixels
from rectbench.metrics.distortion import Distortion, distortion, distortion_of
from rectbench.metrics.energy import energy_convex_share
from rectbench.metrics.log_distortion import log_distortion
from rectbench.metrics.order import order
from rectbench.metrics.pose import Pose
from rectbench.metrics.reconstruction import reconstruction_scores
from rectbench.metrics.row_error import RowError, row_error
from rectbench.metrics.row_error_board import BoardRowError
from rectbench.metrics.row_error_features import FeatureRowError
from rectbench.metrics.sampling import every_pixel, per_pixel
from rectbench.metrics.timing import Timing
from rectbench.warps.jacobians import Jacobians

__all__ = [
    "BoardRowError",
    "Distortion",
    "FeatureRowError",
    "Jacobians",
    "Pose",
    "RowError",
    "Timing",
    "Uncertainty",
    "coverage",
    "dense_pixels",
    "distortion",
    "distortion_of",
    "energy_convex_share",
    "every_pixel",
    "frame_costs",
    "log_distortion",
    "order",
    "per_pixel",
    "reconstruction_scores",
    "row_error",
    "uncertainty",
]
