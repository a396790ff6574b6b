"""Arrays, and the pairs of arrays that flow between the folders."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Constants = Mapping[str, Any]
"""Numbers of a formula by name: floats, tuples of floats, or such mappings nested."""


class Matches(NamedTuple):
    """Corresponding pixels of the two images."""

    left: FloatArray
    """[N, 2]"""
    right: FloatArray
    """[N, 2]"""


class Images(NamedTuple):
    """The two photographs, [height, width] or [height, width, channels]."""

    left: NDArray[np.generic]
    right: NDArray[np.generic]
