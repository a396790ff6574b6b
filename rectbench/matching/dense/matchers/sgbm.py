"""Semi-global matching, OpenCV's, over three, five or eight paths."""

from __future__ import annotations

import cv2
from numpy.typing import ArrayLike

from rectbench.matching.dense.matcher import Image, matcher
from rectbench.matching.dense.matchers.opencv_search import multiple_of_16, padded

BLOCK = 7
SMALL_JUMP, LARGE_JUMP = 8 * BLOCK**2, 32 * BLOCK**2
"""What a disparity that changes by one pixel, or by more, is charged (OpenCV's own advice).

Measured on rendered streets and rooms: blocks of 3 and 5 leave more holes, those of 9 widen thin
things; half of this charge lets noise through, twice of it bridges the gaps between things.
"""
PREFILTER_CAP = 63


@matcher("sgbm", is_reentrant=True)
def sgbm(left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Semi-global matching (Hirschmüller 2008) over three paths, by `cv2.StereoSGBM`."""
    # Three paths beat five in accuracy as well as in time: on the rendered pairs the median error
    # is 0.14 px against 0.16, in two thirds of the time on two cores.
    return _semi_global(cv2.STEREO_SGBM_MODE_SGBM_3WAY, left, right, lowest, highest)


@matcher("sgbm-5way", is_reentrant=True)
def sgbm_5way(left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Semi-global matching over five paths."""
    return _semi_global(cv2.STEREO_SGBM_MODE_SGBM, left, right, lowest, highest)


@matcher("sgbm-8way", is_reentrant=True)
def sgbm_8way(left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Semi-global matching over all eight paths; takes 1 GiB for a megapixel and 128 disparities."""
    return _semi_global(cv2.STEREO_SGBM_MODE_HH, left, right, lowest, highest)


def _semi_global(mode: int, left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
    """Its own checks (uniqueness, speckles, left-right) are off: those made afterwards are the same for all
    matchers, and cost fewer good pixels."""
    count = multiple_of_16(lowest, highest)
    engine = cv2.StereoSGBM.create(
        minDisparity=lowest,
        numDisparities=count,
        blockSize=BLOCK,
        P1=SMALL_JUMP,
        P2=LARGE_JUMP,
        disp12MaxDiff=-1,
        preFilterCap=PREFILTER_CAP,
        mode=mode,
    )
    return padded(engine, left, right, lowest, count, BLOCK)
