"""What one rig and one pair of its images give: the rig of a request, its rectification, its pose.

Arrays, as Python hands them over, are checked, or refused in one line.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rectbench.applications.requests.photographs import (
    PoseRequest,
    PoseSettings,
    ReconstructRequest,
    UncertaintyRequest,
)
from rectbench.applications.requests.request import RigRequest, SeededMethodRequest
from rectbench.calibrations import load_rig, load_rig_of_images
from rectbench.errors import InvalidInput, renamed
from rectbench.images.reading import read_images
from rectbench.images.stereo_pair import StereoPair, check_size
from rectbench.matching.pose.estimate import PoseEstimate, pose_from_images
from rectbench.pairs.finding.image_circle import ImageCircle, image_circle
from rectbench.pairs.finding.image_pairs import masks_beside
from rectbench.pairs.finding.names import FilePair
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.types import FloatArray, Images, Matches
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
        with renamed(size=request.size_field or "size"):
            rig = load_rig(request.rig, request.source_size, request.unit, request.cameras)
    return rig if request.max_angle_deg is None else rig.within(request.max_angle_deg)


class CalibratedPair(NamedTuple):
    """Two photographs and their rig."""

    rig: Rig
    images: Images
    circle: ImageCircle | None = None
    """What the rig's lenses were held to, where a mask or the images themselves show it."""


def calibrated_pair(request: PoseRequest | ReconstructRequest | UncertaintyRequest) -> CalibratedPair:
    """The two photographs of a request and its rig, within the image circle that masks or images show."""
    assert request.left is not None
    assert request.right is not None
    images = read_images(request.left, request.right)
    rig = rig_of(request, images)
    circle = circle_of(request, rig, [FilePair("", request.left, request.right)])
    return CalibratedPair(rig.within(circle.angle_deg) if circle else rig, images, circle)


def circle_of(request: RigRequest, rig: Rig, pairs: Sequence[FilePair]) -> ImageCircle | None:
    """The image circle of a rig whose calibration tells none, see `pairs.finding.image_circle`."""
    given = request.rig if isinstance(request.rig, list | tuple) else [request.rig]
    calibration = [Path(file) for file in given if isinstance(file, str | os.PathLike)]
    return image_circle(rig, pairs, masks_beside(pairs, calibration))


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
        margin_deg=request.margin_deg,
    )
    return fit(plugin, problem, checked_options(plugin, request.options))


def estimate_rig_pose(
    images: StereoPair | Sequence[ArrayLike], rig: Rig, settings: PoseSettings
) -> PoseEstimate:
    """The pose, noting where it contradicts the rig's; raises what `rectbench.estimate_pose` raises."""
    chosen = settings.model_dump(include=set(PoseSettings.model_fields), exclude_unset=True)
    found = pose_from_images(rig.left, rig.right, checked_images(images, rig), **chosen)
    return replace(found, note=found.contradiction(rig))


def checked_rig(rig: object) -> Rig:
    """The rig; what is none says where rigs come from."""
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig, see rectbench.load_rig")
    return rig


def checked_pixels(pixels: ArrayLike, name: str) -> FloatArray:
    """[N, 2] finite pixels; an error calls them `name`."""
    try:
        points = np.asarray(pixels, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} are no numbers; expected [N, 2] pixels") from None
    if points.ndim != 2 or points.shape[1] != 2 or not len(points):
        raise InvalidInput(f"{name} have shape {points.shape}; expected [N, 2]")
    if not np.isfinite(points).all():
        raise InvalidInput(f"{name} hold NaN or infinity; expected finite pixels")
    return points


def checked_matches(matches: Sequence[ArrayLike]) -> Matches:
    """As many pixels of either image."""
    if not isinstance(matches, Sequence) or len(matches) != 2:
        raise InvalidInput(f"matches {_held(matches)}; expected (left [N, 2], right [N, 2])")
    left, right = (
        checked_pixels(px, f"{side} matches") for px, side in zip(matches, ("left", "right"), strict=True)
    )
    if left.shape != right.shape:
        raise InvalidInput(f"matches have {len(left)} left and {len(right)} right pixels; expected as many")
    return Matches(left, right)


def _held(given: object) -> str:
    return f"hold {len(given)} arrays" if isinstance(given, Sequence) else f"are {type(given).__name__}"


def checked_images(images: StereoPair | Sequence[ArrayLike], rig: Rig) -> Images:
    """Two images of their cameras' sizes."""
    both: Any = (images.left, images.right) if isinstance(images, StereoPair) else images
    if not isinstance(both, Sequence) or len(both) != 2:
        raise InvalidInput(f"images {_held(both)}; expected (left, right)")
    arrays = Images(*map(np.asarray, both))
    for side, image in zip(("left", "right"), arrays, strict=True):
        check_size(image, getattr(rig, side), f"the {side} image", f"rig {rig.name}'s camera")
    return arrays
