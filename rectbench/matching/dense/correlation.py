"""How alike two images are about each pixel, and under which of many hypotheses they are most so."""

from __future__ import annotations

from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

FloatMap = NDArray[np.float32]

WINDOW = 7
NOISE_GREY = 1.0
"""Standard deviation of what is no texture, grey levels: flat places are not alike by chance."""
LEAST_SCORE = 0.6
"""Of the correlation, for a match to be believed."""
LEAST_BEND = 1e-6


def correlation(first: FloatMap, second: FloatMap) -> FloatMap:
    """Zero-mean normalised cross-correlation [H, W], from -1 to 1, of the windows about each pixel.

    >>> import numpy as np
    >>> image = np.random.default_rng(0).uniform(0, 255, (20, 30)).astype(np.float32)
    >>> bool(np.allclose(correlation(image, 0.5 * image + 30), 1, atol=2e-3))
    True
    """

    def mean(image: FloatMap) -> FloatMap:
        blurred: FloatMap = cv2.blur(image, (WINDOW, WINDOW))
        return blurred

    means = mean(first), mean(second)
    variances = [
        np.maximum(mean(i * i) - m * m, 0) + NOISE_GREY**2
        for i, m in zip((first, second), means, strict=True)
    ]
    together = mean(first * second) - means[0] * means[1]
    return np.asarray(together / np.sqrt(variances[0] * variances[1]), dtype=np.float32)


def most_alike(scores: Iterable[FloatMap], shape: tuple[int, ...]) -> tuple[FloatMap, FloatMap]:
    """At each pixel, which of the hypotheses in a row scores highest [H, W], counted from 0, and its score.

    Only one that scores no less than those before and after it: the best at an end of the row might be better
    beyond it. A parabola through the three tells the place between them. NaN where there is none.
    """
    place, best = np.full(shape, np.nan, np.float32), np.full(shape, -1.0, np.float32)
    before = at = None
    for number, after in enumerate(scores):
        if before is not None and at is not None:
            wins = (at > best) & (at >= before) & (at >= after)
            bend = np.maximum(2 * at - before - after, LEAST_BEND)
            between = np.clip(0.5 * (after - before) / bend, -0.5, 0.5)
            place = np.where(wins, number - 1 + between, place).astype(np.float32)
            best = np.where(wins, at, best)
        before, at = at, after
    return place, best
