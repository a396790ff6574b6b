"""The pose of a pair as its own images tell it, and how the store keeps it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import PoseEstimate, pose_from_images
from rectbench.rigs import Rig
from rectbench.store.keys import Inputs, code_digest, versions
from rectbench.types import Images, Matches

ESTIMATING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless")


def estimate_pose(rig: Rig, images: StereoPair, seed: int) -> PoseEstimate:
    """The estimate, made anew; raises PoseNotFound, with the reason, where the images tell none.

    Of the true rig only the cameras are used: calibrations are known, the pose is not.
    """
    return pose_from_images(rig.left, rig.right, Images(images.left, images.right), seed=seed)


def estimate_inputs(image_inputs: Inputs) -> Inputs:
    """All that shapes the estimate from images that these inputs shape."""
    return {
        **image_inputs,
        "estimating_code": code_digest(__name__),
        "estimating_versions": dict(versions(*ESTIMATING_PACKAGES)),
    }


def save_estimate(estimate: PoseEstimate, path: Path) -> None:
    """Write an estimate as `.npz`."""
    np.savez(
        path,
        R_right_left=estimate.R_right_left,
        direction_right_left=estimate.direction_right_left,
        covariance=estimate.covariance,
        inliers=np.stack(estimate.inliers),
        given=estimate.given,
        noise_px=estimate.noise_px,
        motion=estimate.motion,
        seconds=json.dumps(dict(estimate.seconds)),
    )


def load_estimate(path: Path) -> PoseEstimate:
    """The estimate that `save_estimate` wrote, to the last bit."""
    with np.load(path, allow_pickle=False) as stored:
        return PoseEstimate(
            R_right_left=stored["R_right_left"],
            direction_right_left=stored["direction_right_left"],
            covariance=stored["covariance"],
            inliers=Matches(*stored["inliers"]),
            given=int(stored["given"]),
            noise_px=float(stored["noise_px"]),
            motion="forward" if stored["motion"] == "forward" else "sideways",
            seconds=json.loads(str(stored["seconds"])),
        )
