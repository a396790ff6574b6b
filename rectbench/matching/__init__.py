"""Matches between images, and the geometry they determine. Imports warps, images and what is below."""

from rectbench.matching.boards.corners import BoardMatches, board_matches
from rectbench.matching.dense.disparity import Disparity, dense_disparity
from rectbench.matching.dense.matchers import MATCHERS
from rectbench.matching.dense.reconstruction import Reconstruction, reconstruct
from rectbench.matching.features.matches import match_features, sift_matches
from rectbench.matching.pose.consistent import agreeing_matches, consistent_matches
from rectbench.matching.pose.estimate import PoseEstimate, pose_from_images, relative_pose
from rectbench.matching.pose.fundamental import fundamental_matrix, sampson_residuals

__all__ = [
    "MATCHERS",
    "BoardMatches",
    "Disparity",
    "PoseEstimate",
    "Reconstruction",
    "agreeing_matches",
    "board_matches",
    "consistent_matches",
    "dense_disparity",
    "fundamental_matrix",
    "match_features",
    "pose_from_images",
    "reconstruct",
    "relative_pose",
    "sampson_residuals",
    "sift_matches",
]
