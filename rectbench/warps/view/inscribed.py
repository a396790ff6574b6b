"""The largest rectangle of valid pixels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

COARSE_SIDE = 400
"""Cells along a mask's longer side in which the rectangle is sought; its edges then grow pixel by pixel."""


class Box(NamedTuple):
    """Pixels left to right - 1 of rows top to bottom - 1."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def area(self) -> int:
        """Number of pixels."""
        return (self.right - self.left) * (self.bottom - self.top)


def largest_rectangle(valid: NDArray[np.bool_]) -> Box:
    """The largest axis-parallel rectangle of a mask [H, W] all of whose pixels are valid; empty if none is.

    Exact in cells of a grid that is as fine as the mask up to 400 pixels a side; in a larger mask its
    edges then grow to the last valid pixel.
    """
    cell = max(1, -(-max(valid.shape) // COARSE_SIDE))
    height, width = (side // cell * cell for side in valid.shape)
    blocks = valid[:height, :width].reshape(height // cell, cell, width // cell, cell)
    best = Box(*(cell * edge for edge in _largest(blocks.min(axis=(1, 3)))))
    if not best.area and cell > 1 and valid.any():  # what there is is narrower than a cell
        rows, columns = (np.flatnonzero(valid.any(axis=axis)) for axis in (1, 0))
        top, left = int(rows[0]), int(columns[0])
        inner = _largest(valid[top : rows[-1] + 1, left : columns[-1] + 1])
        return Box(inner.left + left, inner.top + top, inner.right + left, inner.bottom + top)
    return _grown(best, valid) if best.area else best


def _largest(valid: NDArray[np.bool_]) -> Box:
    """By the largest rectangle under a histogram, row after row, in time linear in the pixels."""
    best, heights = Box(0, 0, 0, 0), np.zeros(valid.shape[1] + 1, dtype=int)
    for bottom, row in enumerate(valid, start=1):
        heights[:-1] = np.where(row, heights[:-1] + 1, 0)
        open_bars: list[tuple[int, int]] = []  # (first column, height), rising
        for column, height in enumerate(heights.tolist()):
            first = column
            while open_bars and open_bars[-1][1] >= height:
                first, tall = open_bars.pop()
                if tall * (column - first) > best.area:
                    best = Box(first, bottom - tall, column, bottom)
            open_bars.append((first, height))
    return best


def _grown(box: Box, valid: NDArray[np.bool_]) -> Box:
    """Each edge moved outwards for as long as it meets valid pixels alone."""
    left, top, right, bottom = box
    while left > 0 and valid[top:bottom, left - 1].all():
        left -= 1
    while right < valid.shape[1] and valid[top:bottom, right].all():
        right += 1
    while top > 0 and valid[top - 1, left:right].all():
        top -= 1
    while bottom < valid.shape[0] and valid[bottom, left:right].all():
        bottom += 1
    return Box(left, top, right, bottom)
