"""Normalised correlation: what plane sweeping does, along the rows of a rectified pair."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import ArrayLike

from rectbench.images.reading import grey8
from rectbench.matching.dense.correlation import LEAST_SCORE, FloatMap, correlation, most_alike
from rectbench.matching.dense.matcher import Image, matcher


@matcher("ncc", is_reentrant=True)
def ncc(left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Normalised correlation of windows, the best one wins: as a plane sweep scores, to compare with one."""
    first, second = (grey8(image).astype(np.float32) for image in (left, right))
    place, score = most_alike(_scores(first, second, lowest - 1, highest + 1), first.shape)
    return np.where(score >= LEAST_SCORE, lowest - 1 + place, np.float32(np.nan))


def _scores(left: FloatMap, right: FloatMap, lowest: int, highest: int) -> Iterator[FloatMap]:
    """Of each disparity; -1 where it leads out of the right image."""
    columns = np.arange(left.shape[1])
    for disparity in range(lowest, highest + 1):
        inside = (columns >= disparity) & (columns < left.shape[1] + disparity)
        shift = np.array([[1, 0, disparity], [0, 1, 0]], np.float32)
        moved = cv2.warpAffine(right, shift, left.shape[::-1], borderMode=cv2.BORDER_REPLICATE)
        yield np.where(inside, correlation(left, moved.astype(np.float32)), np.float32(-1))
