"""Square markers with an identity, AprilTag and ArUco, as calibration boards carry them.

A tag's corner is where its sides meet. Each side is found where the image is steepest across it and followed
as a parabola, since a lens bends it. Blur would pull `cv2.cornerSubPix` 0.2 px out of such a corner; it is
the better one where a black square touches the corner from outside, as on Kalibr's AprilGrid.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import cv2
import numpy as np

from rectbench.images.reading import Grey
from rectbench.matching.boards.saddles import levels_at, refined_saddles
from rectbench.types import BoolArray, FloatArray

FAMILIES = {
    "AprilTag 36h11": "DICT_APRILTAG_36h11",
    "ArUco 4x4": "DICT_4X4_1000",
    "ArUco 5x5": "DICT_5X5_1000",
    "ArUco 6x6": "DICT_6X6_1000",
    "ArUco 7x7": "DICT_7X7_1000",
}
"""Names of families, and OpenCV's. A family's smaller dictionaries are the beginning of its largest."""
BORDERS = {"AprilTag 36h11": (1, 2)}
"""Modules of black about a tag, where there may be more than one: there are two on Kalibr's AprilGrid."""
SEARCHED_PIXELS = (350_000, 1_000_000)
"""Sizes of the image in which tags are looked for: near ones whose corners are touched, and far ones."""
NEAR = 0.8
"""How much smaller the one has to be than the other to be worth the time."""
ALONG: FloatArray = np.linspace(0.14, 0.86, 25)
"""Where a side is looked at, as shares of its length: a square may touch its ends."""
ACROSS, LEAST_ACROSS, MOST_ACROSS = 0.1, 2.0, 8.0
"""How far from the first guess a side is looked for, both ways: a share of its length, and px. Narrower than
a tag's black border."""
STEPS = 33
"""Places along that way."""
STRAYING_PX = 0.6
"""RMS distance of a side's points from their parabola, beyond which it is no side."""
FIT_STEPS = 6
LEAST_TRUST = 0.5
"""Mean trust in a side's points from which on they are a side."""
BESIDE, LEAST_CONTRAST = 0.07, 20
"""How far out of a corner, in lengths along both sides, a black square that touches it is looked for; grey
levels by which white is lighter."""
TOUCHED_WINDOW, TOUCHED_WINDOWS = 0.12, (2, 8)
"""Half the window in which a corner is refined that a square touches: a share of the shortest side; px."""


def tags(image: Grey) -> dict[str, dict[int, FloatArray]]:
    """Per family and identity the four corners [4, 2] of each tag in the image, clockwise as the tag is read.

    A corner is NaN where one of its sides is not found. An identity that is seen twice is left out.
    """
    searched = _sizes(image)
    found = {family: _seen(image, searched, family) for family in FAMILIES}
    return {family: _refined(image, seen) for family, seen in found.items() if seen}


def _sizes(image: Grey) -> list[Grey]:
    """The image in the sizes of `SEARCHED_PIXELS`, a small one as it is alone."""
    coarse, fine = (min(1.0, math.sqrt(pixels / image.size)) for pixels in SEARCHED_PIXELS)
    factors = [coarse, fine] if coarse < NEAR * fine else [fine]
    return [
        np.asarray(cv2.resize(image, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA), np.uint8)
        for factor in factors
    ]


def _seen(image: Grey, searched: Sequence[Grey], family: str) -> dict[int, FloatArray]:
    """The tags of a family by identity, found in `searched` sizes of the image; good to a pixel or two."""
    seen: dict[int, FloatArray] = {}
    twice: set[int] = set()
    for small, detector in itertools.product(searched, _detectors(family)):
        enlarged = np.array(image.shape[::-1]) / small.shape[::-1]
        corners, ids, _ = detector.detectMarkers(small)
        for quad, one in zip(corners, () if ids is None else map(int, np.ravel(ids)), strict=True):
            tag = (quad.reshape(4, 2).astype(np.float64) + 0.5) * enlarged - 0.5
            if one in seen and not _is_same(seen[one], tag):
                twice.add(one)
            seen[one] = tag
    return {one: tag for one, tag in seen.items() if one not in twice}


def _is_same(tag: FloatArray, other: FloatArray) -> bool:
    """Whether two outlines [4, 2] are those of one tag, found at two sizes of the image."""
    apart, side = np.linalg.norm(tag.mean(axis=0) - other.mean(axis=0)), np.linalg.norm(tag[1] - tag[0])
    return bool(apart < side / 2)


class _Sides(NamedTuple):
    """The four sides of tags [N, 4, ...], each from a first guess of its first corner to one of its last."""

    starts: FloatArray
    """[N, 4, 2]"""
    steps: FloatArray
    """[N, 4, 2] to the other end."""
    outward: FloatArray
    """[N, 4, 2], of length 1."""

    @property
    def lengths(self) -> FloatArray:
        """[N, 4], px."""
        length: FloatArray = np.linalg.norm(self.steps, axis=-1)
        return length

    def before(self) -> _Sides:
        """At each place the side that ends where the one there begins."""
        return _Sides(*(np.roll(array, 1, axis=1) for array in self))

    def at(self, shares: FloatArray, bends: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points [N, 4, 2] at shares [N, 4] of the sides, bent by parabolas [N, 4, 3]; the slopes there."""
        a, b, c = np.moveaxis(bends, -1, 0)
        bent = (a + shares * (b + shares * c))[..., None] * self.outward
        slopes: FloatArray = self.steps + (b + 2 * shares * c)[..., None] * self.outward
        return self.starts + shares[..., None] * self.steps + bent, slopes


def _refined(image: Grey, seen: dict[int, FloatArray]) -> dict[int, FloatArray]:
    """The tags with their corners where their sides meet."""
    corners = np.stack(list(seen.values()))
    steps = np.roll(corners, -1, axis=1) - corners
    # Clockwise in an image whose rows run down: what is left of a side is outside.
    outward = np.stack([steps[..., 1], -steps[..., 0]], axis=-1)
    sides = _Sides(corners, steps, outward / np.linalg.norm(steps, axis=-1, keepdims=True))
    met = _meeting(sides, _bends(image, sides))
    touched = _touched(image, sides, met)
    half = int(np.clip(TOUCHED_WINDOW * sides.lengths.min(), *TOUCHED_WINDOWS))
    met[touched] = refined_saddles(image, met[touched], half)
    return dict(zip(seen, met, strict=True))


def _bends(image: Grey, sides: _Sides) -> FloatArray:
    """How far outward of each side its edge runs, px: coefficients [N, 4, 3] by powers of the share along it.

    NaN where there is no edge from black to white that a parabola follows.
    """
    reach = np.clip(ACROSS * sides.lengths, LEAST_ACROSS, MOST_ACROSS)
    across = reach[..., None] * np.linspace(-1, 1, STEPS)
    places = sides.starts[..., None, :] + ALONG[:, None] * sides.steps[..., None, :]
    pixels = places[..., None, :] + across[..., None, :, None] * sides.outward[..., None, None, :]
    # A row a side: `cv2.remap` makes no image of more than 32766 rows.
    flat = pixels.astype(np.float32).reshape(4 * len(pixels), -1, 2)
    levels = cv2.remap(image, flat, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    # What gets darker outward is another edge. Squared, the steepest place counts most.
    slopes = np.gradient(levels.reshape(pixels.shape[:-1]).astype(np.float64), axis=-1)
    weights = np.square(np.maximum(slopes, 0))
    edges = (weights * across[..., None, :]).sum(axis=-1) / np.maximum(weights.sum(axis=-1), 1e-9)
    powers = ALONG[:, None] ** np.arange(3)
    trust = np.ones_like(edges)
    for _ in range(FIT_STEPS):
        weighted = np.swapaxes(powers * trust[..., None], -1, -2)
        bends = np.linalg.solve(weighted @ powers, weighted @ edges[..., None])[..., 0]
        misses = edges - bends @ powers.T
        trust = 1 / (1 + (misses / STRAYING_PX) ** 2) ** 2
    strayed = np.sqrt((trust * misses**2).sum(axis=-1) / trust.sum(axis=-1)) > STRAYING_PX
    far = np.abs(bends @ powers.T).max(axis=-1) > reach
    return np.where((strayed | far | (trust.mean(axis=-1) < LEAST_TRUST))[..., None], np.nan, bends)


def _meeting(sides: _Sides, bends: FloatArray) -> FloatArray:
    """Where each side meets the one before it: the tags' corners [N, 4, 2]."""
    before, bends_before = sides.before(), np.roll(bends, 1, axis=1)
    ending, beginning = np.ones(bends.shape[:2]), np.zeros(bends.shape[:2])
    for _ in range(FIT_STEPS):
        (end, slope_end), (begin, slope_begin) = before.at(ending, bends_before), sides.at(beginning, bends)
        J = np.stack([slope_end, -slope_begin], axis=-1)
        moves = np.linalg.solve(J, (begin - end)[..., None])[..., 0]
        ending, beginning = ending + moves[..., 0], beginning + moves[..., 1]
    return sides.at(beginning, bends)[0]


def _touched(image: Grey, sides: _Sides, corners: FloatArray) -> BoolArray:
    """Whether a black square touches the corners [N, 4, 2] from outside [N, 4]."""
    before = sides.before()
    shorter = np.minimum(sides.lengths, before.lengths)[..., None]
    out = BESIDE * shorter * (sides.outward + before.outward)
    outside, inside = levels_at(image, corners + out), levels_at(image, corners - out)
    return np.asarray(outside < inside + LEAST_CONTRAST)


@cache
def _detectors(family: str) -> tuple[Any, ...]:
    """OpenCV's detectors of a family, one for each border its tags are printed with."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, FAMILIES[family]))
    detectors = []
    for border in BORDERS.get(family, (1,)):
        parameters = cv2.aruco.DetectorParameters()
        parameters.markerBorderBits = border
        detectors.append(cv2.aruco.ArucoDetector(dictionary, parameters))
    return tuple(detectors)
