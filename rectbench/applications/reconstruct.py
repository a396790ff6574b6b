"""An image pair reconstructed in 3-D, as files."""

from __future__ import annotations

from pathlib import Path

from rectbench.applications.one_rig import calibrated_pair, rectify_rig
from rectbench.applications.requests.photographs import ReconstructRequest
from rectbench.matching import reconstruct
from rectbench.matching.dense.matchers import matcher_named
from rectbench.reporting.pictures.reconstructed import write_reconstruction


def reconstruct_pair(request: ReconstructRequest) -> list[Path]:
    """Write a coloured point cloud, depth, disparity and a picture of a pair; the files.

    Raises what `rectbench.rectify` and `rectbench.reconstruct` raise; nothing is written then.
    """
    matcher_named(request.matcher)  # a wrong name is told before the work begins
    rig, images = calibrated_pair(request)
    found = reconstruct(
        rectify_rig(rig, request, images=images),
        *images,
        request.matcher,
        pixels=request.pixels,
        nearest_baselines=request.nearest_baselines,
    )
    return list(write_reconstruction(found, request.out))
