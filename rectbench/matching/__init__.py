"""Matches between images, and the geometry they determine. Imports warps, images and what is below."""

from rectbench.matching.boards.corners import BoardMatches as BoardMatches
from rectbench.matching.boards.corners import board_matches as board_matches
from rectbench.matching.dense.disparity import Disparity as Disparity
from rectbench.matching.dense.disparity import dense_disparity as dense_disparity
from rectbench.matching.dense.matcher import MATCHERS as MATCHERS
from rectbench.matching.dense.matcher import USUAL_MATCHER as USUAL_MATCHER
from rectbench.matching.dense.matcher import Matcher as Matcher
from rectbench.matching.dense.matcher import matcher as matcher
from rectbench.matching.dense.matcher import matcher_named as matcher_named
from rectbench.matching.dense.plane_sweep import SweptDepth as SweptDepth
from rectbench.matching.dense.plane_sweep import plane_sweep as plane_sweep
from rectbench.matching.dense.reconstruction import Reconstruction as Reconstruction
from rectbench.matching.dense.reconstruction import reconstruct as reconstruct
from rectbench.matching.features.matches import match_features as match_features
from rectbench.matching.features.matches import sift_matches as sift_matches
from rectbench.matching.pose.consistent import agreeing_matches as agreeing_matches
from rectbench.matching.pose.consistent import consistent_matches as consistent_matches
from rectbench.matching.pose.estimate import PoseEstimate as PoseEstimate
from rectbench.matching.pose.estimate import pose_from_images as pose_from_images
from rectbench.matching.pose.estimate import relative_pose as relative_pose
from rectbench.matching.pose.fundamental import fundamental_matrix as fundamental_matrix
from rectbench.matching.pose.fundamental import sampson_residuals as sampson_residuals
