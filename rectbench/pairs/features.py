"""Feature matches of a rendered pair, freed of gross outliers by its geometry, for scoring alone."""

from __future__ import annotations

import numpy as np

from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import match_features
from rectbench.matching.pose.consistent import SCORING_PIXELS
from rectbench.rigs import Rig
from rectbench.types import Matches
from rectbench.warps import centre_resolution_px

FARTHEST_PX = 3.0
"""A match farther from its epipolar plane is a wrong match, not an imprecise one."""


def scored_features(images: StereoPair, rig: Rig) -> Matches:
    """SIFT matches [N, 2] each within 3 px of the rig's epipolar planes.

    The distance is the angle between the right ray and the plane of the left one, times the pixels
    per radian at the centre. A rectifier never sees these matches.
    """
    found = match_features(images.left, images.right, working_pixels=SCORING_PIXELS)
    rays_left, ok_left = rig.left.unproject(found.left)
    rays_right, ok_right = rig.right.unproject(found.right)
    normals = rays_left @ rig.essential_matrix.T
    with np.errstate(invalid="ignore", divide="ignore"):
        sines = (rays_right * normals).sum(axis=-1) / np.linalg.norm(normals, axis=-1)
        near = np.abs(np.arcsin(np.clip(sines, -1, 1))) * centre_resolution_px(rig) <= FARTHEST_PX
    kept = ok_left & ok_right & near
    return Matches(found.left[kept], found.right[kept])
