"""Frames that just hold what both lenses show, for maps of any kind."""

import numpy as np

import rectbench as rb

ANYWHERE = (np.inf, np.inf)


def held(
    rig: rb.Rig,
    left: rb.Warp,
    right: rb.Warp,
    notes: dict[str, float | str],
    limits_px: tuple[float, float] = ANYWHERE,
) -> rb.Rectification:
    """Both warps, which map all that the lenses see, in one frame that just holds it.

    What is farther than `limits_px` from û = 0 and from v̂ = 0 is left out. Where a lens is bounded by its
    image circle, pixels of a grid tell where that ends, and the frame is wider by what lies between two.
    """
    outlines = [rb.outline_pixels(warp.source) for warp in (left, right)]
    slack_px = max(spacing_px for _, spacing_px in outlines)
    places = np.concatenate(
        [warp.forward(pixels) for warp, (pixels, _) in zip((left, right), outlines, strict=True)]
    )
    low = np.maximum(np.nanmin(places, axis=0) - slack_px, np.negative(limits_px))
    high = np.minimum(np.nanmax(places, axis=0) + slack_px, limits_px)
    if not (high > low).all():
        raise rb.Unsupported("all that the lenses show lies farther off than the image reaches")
    width, height = (int(np.ceil(side)) for side in high - low)
    window = float(low[0]), float(low[1]), 1.0, 1.0
    warps = [rb.Warp(warp.source, warp.R_rect_cam, warp.target.framed(*window)) for warp in (left, right)]
    return rb.Rectification(rig, warps[0], warps[1], (width, height), notes)


def in_epipolar_frame(
    rig: rb.Rig,
    target: rb.Target,
    notes: dict[str, float | str],
    limits_px: tuple[float, float] = ANYWHERE,
) -> rb.Rectification:
    """The same of one target of both cameras, in the rig's epipolar frame."""
    R_rect_left, R_rect_right = rb.rectifying_rotations(rig)
    left, right = rb.Warp(rig.left, R_rect_left, target), rb.Warp(rig.right, R_rect_right, target)
    return held(rig, left, right, notes, limits_px)
