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

from rectbench.cameras.arrays import BoolArray
from rectbench.warps.tables import FloatMap
from rectbench.warps.warp import Warp

UNSHRUNK = 1.01
"""σ² up to which a length counts as not shrunk: to average there would move no grey level by more than ½."""
MOST_SAMPLES = 16
"""A pixel that needs more samples reads them from the source image halved as often as it takes."""
WHOLE = 1e-3
"""A number of samples this little above a whole one is that one."""
TILE_ROWS, TILE_COLUMNS = 128, 256
"""Pixels worked on at once: what belongs to a tile stays in a core's cache."""


@dataclass(frozen=True, eq=False)
class Patch:
    """The pixels of one tile that average equally many samples, in the rectangle around them."""

    place: tuple[slice, slice]
    """Rows and columns of the rectangle in the rectified image."""
    mask: BoolArray = field(repr=False)
    """[h, w], the pixels of the rectangle that are meant."""
    level: int
    """How often the source image is halved before it is read."""
    counts: tuple[int, int]
    """Samples in a row along A's first and along its second column."""
    first: FloatMap = field(repr=False)
    """[2, h, w], x and y of the first sample, in pixels of the halved image."""
    steps: FloatMap = field(repr=False)
    """[2, 2, h, w], x and y from one sample to the next, along the first and along the second column."""

    def samples(self) -> Iterator[FloatMap]:
        """Maps [2, h, w] for `cv2.remap`, one a sample."""
        across, down = self.steps
        for i in range(self.counts[1]):
            at = self.first + i * down
            for _ in range(self.counts[0]):
                yield at
                at = at + across


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
        w, h = warp.source.size
        patches: list[Patch] = []
        valid_count = shrunk_count = 0
        largest = 1.0
        for top in range(0, height, TILE_ROWS):
            rows = slice(top, min(top + TILE_ROWS, height))
            v, u = np.mgrid[rows, 0:width]
            strip = warp.inverse_jacobian(np.stack([u, v], axis=-1)).astype(np.float32)
            for left in range(0, width, TILE_COLUMNS):
                place = rows, slice(left, min(left + TILE_COLUMNS, width))
                x, y = centre = np.stack([table[place] for table in maps])
                valid = (x >= 0) & (x <= w - 1) & (y >= 0) & (y <= h - 1)
                A = np.ascontiguousarray(np.moveaxis(strip[:, place[1]], (-2, -1), (0, 1)))
                longest = longest_px(A)
                shrunk = valid & (longest * longest > UNSHRUNK)
                valid_count += int(valid.sum())
                shrunk_count += int(shrunk.sum())
                if shrunk.any():
                    largest = max(largest, float(longest[shrunk].max()))
                    patches += _patches(place, centre, A, shrunk, (w, h))
        return cls(tuple(patches), shrunk_count / max(valid_count, 1), largest)

    @property
    def levels(self) -> int:
        """How often the source image is halved for the pixels that cover most."""
        return max((patch.level for patch in self.patches), default=0)


def longest_px(A: NDArray[Any]) -> NDArray[Any]:
    """σ1 [...] of A [2, 2, ...], the length of the longest axis; NaN where A is."""
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
    f_top, f_bottom, f_mixed = (
        f_small + slope * (radius + half_gap),
        f_small + slope * (radius - half_gap),
        slope * mixed,
    )
    (p, q), (r, s) = A
    return np.stack(
        [
            np.stack([f_top * p + f_mixed * r, f_top * q + f_mixed * s]),
            np.stack([f_mixed * p + f_bottom * r, f_mixed * q + f_bottom * s]),
        ]
    )


def _gram(A: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """Of A Aᵀ the mean of the eigenvalues and half their difference, then those of the diagonal; the mixed entry."""
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
        lengths = np.hypot(spread[0], spread[1])
        counts = np.ceil(np.sqrt(1 + lengths * lengths) - WHOLE)
        if level == highest:
            counts = np.ones_like(counts)  # that image is a single pixel
        fits = shrunk & (counts[0] * counts[1] <= MOST_SAMPLES)
        shrunk = shrunk & ~fits
        middle = (centre + 0.5) * 0.5**level - 0.5
        for across, down in np.unique(counts[:, fits].astype(int), axis=1).T:
            mask = fits & (counts[0] == across) & (counts[1] == down)
            yield _patch(place, mask, level, (int(across), int(down)), middle, spread)
        if not shrunk.any():
            return


def _patch(
    place: tuple[slice, slice],
    mask: BoolArray,
    level: int,
    counts: tuple[int, int],
    middle: FloatMap,
    spread: FloatMap,
) -> Patch:
    box = tuple(_extent(mask.any(axis=axis)) for axis in (1, 0))
    steps = [spread[:, k][:, *box] / math.sqrt(max(n * n - 1, 1)) for k, n in enumerate(counts)]
    first = middle[:, *box] - sum((n - 1) / 2 * step for n, step in zip(counts, steps, strict=True))
    rows, columns = (
        slice(whole.start + part.start, whole.start + part.stop) for whole, part in zip(place, box)
    )
    return Patch((rows, columns), mask[box], level, counts, *map(np.float32, (first, steps)))


def _extent(marked: BoolArray) -> slice:
    """From the first to the last that is marked."""
    (where,) = np.nonzero(marked)
    return slice(int(where[0]), int(where[-1]) + 1)
