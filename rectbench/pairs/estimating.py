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
    np.savez(path, **{**vars(estimate), "seconds": json.dumps(dict(estimate.seconds))})


def load_estimate(path: Path) -> PoseEstimate:
    """The estimate that `save_estimate` wrote, to the last bit."""
    with np.load(path, allow_pickle=False) as stored:
        numbers = {name: value if value.ndim else value.item() for name, value in stored.items()}
    kept = {"inliers": Matches(*numbers["inliers"]), "seconds": json.loads(numbers["seconds"])}
    return PoseEstimate(**{**numbers, **kept})
