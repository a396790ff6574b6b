"""Frames that just hold what both lenses show, for maps of any kind."""

import numpy as np

import rectbench as rb


def held(
    rig: rb.Rig, left: rb.Warp, right: rb.Warp, notes: dict[str, float | str], columns_px: float = np.inf
) -> rb.Rectification:
    """Both warps, in one frame that just holds what the lenses show.

    Columns farther than `columns_px` from û = 0 are left out. Where a lens is bounded by its image circle,
    pixels of a grid tell where that ends, and the frame is wider by what lies between two of them.
    """
    reached, slack_px = [], 0.0
    for warp in (left, right):
        pixels, spacing_px = rb.outline_pixels(warp.source)
        reached.append(warp.forward(pixels))
        slack_px = max(slack_px, spacing_px)
    places = np.concatenate(reached)
    places = places[np.isfinite(places).all(axis=1)]
    if not len(places):
        raise rb.Unsupported("nothing that the lenses show lies in the range of the map")
    limit = np.array([columns_px, np.inf])
    low, high = (
        np.maximum(places.min(axis=0) - slack_px, -limit),
        np.minimum(places.max(axis=0) + slack_px, limit),
    )
    width, height = (int(np.ceil(side)) for side in high - low)
    window = float(low[0]), float(low[1]), 1.0, 1.0
    warps = [rb.Warp(warp.source, warp.R_rect_cam, warp.target.framed(*window)) for warp in (left, right)]
    return rb.Rectification(rig, warps[0], warps[1], (width, height), notes)


def in_epipolar_frame(
    rig: rb.Rig, target: rb.Target, notes: dict[str, float | str], columns_px: float = np.inf
) -> rb.Rectification:
    """The same of one target of both cameras, in the rig's epipolar frame."""
    R_rect_left, R_rect_right = rb.rectifying_rotations(rig)
    left, right = rb.Warp(rig.left, R_rect_left, target), rb.Warp(rig.right, R_rect_right, target)
    return held(rig, left, right, notes, columns_px)
