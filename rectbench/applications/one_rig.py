"""What one rig and one pair of its images give: the rig of a request, its rectification, its pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from rectbench.applications.array_checks import checked_images, checked_matches, checked_pixels
from rectbench.applications.requests.photographs import PoseRequest, PoseSettings, ReconstructRequest
from rectbench.applications.requests.shared import RigRequest, SeededMethodRequest, SizedRigRequest
from rectbench.calibrations import load_rig, load_rig_of_images
from rectbench.images.reading import read_images
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching.pose.estimate import PoseEstimate, pose_from_images
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.types import Images
from rectbench.warps import Rectification


def rig_of(request: RigRequest, images: Images | None = None) -> Rig:
    """The rig of a request, its lenses held to their image circle.

    The images tell a size that the calibration leaves out. Raises what `load_rig` raises.
    """
    if isinstance(request.rig, Rig):
        rig = request.rig
    elif images is not None:
        width, height = images.left.shape[1::-1]
        rig = load_rig_of_images(request.rig, (width, height), request.unit, request.cameras)
    else:
        size = request.size if isinstance(request, SizedRigRequest) else None
        rig = load_rig(request.rig, size, request.unit, request.cameras)
    return rig if request.max_angle_deg is None else rig.within(request.max_angle_deg)


def calibrated_pair(request: PoseRequest | ReconstructRequest) -> tuple[Rig, Images]:
    """The rig of a request, and its two photographs."""
    images = read_images(request.left, request.right)
    return rig_of(request, images), images


def rectify_rig(
    rig: Rig,
    request: SeededMethodRequest,
    *,
    images: StereoPair | Sequence[ArrayLike] | None = None,
    pixels: ArrayLike | None = None,
    matches: Sequence[ArrayLike] | None = None,
) -> Rectification:
    """The method's answer, from what it may know beside the rig; raises what `rectbench.rectify` raises."""
    plugin = registry(METHODS).get(request.method)
    problem = pose_problem(
        rig,
        pixels=None if pixels is None else checked_pixels(pixels, "pixels"),
        matches=None if matches is None else checked_matches(matches),
        images=None if images is None else checked_images(images, rig),
        seed=request.seed,
    )
    return fit(plugin, problem, checked_options(plugin, request.options))


def estimate_rig_pose(
    images: StereoPair | Sequence[ArrayLike], rig: Rig, settings: PoseSettings
) -> PoseEstimate:
    """The pose, noting where it contradicts the rig's; raises what `rectbench.estimate_pose` raises."""
    chosen = settings.model_dump(include=set(PoseSettings.model_fields), exclude_unset=True)
    found = pose_from_images(rig.left, rig.right, checked_images(images, rig), **chosen)
    return replace(found, note=found.contradiction(rig))
