"""Feature detectors by name, and the descriptors they give as unit vectors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import Unavailable, UnknownName
from rectbench.images.reading import Grey
from rectbench.types import FloatArray

Descriptors = NDArray[np.float32]
"""Descriptors [N, d] of length 1."""


class Features(NamedTuple):
    """Features of one image."""

    pixels: FloatArray
    """[N, 2]"""
    descriptors: Descriptors


@dataclass(frozen=True)
class Detector:
    """How features are found, described and told apart."""

    make: Callable[[int | None], Any]
    """The OpenCV detector that keeps the strongest so many, or all."""
    vectors: Callable[[NDArray[Any]], Descriptors]
    """From the descriptors to vectors [N, d] of any length."""
    binary: bool = False
    """Whether a descriptor is a string of bits."""

    def features(self, image: Grey, working_pixels: float | None, most: int | None) -> Features:
        """The strongest features of an image, in its own pixels, found on one of `working_pixels`."""
        small = _reduced(image, working_pixels)
        keypoints, descriptors = self.make(most).detectAndCompute(small, None)
        if not keypoints:
            return Features(np.empty((0, 2)), np.empty((0, 1), np.float32))
        if most is not None and len(keypoints) > most:
            strongest = np.argsort([-point.response for point in keypoints], kind="stable")[:most]
            keypoints, descriptors = [keypoints[i] for i in strongest], descriptors[strongest]
        vectors = self.vectors(descriptors)
        vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
        enlarged = np.array(image.shape[::-1]) / small.shape[::-1]
        pixels = np.array([point.pt for point in keypoints], dtype=np.float64)
        return Features((pixels + 0.5) * enlarged - 0.5, vectors)

    def distance(self, similarity: Descriptors) -> Descriptors:
        """Distance of two descriptors with this product: the share of bits that differ, or Euclidean."""
        product = np.clip(similarity, -1, 1)
        distance = (1 - product) / 2 if self.binary else np.sqrt(2 - 2 * product)
        return np.asarray(distance, dtype=np.float32)


def detector_named(name: str) -> Detector:
    """The detector of this name; UnknownName where there is none."""
    if not isinstance(name, str) or name not in _DETECTORS:
        raise UnknownName("detector", str(name), _DETECTORS)
    return _DETECTORS[name]


def _reduced(image: Grey, working_pixels: float | None) -> Grey:
    if working_pixels is None or image.size <= working_pixels:
        return image
    factor = math.sqrt(working_pixels / image.size)
    height, width = (max(1, round(length * factor)) for length in image.shape)
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _sift(most: int | None) -> Any:
    # Without the precise upscaling OpenCV's features lie a quarter of a pixel too far right and down.
    return cv2.SIFT.create(nfeatures=most or 0, enable_precise_upscale=True)


def _akaze(most: int | None) -> Any:
    # It moved from OpenCV's own modules to the contributed ones with OpenCV 5.
    module: Any = cv2 if hasattr(cv2, "AKAZE_create") else getattr(cv2, "xfeatures2d", None)
    if not hasattr(module, "AKAZE_create"):
        raise Unavailable("this OpenCV has no AKAZE; install opencv-contrib-python-headless")
    return module.AKAZE_create(max_points=most or -1)


def _orb(most: int | None) -> Any:
    return cv2.ORB.create(nfeatures=most or 1 << 17)


def _surf(most: int | None) -> Any:
    contributed: Any = getattr(cv2, "xfeatures2d", None)
    try:
        return contributed.SURF_create()
    except (AttributeError, cv2.error):
        raise Unavailable(
            "this OpenCV has no SURF, which is patented and left out of the wheels; "
            "use sift, or build OpenCV with OPENCV_ENABLE_NONFREE"
        ) from None


def _rooted(descriptors: NDArray[Any]) -> Descriptors:
    """Root-SIFT: Hellinger distances tell descriptors apart better (Arandjelović and Zisserman 2012)."""
    return np.sqrt(np.asarray(descriptors, dtype=np.float32))


def _signs(descriptors: NDArray[Any]) -> Descriptors:
    """A bit as -1 or 1: the product of two strings is then one less twice the share that differs."""
    return np.unpackbits(descriptors, axis=1).astype(np.float32) * 2 - 1


def _unchanged(descriptors: NDArray[Any]) -> Descriptors:
    return np.asarray(descriptors, dtype=np.float32)


_DETECTORS = {
    "sift": Detector(_sift, _rooted),
    "akaze": Detector(_akaze, _signs, binary=True),
    "orb": Detector(_orb, _signs, binary=True),
    "surf": Detector(_surf, _unchanged),
}
DETECTORS = tuple(_DETECTORS)
