"""Matches between images, and the geometry they determine."""

from rectbench.matching.boards import BoardMatches, board_matches
from rectbench.matching.consistent import agreeing_matches, consistent_matches
from rectbench.matching.dense import Disparity, dense_disparity
from rectbench.matching.features import match_features, sift_matches
from rectbench.matching.fundamental import fundamental_matrix, sampson_residuals
from rectbench.matching.matchers import MATCHERS
from rectbench.matching.pose import PoseEstimate, pose_from_images, relative_pose
from rectbench.matching.reconstruction import Reconstruction, reconstruct

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
