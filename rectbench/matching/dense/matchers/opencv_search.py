"""How OpenCV's matchers are asked for the disparities of all pixels."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.images.reading import grey8
from rectbench.matching.dense.matcher import Image

STEPS = 16
"""OpenCV's disparities are sixteenths of a pixel, and it searches ranges of whole multiples of 16."""


def multiple_of_16(lowest: int, highest: int) -> int:
    """How many disparities are searched, at least those from `lowest` to `highest`."""
    return STEPS * -(-(highest - lowest + 1) // STEPS)


def padded(
    engine: cv2.StereoMatcher, left: Image, right: Image, lowest: int, count: int, block: int
) -> NDArray[np.float32]:
    """Disparities of all columns: OpenCV leaves out those whose search would leave the image."""
    height, width = left.shape[:2]
    before, after = block + max(lowest + count - 1, 0), block + max(-lowest, 0)
    wide = [
        cv2.copyMakeBorder(grey8(image), block, block, before, after, cv2.BORDER_REPLICATE)
        for image in (left, right)
    ]
    found = engine.compute(*wide)[block : block + height, before : before + width]
    return np.where(found < lowest * STEPS, np.nan, found / np.float32(STEPS))
