"""Block matching, OpenCV's."""

from __future__ import annotations

import cv2
from numpy.typing import ArrayLike

from rectbench.matching.dense.matcher import Image, matcher
from rectbench.matching.dense.matchers.opencv_search import multiple_of_16, padded

BLOCK = 15


@matcher("bm", is_reentrant=True)
def bm(left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Block matching by `cv2.StereoBM`: quick, with holes where there is little texture."""
    count = multiple_of_16(lowest, highest)
    engine = cv2.StereoBM.create(count, BLOCK)
    engine.setMinDisparity(lowest)
    return padded(engine, left, right, lowest, count, BLOCK)
