"""The pose of a pair as its own images tell it, estimated once and kept in the store."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

import numpy as np

from rectbench.errors import PoseNotFound
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import PoseEstimate, pose_from_images
from rectbench.pairs.pairs import image_inputs, load_images, placed_rig
from rectbench.pairs.spec import PairSpec
from rectbench.store.keys import Inputs, code_digest, derived_seed, versions
from rectbench.store.store import Store
from rectbench.types import Images, Matches

POSES = "poses"
ESTIMATING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless")
NUMBERS, REASON = "pose.npz", "reason.json"


def estimate_from_images(pair: PairSpec, images: StereoPair) -> PoseEstimate:
    """The estimate, made anew from the pair's images; raises PoseNotFound where they tell none."""
    rig = placed_rig(pair)
    seed = derived_seed("consensus", pair.scene, pair.rig, pair.motion, pair.seed)
    # Of the true rig only the cameras are used: calibrations are known, the pose is not.
    return pose_from_images(rig.left, rig.right, Images(images.left, images.right), seed=seed)


@lru_cache(maxsize=1)
def estimated_pose(pair: PairSpec, store: Store) -> PoseEstimate:
    """The estimate of a pair, from the store where it is known; all methods of a pair share it.

    Raises PoseNotFound, with the reason, where the images tell no pose.
    """
    inputs = _inputs(pair)
    with store.making(POSES, inputs):
        folder = store.read(POSES, inputs)
        if folder is None:
            try:
                estimate = estimate_from_images(pair, load_images(pair, store))
            except PoseNotFound as failure:
                store.write_text(POSES, inputs, REASON, json.dumps({"reason": str(failure)}))
                raise
            store.write(POSES, inputs, lambda place: _save(estimate, place / NUMBERS))
            return estimate
    if (folder / REASON).is_file():
        raise PoseNotFound(json.loads((folder / REASON).read_text(encoding="utf-8"))["reason"])
    return _load(folder / NUMBERS)


def _inputs(pair: PairSpec) -> Inputs:
    return {
        **image_inputs(pair),
        "estimating_code": code_digest(__name__),
        "estimating_versions": dict(versions(*ESTIMATING_PACKAGES)),
    }


def _save(estimate: PoseEstimate, path: Path) -> None:
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


def _load(path: Path) -> PoseEstimate:
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
