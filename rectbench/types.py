"""Arrays, and the pairs of arrays that flow between the folders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Constants = Mapping[str, Any]
"""Numbers of a formula by name: floats, tables (arrays [N]), tuples of these, or such mappings nested."""


class Matches(NamedTuple):
    """Corresponding pixels of the two images.

    >>> left, right = Matches(np.array([[10.0, 20.0]]), np.array([[7.0, 20.0]]))
    >>> (left - right).tolist()
    [[3.0, 0.0]]
    """

    left: FloatArray
    """[N, 2]"""
    right: FloatArray
    """[N, 2]"""


class Images(NamedTuple):
    """The two photographs, [height, width] or [height, width, channels].

    >>> Images(np.zeros((480, 640)), np.zeros((480, 640))).left.shape
    (480, 640)
    """

    left: NDArray[np.generic]
    right: NDArray[np.generic]
