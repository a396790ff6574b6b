"""Square markers with an identity: AprilTag and ArUco, as calibration boards carry them."""

from __future__ import annotations

from functools import cache
from typing import Any

import cv2
import numpy as np

from rectbench.cameras.arrays import FloatArray
from rectbench.matching.images import Grey

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


def tags(image: Grey) -> dict[str, dict[int, FloatArray]]:
    """Per family and identity the four corners [4, 2] of each tag in the image, clockwise as the tag is read.

    They are good to a pixel. An identity that is seen twice is left out.
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
    return found


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
