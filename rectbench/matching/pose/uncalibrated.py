"""A pair without a calibration: the rig that its matches imply under assumed lenses.

Two images without intrinsics determine the fundamental matrix, and with it rows that correspond; no lens,
no scale and no metres. The rig stands in for what a rectifier asks: ideal pinholes of a usual view.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np

from rectbench.cameras import Camera
from rectbench.errors import PoseNotFound
from rectbench.matching.features.matches import match_features
from rectbench.matching.pose.estimate import LEAST_MATCHES, POSE_PIXELS, THRESHOLD_PX, relative_pose
from rectbench.rigs import Rig
from rectbench.types import Images, Matches

ASSUMED_VIEW_DEG = 60.0
"""Of the longer side: between a telephone's camera and a webcam."""
CONFIDENCE, MOST_SAMPLES = 0.9999, 10_000


class Uncalibrated(NamedTuple):
    """What stands in for a calibration."""

    rig: Rig
    """Pinholes of a 60 degree view in the pose that the matches have through them, a baseline of 1 apart."""
    matches: Matches
    """[N, 2] each, those of one fundamental matrix."""


def uncalibrated(images: Images, *, seed: int = 0) -> Uncalibrated:
    """The matches of two images of unknown lenses, and a rig that stands in for theirs.

    Matches are those of one fundamental matrix (MAGSAC++, Barath et al. 2020), which no assumed lens has
    a part in. Raises PoseNotFound where the images tell none.
    """
    left, right = (_assumed(image.shape[1], image.shape[0]) for image in images)
    found = match_features(*images, working_pixels=POSE_PIXELS)
    if len(found.left) < LEAST_MATCHES:
        raise PoseNotFound(f"{len(found.left)} matches; expected at least {LEAST_MATCHES}")
    reduction = max(1.0, math.sqrt(max(image.shape[0] * image.shape[1] for image in images) / POSE_PIXELS))
    _, kept = cv2.findFundamentalMat(
        found.left, found.right, cv2.USAC_MAGSAC, reduction, CONFIDENCE, MOST_SAMPLES
    )
    chosen = np.zeros(len(found.left), bool) if kept is None else kept.ravel() > 0
    matches = Matches(found.left[chosen], found.right[chosen])
    pose = relative_pose(left, right, matches, threshold_px=THRESHOLD_PX * reduction, seed=seed)
    rig = Rig(left, right, pose.R_right_left, pose.direction_right_left, name="uncalibrated")
    return Uncalibrated(rig, matches)


def _assumed(width: int, height: int) -> Camera:
    focal = max(width, height) / 2 / math.tan(math.radians(ASSUMED_VIEW_DEG / 2))
    return Camera(
        "pinhole", (width, height), {"fx": focal, "fy": focal, "cx": (width - 1) / 2, "cy": (height - 1) / 2}
    )
