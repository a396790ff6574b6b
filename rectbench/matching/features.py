"""Feature matches between two images: SIFT, ratio test, mutual choice."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.cameras.arrays import FloatArray
from rectbench.warps import Matches

RATIO = 0.8
"""Lowe's ratio: the best match must be this much nearer than the second best."""


def sift_matches(left: NDArray[np.generic], right: NDArray[np.generic], *, ratio: float = RATIO) -> Matches:
    """Pixels [N, 2] each of SIFT features that choose each other, best of their second best by `ratio`.

    Images are [H, W] or [H, W, 3] RGB, uint8. No geometry is used: gross outliers stay in. An image
    without features gives no matches.
    """
    (px_left, words_left), (px_right, words_right) = _features(left), _features(right)
    if min(len(px_left), len(px_right)) < 2:
        return Matches(np.empty((0, 2)), np.empty((0, 2)))
    forth, back = _choices(words_left, words_right, ratio), _choices(words_right, words_left, ratio)
    chosen = np.flatnonzero((forth >= 0) & (back[forth] == np.arange(len(forth))))
    return Matches(px_left[chosen], px_right[forth[chosen]])


def _features(image: NDArray[np.generic]) -> tuple[FloatArray, NDArray[np.float32]]:
    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    keypoints, descriptors = cv2.SIFT.create().detectAndCompute(grey, None)
    if not keypoints:
        return np.empty((0, 2)), np.empty((0, 128), np.float32)
    # Root-SIFT: Hellinger distances tell descriptors apart better (Arandjelović and Zisserman 2012).
    descriptors /= np.maximum(descriptors.sum(axis=1, keepdims=True), 1e-12)
    return np.array([point.pt for point in keypoints]), np.sqrt(descriptors)


def _choices(queries: NDArray[np.float32], words: NDArray[np.float32], ratio: float) -> NDArray[np.intp]:
    """For each query the index of its match, or -1 [N]."""
    chosen = np.full(len(queries), -1)
    for i, pair in enumerate(cv2.BFMatcher(cv2.NORM_L2).knnMatch(queries, words, k=2)):
        if len(pair) == 2 and pair[0].distance < ratio * pair[1].distance:
            chosen[i] = pair[0].trainIdx
    return chosen
