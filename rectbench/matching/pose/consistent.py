"""Feature matches that agree with one another, whatever the calibration."""

from __future__ import annotations

import numpy as np

from rectbench.cameras import Camera
from rectbench.errors import PoseNotFound
from rectbench.matching.features.matches import match_features
from rectbench.matching.pose.epipolar import Pose, RayMatches, essential, in_front, sampson_px
from rectbench.matching.pose.estimate import (
    FINEST_PX,
    LEAST_MATCHES,
    WITHIN_DEVIATIONS,
    PoseEstimate,
    pose_from_images,
)
from rectbench.matching.pose.evidence import depth_consistent
from rectbench.types import Images, Matches

SCORING_PIXELS = 2_100_000
"""Features of a larger image are found at this size: of a film camera's image they would take gigabytes."""
SCORING_PER_CELL = 24
"""Matches kept in one of some 170 cells: a couple of thousand, spread over the view."""


def consistent_matches(left: Camera, right: Camera, images: Images, *, seed: int = 0) -> Matches:
    """SIFT matches [N, 2] each that agree with one another on the pose found in the images themselves.

    Of the calibration only the cameras are used. A wrong pose in it filters nothing away, so that the row
    error it causes can be measured with these matches; a wrong lens shows as far as no pose makes up for
    it. Raises InvalidInput and PoseNotFound as `pose_from_images` does.

    >>> import cv2, numpy as np
    >>> import rectbench as rb
    >>> noise = np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)
    >>> left = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
    >>> right = np.concatenate([np.roll(left[:60], -6, axis=1), np.roll(left[60:], -12, axis=1)])
    >>> camera = rb.Camera("pinhole", (160, 120), {"fx": 120, "fy": 120, "cx": 79.5, "cy": 59.5})
    >>> matches = rb.consistent_matches(camera, camera, rb.Images(left, right))  # of two walls
    >>> bool(np.abs(matches.left[:, 1] - matches.right[:, 1]).max() < 0.1)
    True
    """
    return agreeing_matches(pose_from_images(left, right, images, seed=seed), left, right, images)


def agreeing_matches(estimate: PoseEstimate, left: Camera, right: Camera, images: Images) -> Matches:
    """SIFT matches [N, 2] each within four times the noise of a pose that was found in the same images.

    They lie ahead of both cameras, each near others of a like distance. Raises PoseNotFound for too few.
    """
    pose = Pose(estimate.R_right_left, estimate.direction_right_left)
    matches = match_features(*images, working_pixels=SCORING_PIXELS, per_cell=SCORING_PER_CELL)
    seen, _ = RayMatches.of(left, right, matches)
    limit_px = WITHIN_DEVIATIONS * max(estimate.noise_px, FINEST_PX)
    near = np.abs(sampson_px(seen.terms(), essential(pose))[0]) <= limit_px
    kept = seen[near & in_front(pose, seen, limit_px)]
    kept = kept[depth_consistent(pose, kept, limit_px)]
    if len(kept) < LEAST_MATCHES:
        raise PoseNotFound(f"{len(kept)} matches fit together; expected at least {LEAST_MATCHES}")
    return kept.pixels
