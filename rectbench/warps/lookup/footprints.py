"""What rectified pixels cover in the source image, and where to read so as to average over it.

To first order a rectified pixel covers the parallelogram A [-½, ½]² of the source image, where
A = d(source)/d(rectified) has the singular values σ1 ≥ σ2. A source pixel is an average over a square
already. What remains to be averaged is A' [-½, ½]², where A' has A's singular vectors and the
singular values sqrt(max(0, σ² - 1)): variances add. A' is 0 where the warp magnifies, grows from
there without a jump, and is turned and skewed as A is.

A row of n samples has the variance of a line of length s where they are s / sqrt(n² - 1) apart. An
image made k times smaller, k whole, is thus the mean of k x k source pixels, `cv2.INTER_AREA`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.types import BoolArray, FloatArray
from rectbench.warps.lookup.tables import FloatMap, reads_source
from rectbench.warps.warp import Warp

UNSHRUNK = 1.01
"""σ² up to which a length counts as not shrunk: averaging would move no 8-bit value by more than about ½."""
MOST_SAMPLES = 64
"""A pixel that needs more reads them from the source image halved as often as it takes.

With 16 the error against 16 x 16 samples is three times as large where an image is made 5 times smaller.
"""
WHOLE = 1e-3
"""A number of samples this little above a whole one is that one."""
LONGEST_PX = 1e6
"""No image is longer; at an epipole A grows beyond all bounds."""
TRIANGLE_PX = 1.0
"""Sides of A' up to which three samples at the corners of a triangle do for four."""
TRIANGLE, ROW = 0, 128
"""Names of arrangements: three samples, or `ROW` * n + m, rows of n by m."""
TILE_ROWS, TILE_COLUMNS = 64, 128
"""Pixels worked on at once: what belongs to a tile stays in a core's cache."""


@dataclass(frozen=True, eq=False)
class Patch:
    """The pixels of one tile that read the same arrangement of samples, in the rectangle around them."""

    place: tuple[slice, slice]
    """Rows and columns of the rectangle in the rectified image."""
    mask: BoolArray = field(repr=False)
    """[h, w], the pixels of the rectangle that are meant."""
    level: int
    """How often the source image is halved before it is read."""
    samples: FloatMap
    """[n, 2] in units of the columns of A'."""
    middle: FloatMap = field(repr=False)
    """[2, h, w], x and y where the pixel's centre lies in the halved image."""
    spread: FloatMap = field(repr=False)
    """[2, 2, h, w], the columns of A', each x and y."""

    def maps(self) -> tuple[FloatMap, FloatMap]:
        """x and y [n h, w] for `cv2.remap`, one sample's below the other's: one call for all is quickest."""
        offsets = np.tensordot(self.samples, self.spread, axes=1)
        x, y = self.middle[:, None] + np.moveaxis(offsets, 0, 1)
        width = self.mask.shape[1]
        return x.reshape(-1, width), y.reshape(-1, width)


@dataclass(frozen=True, eq=False)
class Footprints:
    """What the pixels of one rectified image cover in its source, as far as that is more than a pixel."""

    patches: tuple[Patch, ...] = field(repr=False)
    shrunk_share: float
    """Of the rectified pixels that show source pixels, those that average several."""
    largest_px: float
    """The longest of their footprints, σ1 in source pixels; 1 where none is larger."""

    @classmethod
    def of(cls, warp: Warp, maps: tuple[FloatMap, FloatMap]) -> Footprints:
        """Those of the rectified image that the lookup table `maps` makes.

        Pixels that read the border, or whose derivative does not exist, are left as they are.
        """
        height, width = maps[0].shape
        valid = reads_source(*maps, warp.source.size)
        patches: list[Patch] = []
        shrunk_count, largest = 0, 1.0
        for top in range(0, height, TILE_ROWS):
            rows = slice(top, min(top + TILE_ROWS, height))
            strip = _derivatives(warp, rows, width)
            for left in range(0, width, TILE_COLUMNS):
                place = rows, slice(left, min(left + TILE_COLUMNS, width))
                A = np.ascontiguousarray(strip[:, :, :, place[1]])
                longest = longest_px(A)
                shrunk = valid[place] & (longest * longest > UNSHRUNK)
                if shrunk.any():
                    shrunk_count += int(shrunk.sum())
                    largest = max(largest, float(longest[shrunk].max()))
                    centre = np.stack([table[place] for table in maps])
                    patches += _patches(place, centre, A, shrunk, warp.source.size)
        return cls(tuple(patches), shrunk_count / max(int(valid.sum()), 1), largest)

    @property
    def levels(self) -> int:
        """How often the source image is halved for the pixels that cover most."""
        return max((patch.level for patch in self.patches), default=0)


def _derivatives(warp: Warp, rows: slice, width: int) -> FloatMap:
    """A [2, 2, rows, width]; 0, which covers nothing, where there is none."""
    v, u = np.mgrid[rows, 0:width]
    entries = np.clip(warp.inverse_jacobian(np.stack([u, v], axis=-1)), -LONGEST_PX, LONGEST_PX)
    A = np.moveaxis(entries, (-2, -1), (0, 1)).astype(np.float32, order="C")
    A[np.isnan(A)] = 0
    return A


def longest_px(A: NDArray[Any]) -> NDArray[Any]:
    """σ1 [...] of A [2, 2, ...]: how long the ellipse is that a pixel covers."""
    mean, radius, *_ = _gram(A)
    longest: NDArray[Any] = np.sqrt(mean + radius)
    return longest


def remaining(A: NDArray[Any]) -> NDArray[Any]:
    """A' [2, 2, ...] of A [2, 2, ...]: the same singular vectors, σ turned into sqrt(max(0, σ² - 1)).

    A' = f(A Aᵀ) A with f(λ) = sqrt(max(0, 1 - 1/λ)), and f of a symmetric 2x2 matrix M with the
    eigenvalues λ1, λ2 is f(λ2) I + (f(λ1) - f(λ2)) / (λ1 - λ2) (M - λ2 I).
    """
    mean, radius, half_gap, mixed = _gram(A)
    large, small = mean + radius, mean - radius
    f_large, f_small = (np.sqrt(1 - 1 / np.where(square > UNSHRUNK, square, 1)) for square in (large, small))
    slope = (f_large - f_small) / np.maximum(2 * radius, np.finfo(A.dtype).tiny)
    f_top, f_bottom = f_small + slope * (radius + half_gap), f_small + slope * (radius - half_gap)
    f_mixed = slope * mixed
    (p, q), (r, s) = A
    top = np.stack([f_top * p + f_mixed * r, f_top * q + f_mixed * s])
    bottom = np.stack([f_mixed * p + f_bottom * r, f_mixed * q + f_bottom * s])
    return np.stack([top, bottom])


def _gram(A: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """Of A Aᵀ: mean and half difference of the eigenvalues, half that of the diagonal, mixed entry."""
    (p, q), (r, s) = A
    top, bottom, mixed = p * p + q * q, r * r + s * s, p * r + q * s
    half_gap = (top - bottom) / 2
    return (top + bottom) / 2, np.hypot(half_gap, mixed), half_gap, mixed


def _patches(
    place: tuple[slice, slice], centre: FloatMap, A: FloatMap, shrunk: BoolArray, size: tuple[int, int]
) -> Iterator[Patch]:
    """The shrunk pixels of a tile, by how they are read."""
    highest = math.ceil(math.log2(max(size)))
    for level in range(highest + 1):
        spread = remaining(A * np.float32(0.5**level))
        arrangement, count = _arranged(spread)
        if level == highest:  # that image is a single pixel
            arrangement, count = np.full_like(arrangement, ROW + 1), np.ones_like(count)
        fits = shrunk & (count <= MOST_SAMPLES)
        middle = (centre + np.float32(0.5)) * np.float32(0.5**level) - np.float32(0.5)
        for which in np.flatnonzero(np.bincount(arrangement[fits])):
            mask = fits & (arrangement == which)
            box = _extent(mask.any(axis=1)), _extent(mask.any(axis=0))
            yield Patch(
                _within(place, box),
                mask[box],
                level,
                _samples(int(which)).astype(np.float32),
                np.ascontiguousarray(middle[:, *box]),
                np.ascontiguousarray(spread.swapaxes(0, 1)[:, :, *box]),
            )
        shrunk = shrunk & ~fits
        if not shrunk.any():
            return


def _arranged(spread: FloatMap) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The arrangement of samples of each pixel, see `_samples`, and how many these are."""
    lengths = np.hypot(spread[0], spread[1])
    rows = np.ceil(np.sqrt(1 + lengths * lengths) - WHOLE)
    across, down = np.minimum(rows, MOST_SAMPLES + 1).astype(np.intp)
    three = (across == 2) & (down == 2) & (lengths <= TRIANGLE_PX).all(axis=0)
    return np.where(three, TRIANGLE, ROW * across + down), np.where(three, 3, across * down)


def _samples(arrangement: int) -> FloatArray:
    """[n, 2], with mean 0 and the covariance of the square [-½, ½]² along the sides it is spread over."""
    if arrangement == TRIANGLE:
        turns = np.radians([90, 210, 330])
        return np.stack([np.cos(turns), np.sin(turns)], axis=-1) / math.sqrt(6)
    across, down = (
        (np.arange(n) - (n - 1) / 2) / math.sqrt(max(n * n - 1, 1)) for n in divmod(arrangement, ROW)
    )
    return np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)


def _within(place: tuple[slice, slice], box: tuple[slice, slice]) -> tuple[slice, slice]:
    rows, columns = (
        slice(whole.start + part.start, whole.start + part.stop)
        for whole, part in zip(place, box, strict=True)
    )
    return rows, columns


def _extent(marked: BoolArray) -> slice:
    """From the first to the last that is marked."""
    (where,) = np.nonzero(marked)
    return slice(int(where[0]), int(where[-1]) + 1)
