"""Matches between images, and the geometry they determine."""

from rectbench.matching.features import sift_matches
from rectbench.matching.fundamental import fundamental_matrix, sampson_residuals

__all__ = ["fundamental_matrix", "sampson_residuals", "sift_matches"]
