"""Square markers with an identity, AprilTag and ArUco, as calibration boards carry them.

A tag's corner is where its sides meet. Each side is found where the image is steepest across it and followed
as a parabola, since a lens bends it. Blur would pull `cv2.cornerSubPix` 0.2 px out of such a corner; it is
the better one where a black square touches the corner from outside, as on Kalibr's AprilGrid.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import cv2
import numpy as np

from rectbench.cameras.arrays import FloatArray
from rectbench.matching.images import Grey
from rectbench.matching.saddles import levels_at, refined_saddles

FAMILIES = {
    "AprilTag 36h11": "DICT_APRILTAG_36h11",
    "ArUco 4x4": "DICT_4X4_1000",
    "ArUco 5x5": "DICT_5X5_1000",
    "ArUco 6x6": "DICT_6X6_1000",
    "ArUco 7x7": "DICT_7X7_1000",
}
"""Names of families, and OpenCV's. A family's smaller dictionaries are the beginning of its largest."""
KALIBR_BORDER = 2
"""Modules of black about a tag of Kalibr's AprilGrid; elsewhere there is one."""
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
BESIDE, LEAST_CONTRAST = 0.07, 20
"""How far out of a corner, in lengths along both sides, a black square that touches it is looked for; grey
levels by which white is lighter."""
TOUCHED_WINDOW, TOUCHED_WINDOWS = 0.12, (2, 8)
"""Half the window in which a corner is refined that a square touches: a share of the shortest side; px."""


def tags(image: Grey) -> dict[str, dict[int, FloatArray]]:
    """Per family and identity the four corners [4, 2] of each tag in the image, clockwise as the tag is read.

    A corner is NaN where one of its sides is not found. An identity that is seen twice is left out.
    """
    found: dict[str, dict[int, FloatArray]] = {}
    twice: set[tuple[str, int]] = set()
    for families, detector in (_one_border(), _kalibr_border()):
        corners, ids, _, family = detector.detectMarkersMultiDict(image)
        if ids is None:
            continue
        for quad, one, which in zip(corners, np.ravel(ids), np.ravel(family), strict=True):
            seen = found.setdefault(families[which], {})
            if int(one) in seen:
                twice.add((families[which], int(one)))
            seen[int(one)] = quad.reshape(4, 2).astype(np.float64)
    for name, one in twice:
        del found[name][one]
    return {name: _refined(image, seen) for name, seen in found.items() if seen}


def _refined(image: Grey, seen: dict[int, FloatArray]) -> dict[int, FloatArray]:
    """The tags with their corners where their sides meet."""
    corners = np.stack(list(seen.values()))
    starts, steps = corners, np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(steps, axis=-1, keepdims=True)
    # Clockwise in an image whose rows run down: what is left of a side is outside.
    outward = np.stack([steps[..., 1], -steps[..., 0]], axis=-1) / lengths
    offsets = _parabolas(image, starts, steps, outward, lengths[..., 0])
    met = _meeting(starts, steps, outward, offsets)
    # The way out of each corner, across both of its sides.
    out = (outward + np.roll(outward, 1, axis=1)) * np.minimum(lengths, np.roll(lengths, 1, axis=1))
    touched = levels_at(image, met + BESIDE * out) < (levels_at(image, met - BESIDE * out) + LEAST_CONTRAST)
    found = np.isfinite(met).all(axis=-1)
    half = int(np.clip(TOUCHED_WINDOW * lengths.min(), *TOUCHED_WINDOWS))
    met[touched & found] = refined_saddles(image, met[touched & found], half)
    return dict(zip(seen, met, strict=True))


def _parabolas(
    image: Grey, starts: FloatArray, steps: FloatArray, outward: FloatArray, lengths: FloatArray
) -> FloatArray:
    """Coefficients [N, 4, 3] by powers of the share along a side: how far outward of it the edge runs, px."""
    reach = np.clip(ACROSS * lengths, LEAST_ACROSS, MOST_ACROSS)
    across = reach[..., None] * np.linspace(-1, 1, STEPS)
    places = starts[..., None, :] + ALONG[:, None] * steps[..., None, :]
    pixels = places[..., None, :] + across[..., None, :, None] * outward[..., None, None, :]
    flat = pixels.astype(np.float32).reshape(-1, STEPS, 2)
    levels = cv2.remap(
        image.astype(np.float32), flat, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    # Outward from black to white: what falls is something else.
    slopes = np.maximum(np.gradient(levels.reshape(pixels.shape[:-1]).astype(np.float64), axis=-1), 0) ** 2
    weights = slopes.sum(axis=-1)
    edges = (slopes * across[..., None, :]).sum(axis=-1) / np.maximum(weights, 1e-9)
    powers = ALONG[:, None] ** np.arange(3)
    trust = np.ones_like(edges)
    for _ in range(FIT_STEPS):
        weighted = np.swapaxes(powers * trust[..., None], -1, -2)
        fit = np.linalg.solve(weighted @ powers, weighted @ edges[..., None])[..., 0]
        misses = edges - fit @ powers.T
        trust = 1 / (1 + (misses / STRAYING_PX) ** 2) ** 2
    strayed = np.sqrt((trust * misses**2).sum(axis=-1) / trust.sum(axis=-1)) > STRAYING_PX
    lost = strayed | (trust.mean(axis=-1) < 0.5) | (np.abs(fit @ powers.T).max(axis=-1) > reach)
    return np.where(lost[..., None], np.nan, fit)


def _meeting(starts: FloatArray, steps: FloatArray, outward: FloatArray, offsets: FloatArray) -> FloatArray:
    """Where each side [N, 4] meets the one before it: the tag's corners [N, 4, 2]."""
    before = [np.roll(array, 1, axis=1) for array in (starts, steps, outward, offsets)]
    sides = (before, [starts, steps, outward, offsets])
    shares = [np.ones(starts.shape[:2]), np.zeros(starts.shape[:2])]
    for _ in range(FIT_STEPS):
        points, tangents = zip(
            *(_on_side(*side, share) for side, share in zip(sides, shares, strict=True)), strict=True
        )
        gap = points[1] - points[0]
        J = np.stack([tangents[0], -tangents[1]], axis=-1)
        moves = np.linalg.solve(J, gap[..., None])[..., 0]
        shares = [shares[0] + moves[..., 0], shares[1] + moves[..., 1]]
    met: FloatArray = _on_side(*sides[1], shares[1])[0]
    return met


def _on_side(
    starts: FloatArray, steps: FloatArray, outward: FloatArray, offsets: FloatArray, shares: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Points [N, 4, 2] on the sides at a share of their lengths [N, 4], and the slopes there."""
    a, b, c = np.moveaxis(offsets, -1, 0)
    points = starts + shares[..., None] * steps + (a + shares * (b + shares * c))[..., None] * outward
    return points, steps + (b + 2 * shares * c)[..., None] * outward


@cache
def _one_border() -> tuple[tuple[str, ...], Any]:
    return tuple(FAMILIES), _detector(tuple(FAMILIES), border=1)


@cache
def _kalibr_border() -> tuple[tuple[str, ...], Any]:
    return ("AprilTag 36h11",), _detector(("AprilTag 36h11",), KALIBR_BORDER)


def _detector(families: tuple[str, ...], border: int) -> Any:
    dictionaries = [cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, FAMILIES[one])) for one in families]
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = border
    return cv2.aruco.ArucoDetector(dictionaries, parameters)
