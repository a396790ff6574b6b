"""Points where two dark squares meet at a corner, to a few hundredths of a pixel."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.images.reading import Grey
from rectbench.types import FloatArray

STEPS = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 60, 1e-4)


def refined_saddles(image: Grey | NDArray[np.float32], points: FloatArray, half: int) -> FloatArray:
    """Points [..., 2] moved to where gradients about them are square to the ways there; NaN where none is.

    The window reaches `half` pixels from its middle. (Förstner and Gülch 1987.)
    """
    if not points.size:
        return points
    start = points.reshape(-1, 1, 2).astype(np.float32)
    height, width = image.shape
    with np.errstate(invalid="ignore"):
        inside = ((start >= 0) & (start < [width, height])).all(axis=-1, keepdims=True)
    start = np.where(inside, start, 0)
    found = cv2.cornerSubPix(image, start.copy(), (half, half), (-1, -1), STEPS)
    # A search that leaves its window is put back to where it started.
    known = inside & (found != start).any(axis=-1, keepdims=True)
    return np.where(known, found, np.nan).astype(np.float64).reshape(points.shape)


def levels_at(image: Grey, pixels: FloatArray) -> FloatArray:
    """Grey levels [...] of the nearest pixels [..., 2]; NaN outside of the image."""
    height, width = image.shape
    with np.errstate(invalid="ignore"):
        within = (pixels > -0.5) & (pixels < [width - 0.5, height - 0.5])
    inside = np.asarray(within.all(axis=-1))
    column, row = np.moveaxis(np.rint(np.where(inside[..., None], pixels, 0)).astype(np.intp), -1, 0)
    return np.where(inside, image[row, column].astype(float), np.nan)
