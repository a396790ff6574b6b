"""Feature matches between two images: clear choices that are mutual, spread over the view."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.images.reading import grey8
from rectbench.matching.features.detectors import Descriptors, detector_named
from rectbench.types import BoolArray, FloatArray, Matches

RATIO = 0.8
"""Lowe's ratio: the best match must be this much nearer than the second best."""
CELLS = 16
"""Cells along the longer side of the grid in which matches are thinned out."""
ROWS_AT_ONCE = 2048
"""Descriptors compared at once with all others, whatever their number: bounds the memory."""


def sift_matches(left: NDArray[np.generic], right: NDArray[np.generic], *, ratio: float = RATIO) -> Matches:
    """Pixels [N, 2] each of SIFT features that choose each other, best of their second best by `ratio`.

    The clearest choice comes first. Images are [H, W] or [H, W, 3] RGB. No geometry is used: gross
    outliers stay in. An image without features gives no matches.

    >>> import cv2, numpy as np
    >>> import rectbench as rb
    >>> noise = np.random.default_rng(0).integers(0, 256, (120, 160), np.uint8)
    >>> image = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
    >>> left, right = rb.sift_matches(image, np.roll(image, -8, axis=1))
    >>> np.median(left - right, axis=0).round(2)
    array([8., 0.])
    """
    return match_features(left, right, ratio=ratio)


def match_features(
    left: NDArray[np.generic],
    right: NDArray[np.generic],
    *,
    detector: str = "sift",
    ratio: float = RATIO,
    farthest: float | None = None,
    working_pixels: float | None = None,
    most: int | None = None,
    per_cell: int | None = None,
) -> Matches:
    """Pixels [N, 2] each of features that choose each other, the clearest choice first.

    Parameters
    ----------
    left, right : [H, W] or [H, W, 1 to 4 channels] (RGB, alpha last), of 8 or 16 bits or float.
    detector : one of `DETECTORS`.
    ratio : the best match must be nearer than the second best by this factor.
    farthest : the longest distance of two descriptors that match: the share of bits that differ for
        akaze and orb, the distance of unit vectors for sift and surf; no limit by default.
    working_pixels : an image of more pixels is made smaller first.
    most : features kept an image, the strongest; all by default.
    per_cell : matches kept in each cell of a grid over the left image, 16 cells along its longer
        side; all by default.

    No geometry is used: gross outliers stay in. Raises InvalidInput for arrays that are no images,
    UnknownName for a detector nobody knows, Unavailable for one that this OpenCV lacks.
    """
    chosen_detector = detector_named(detector)
    images = grey8(left, "left"), grey8(right, "right")
    # OpenCV works outside of Python's lock, and leaves a core idle between its own parallel parts. A process
    # that is held to one thread takes one image after the other, in half the memory.
    with ThreadPoolExecutor(min(2, cv2.getNumThreads())) as threads:
        found, others = threads.map(
            lambda image: chosen_detector.features(image, working_pixels, most), images
        )
    if min(len(found.pixels), len(others.pixels)) < 2:
        return Matches(np.empty((0, 2)), np.empty((0, 2)))
    nearest = _nearest(found.descriptors, others.descriptors)
    distance, second = (chosen_detector.distance(s) for s in (nearest.similarity, nearest.second))
    kept = nearest.mutual & (distance < ratio * second)
    if farthest is not None:
        kept &= distance <= farthest
    clearest = np.argsort(distance / np.maximum(second, 1e-12), kind="stable")
    chosen = clearest[kept[clearest]]
    if per_cell is not None:
        chosen = chosen[_rank_in_cell(found.pixels[chosen], max(images[0].shape) / CELLS) < per_cell]
    return Matches(found.pixels[chosen], others.pixels[nearest.partner[chosen]])


class Nearest(NamedTuple):
    """The nearest descriptor of each, all arrays [N]."""

    partner: NDArray[np.intp]
    similarity: Descriptors
    second: Descriptors
    """Similarity of the second nearest."""
    mutual: BoolArray
    """Whether the nearest's own nearest is this one."""


def _nearest(descriptors: Descriptors, others: Descriptors) -> Nearest:
    """The nearest of others [M, d] to each of descriptors [N, d]: the largest product, M at least 2."""
    count = len(descriptors)
    partner, (similarity, second) = np.empty(count, np.intp), np.empty((2, count), np.float32)
    back, most_similar = np.zeros(len(others), np.intp), np.full(len(others), -np.inf, np.float32)
    for first in range(0, count, ROWS_AT_ONCE):
        products = descriptors[first : first + ROWS_AT_ONCE] @ others.T
        rows = np.arange(len(products))
        block = slice(first, first + len(products))
        best_row = products.argmax(axis=0)
        best = products[best_row, np.arange(len(others))]
        better = best > most_similar
        back[better], most_similar[better] = best_row[better] + first, best[better]
        partner[block] = products.argmax(axis=1)
        similarity[block] = products[rows, partner[block]]
        products[rows, partner[block]] = -np.inf
        second[block] = products.max(axis=1)
    return Nearest(partner, similarity, second, back[partner] == np.arange(count))


def _rank_in_cell(pixels: FloatArray, cell_px: float) -> NDArray[np.intp]:
    """How many earlier pixels share the cell of each [N]."""
    columns, rows = np.floor(pixels / cell_px).astype(np.intp).T
    _, cell = np.unique(rows * (columns.max(initial=0) + 1) + columns, return_inverse=True)
    order = np.argsort(cell, kind="stable")
    sizes = np.bincount(cell)
    starts = np.repeat(np.cumsum(sizes) - sizes, sizes)
    rank = np.empty(len(pixels), np.intp)
    rank[order] = np.arange(len(pixels)) - starts
    return rank
