"""One rig rectified by a method that a request names."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from rectbench.applications.array_checks import checked_images, checked_matches, checked_pixels
from rectbench.applications.requests.shared import SeededMethodRequest
from rectbench.images.stereo_pair import StereoPair
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, pose_problem
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.warps import Rectification


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
