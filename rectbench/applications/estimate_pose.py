"""The pose of a rig as two photographs show it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from rectbench.applications.array_checks import checked_images
from rectbench.applications.requests.photographs import PoseSettings
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching.pose.estimate import PoseEstimate, pose_from_images
from rectbench.rigs import Rig


def estimate_rig_pose(
    images: StereoPair | Sequence[ArrayLike], rig: Rig, settings: PoseSettings
) -> PoseEstimate:
    """The pose, noting where it contradicts the rig's; raises what `rectbench.estimate_pose` raises."""
    chosen = settings.model_dump(include=set(PoseSettings.model_fields), exclude_unset=True)
    found = pose_from_images(rig.left, rig.right, checked_images(images, rig), **chosen)
    return replace(found, note=found.contradiction(rig))
