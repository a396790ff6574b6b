"""The derivative of a map by differences of the map itself, whatever it says of its derivative."""

from __future__ import annotations

import numpy as np

from rectbench.types import FloatArray
from rectbench.warps.warp import Warp

ARM_PX = 0.5
"""A derivative is a difference over twice this, one pixel."""
CROSS = np.array([[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])


def differences(
    warp: Warp, pixels: FloatArray, arm_px: float = ARM_PX, turn_px: float | None = None
) -> tuple[FloatArray, FloatArray]:
    """Where pixels [N, 2] go, [N, 2], and the derivative there by differences over two arms, [N, 2, 2].

    At the end of a map's domain the difference is over the one arm that there is. So it is at the seam of
    rows that begin again after `turn_px`, see `Rectification.turn_px`: a map may bend there.
    """
    middle, *arms = np.moveaxis(warp.forward(pixels[:, None] + arm_px * CROSS), 1, 0)
    farthest = np.inf if turn_px is None else turn_px / 2
    columns = []
    for ends in (arms[:2], arms[2:]):
        known = [np.isfinite(arm) & (np.abs(arm[:, 1] - middle[:, 1]) <= farthest)[:, None] for arm in ends]
        first, last = (np.where(there, arm, middle) for there, arm in zip(known, ends, strict=True))
        with np.errstate(invalid="ignore", divide="ignore"):
            columns.append((last - first) / (arm_px * (known[0].astype(float) + known[1])))
    return middle, np.stack(columns, axis=-1)


def off_derivative(warp: Warp, pixels: FloatArray, stated: FloatArray, arm_px: float) -> FloatArray:
    """How far the columns of stated derivatives [N, 2, 2] are from differences over short arms, [N, 2].

    Over both arms, or over one: where pieces of a map meet it may bend, and has the derivative of a side.
    """
    middle, *arms = np.moveaxis(warp.forward(pixels[:, None] + arm_px * CROSS), 1, 0)
    found = []
    for column, (before, after) in zip(np.moveaxis(stated, -1, 0), (arms[:2], arms[2:]), strict=True):
        slopes = (after - before) / 2, middle - before, after - middle
        found.append(np.fmin.reduce([np.abs(slope / arm_px - column).max(axis=-1) for slope in slopes]))
    return np.stack(found, axis=-1)
