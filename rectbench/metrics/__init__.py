"""What a rectification is scored by: one file a metric, and what scores by them.

Imports plugins and what is below.
"""

from rectbench.metrics.analyses.floor import ExcessOverFloor as ExcessOverFloor
from rectbench.metrics.analyses.frame import frame_costs as frame_costs
from rectbench.metrics.analyses.uncertainty import Uncertainty as Uncertainty
from rectbench.metrics.analyses.uncertainty import uncertainty as uncertainty
from rectbench.metrics.coverage import coverage as coverage
from rectbench.metrics.distortion import Distortion as Distortion
from rectbench.metrics.distortion import distortion as distortion
from rectbench.metrics.distortion import distortion_of as distortion_of
from rectbench.metrics.energy import energy_convex_share as energy_convex_share
from rectbench.metrics.homography.gluckman_nayar import GluckmanNayar as GluckmanNayar
from rectbench.metrics.homography.loop_zhang import LoopZhang as LoopZhang
from rectbench.metrics.homography.mallon_whelan import MallonWhelan as MallonWhelan
from rectbench.metrics.homography.usr_cgd import UsrCgd as UsrCgd
from rectbench.metrics.log_distortion import log_distortion as log_distortion
from rectbench.metrics.log_distortion import log_distortion_on_view as log_distortion_on_view
from rectbench.metrics.order import order as order
from rectbench.metrics.paper.reconstruction_sizes import ReconstructionSizes as ReconstructionSizes
from rectbench.metrics.paper.row_error_rectified_features import (
    RectifiedFeatureRowError as RectifiedFeatureRowError,
)
from rectbench.metrics.paper.view_at_source_size import ViewAtSourceSize as ViewAtSourceSize
from rectbench.metrics.pose import Pose as Pose
from rectbench.metrics.reconstruction import reconstruction_scores as reconstruction_scores
from rectbench.metrics.row_error import RowError as RowError
from rectbench.metrics.row_error import row_error as row_error
from rectbench.metrics.row_error_board import BoardRowError as BoardRowError
from rectbench.metrics.row_error_features import FeatureRowError as FeatureRowError
from rectbench.metrics.row_misfit import RowMisfit as RowMisfit
from rectbench.metrics.row_misfit import row_misfit as row_misfit
from rectbench.metrics.sampling import sampling as sampling
from rectbench.metrics.timing import Timing as Timing
from rectbench.metrics.unrectified.plane_sweep import PlaneSweep as PlaneSweep
from rectbench.metrics.view import View as View
from rectbench.scored import dense_pixels as dense_pixels
from rectbench.warps.jacobians import Jacobians as Jacobians
