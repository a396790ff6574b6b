"""The source image as a lookup table takes it apart: the pieces between its entries.

A distortion is an integral over the source. The entries of a table, some pixels apart, are the corners of
quads that tile what it shows; each quad has a source area and a mean derivative. All that a table does
between its entries adds up to these: bending it to have less distortion here makes more of it beside.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.lookup.tables import OUTSIDE, Table, lookup_table
from rectbench.warps.targets import Framed
from rectbench.warps.warp import Warp

FEWEST_PIECES = 6_000
"""In the source image, of about twice as many in the frame; where a table has fewer, a finer one of the
same map is looked at. The log distortion of 95 % of the view is then right to a thousandth; to a hundredth
where the view goes up to the epipoles and a map squeezes its outermost rows."""
LARGEST_TABLE = 2_000_000
"""Entries of a table that is made for this alone."""
RIM_QUADS = 3
"""Quads from one of which not all corners are known to those that the rim does not bend."""
LARGE_SHARE = 1 / 8
"""Of the image's side; pieces are a tenth as large."""
ROUNDING_PX = 0.1
_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))


@dataclass(frozen=True, eq=False)
class Sheet:
    """A warp at one size, as a table: the one that is delivered, or a finer one of the same map."""

    warp: Warp
    size: tuple[int, int]
    table: Table = field(repr=False)
    scale: tuple[float, float] = (1.0, 1.0)
    """Its width and height against the delivered one's."""

    def place(self, px_rect: FloatArray) -> FloatArray:
        """Pixels [K, 2] of the delivered frame in this one; those that are nowhere at (0, 0)."""
        place: FloatArray = np.nan_to_num((px_rect + 0.5) * self.scale - 0.5)
        return place

    def source(self, px_rect: FloatArray) -> FloatArray:
        """Source pixels [K, 2] that the table has at pixels [K, 2] of the delivered frame.

        Whatever `forward` says; between entries, and NaN beside missing ones.
        """
        place = np.clip(self.place(px_rect), 0, np.array(self.size) - 1.0)
        first = np.minimum(place.astype(np.intp), np.maximum(np.array(self.size) - 2, 0))
        (columns, rows), (across, down) = first.T, (place - first).T[..., None]
        nexts = np.minimum(columns + 1, self.size[0] - 1), np.minimum(rows + 1, self.size[1] - 1)
        top, low = (
            self.entries(columns, r) * (1 - across) + self.entries(nexts[0], r) * across
            for r in (rows, nexts[1])
        )
        source: FloatArray = top * (1 - down) + low * down
        return source

    def entries(self, columns: NDArray[np.intp], rows: NDArray[np.intp]) -> FloatArray:
        """Source pixels [K, 2] of the table at columns and rows [K]; NaN where the lens sees nothing."""
        entries = np.stack([layer[rows, columns] for layer in self.table], axis=-1).astype(float)
        entries[(entries == OUTSIDE).all(axis=-1)] = np.nan
        return entries

    def finer(self, entries: float) -> Sheet:
        """The same image with at least so many entries, as far as that is feasible."""
        least = round(math.sqrt(min(entries, LARGEST_TABLE)))
        width, height = (max(side, least) for side in self.size)
        scales = width / self.size[0], height / self.size[1]
        # The harness's own frame: a target may make anything of `framed`.
        warp = replace(self.warp, target=Framed(self.warp.target, -0.5, -0.5, *scales))
        return Sheet(warp, (width, height), lookup_table(warp, (width, height)), scales)


@dataclass(frozen=True, eq=False)
class Pieces:
    """The quads between entries of a table, those that show something of the source image."""

    sheet: Sheet
    columns: NDArray[np.intp] = field(repr=False)
    """[C], of the entries that are corners."""
    rows: NDArray[np.intp] = field(repr=False)
    """[R]"""
    numbers: NDArray[np.intp] = field(repr=False)
    """[R - 1, C - 1], which piece each quad of the frame is; -1 where it shows nothing."""
    middles: FloatArray = field(repr=False)
    """[2, M], source pixels."""
    halves: FloatArray = field(repr=False)
    """[2, M], half of their widths and of their heights in the source."""
    areas_px: FloatArray = field(repr=False)
    """[M], in the source; below 0 where the table is mirrored or folded."""
    jacobians: FloatArray = field(repr=False)
    """[M, 2, 2], d(rectified)/d(source), the mean over the piece, in the frame that is delivered."""

    @classmethod
    def of(cls, delivered: Sheet, fewest: int = FEWEST_PIECES) -> Pieces:
        """Those of a table, or of a finer one: about twice the `fewest` that show the source, if feasible."""
        entries, found = math.prod(delivered.size), cls.between(delivered, 2 * fewest)
        if found.count < fewest < entries:
            wanted = 4 * fewest**2 / max(1, found.count)
            found = cls.between(delivered, min(wanted, entries, LARGEST_TABLE))
        if 0 < found.count < fewest:
            finer = delivered.finer(2 * entries * fewest / found.count)
            found = cls.between(finer, min(LARGEST_TABLE, math.prod(finer.size)))
        return found

    @classmethod
    def between(cls, sheet: Sheet, count: float) -> Pieces:
        """About `count` pieces of a frame, those of them that show the source."""
        spacing = math.sqrt(math.prod(sheet.size) / count)
        columns, rows = (_spread(0, side - 1, spacing) for side in sheet.size)
        seen = [layer != OUTSIDE for layer in (sheet.table[0][:, columns], sheet.table[0][rows])]
        columns, rows = (
            _about(shown, side, spacing)
            for shown, side in zip((seen[1].any(axis=0), seen[0].any(axis=1)), sheet.size, strict=True)
        )
        corners, known = _corners(sheet.table, columns, rows)
        quads = corners[:, :-1, :-1], corners[:, :-1, 1:], corners[:, 1:, :-1], corners[:, 1:, 1:]
        knowns = known[:-1, :-1], known[:-1, 1:], known[1:, :-1], known[1:, 1:]
        shows = _shows(quads, np.stack(knowns), sheet)
        top_left, top_right, low_left, low_right = (corner[:, shows] for corner in quads)
        across = (top_right - top_left + low_right - low_left) / 2
        down = (low_left - top_left + low_right - top_right) / 2
        middles, halves = (top_left + top_right + low_left + low_right) / 4, (abs(across) + abs(down)) / 2
        areas = _areas((top_left, top_right, low_left, low_right))
        steps = np.stack(np.meshgrid(np.diff(columns) / sheet.scale[0], np.diff(rows) / sheet.scale[1]))
        with np.errstate(divide="ignore", invalid="ignore"):
            J = np.array([[down[1], -down[0]], [-across[1], across[0]]]) / areas * steps[:, None, shows]
        numbers = np.where(shows, np.cumsum(shows).reshape(shows.shape) - 1, -1)
        return cls(
            sheet, columns, rows, numbers, middles, halves, areas, np.ascontiguousarray(np.moveaxis(J, 2, 0))
        )

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.areas_px)

    @property
    def folded(self) -> BoolArray:
        """Mask [M] of those that are folded or mirrored, or have no area."""
        return ~(self.areas_px > 0)

    def at(self, px_rect: FloatArray) -> NDArray[np.intp]:
        """The pieces [K] at pixels [K, 2] of the sheet; -1 where there is none."""
        column, row = (
            _intervals(sides)[np.clip(px.astype(np.intp), 0, sides[-1])]
            for sides, px in ((self.columns, px_rect[:, 0]), (self.rows, px_rect[:, 1]))
        )
        found: NDArray[np.intp] = self.numbers[row, column]
        return found

    def hold(self, pixels: FloatArray, px_rect: FloatArray) -> BoolArray:
        """Mask [K] of the source pixels [K, 2] that the table shows at pixels [K, 2] of the delivered frame.

        Of the entries about the place one at least is as near to the pixel as its neighbours are to it.
        """
        held = np.zeros(len(pixels), dtype=bool)
        if not self.count:
            return held
        place = self.sheet.place(px_rect)
        pieces = self._nearest(place)
        step_px = (2 * self.halves[:, pieces] / self.entries_across[:, pieces]).T
        nearest = np.rint(place).astype(np.intp)
        held |= self._has_near(pixels, nearest, step_px + ROUNDING_PX)
        for offset in np.ndindex(5, 5):  # beside the rim of what the lens sees entries are missing
            left = np.flatnonzero(~held)
            if not len(left):
                break
            within_px = 2 * step_px[left] + ROUNDING_PX
            held[left] = self._has_near(pixels[left], nearest[left] + np.array(offset) - 2, within_px)
        return held

    @cached_property
    def entries_across(self) -> NDArray[np.intp]:
        """[2, M], how many entries each is wide and high."""
        steps = np.stack(np.meshgrid(np.diff(self.columns), np.diff(self.rows)))
        across: NDArray[np.intp] = steps[:, self.numbers >= 0]
        return across

    def _has_near(self, pixels: FloatArray, places: NDArray[np.intp], within_px: FloatArray) -> BoolArray:
        """Mask [K], whether entries at whole places [K, 2] of the sheet are so near to pixels [K, 2]."""
        columns, rows = np.clip(places, 0, np.array(self.sheet.size) - 1).T
        near: BoolArray = np.all(np.abs(self.sheet.entries(columns, rows) - pixels) <= within_px, axis=-1)
        return near

    def _nearest(self, place: FloatArray) -> NDArray[np.intp]:
        """The pieces [K] at places [K, 2] of the sheet, or the next ones where there are none."""
        numbers = np.pad(self.numbers, 1, constant_values=-1)
        down, across = self.numbers.shape
        for row, column in np.ndindex(3, 3):
            beside = numbers[row : row + down, column : column + across]
            numbers[1:-1, 1:-1] = np.where(numbers[1:-1, 1:-1] < 0, beside, numbers[1:-1, 1:-1])
        return np.maximum(0, replace(self, numbers=numbers[1:-1, 1:-1]).at(place))

    def areas_within(self, middle: FloatArray, reach: FloatArray) -> FloatArray:
        """[M], source pixels² of each piece in the image and so far from the `middle` [2] as `reach` [2].

        By the extents of pieces, which are smaller than what they are cut by.
        """
        low = np.maximum(middle - reach, -0.5)[:, None]
        high = np.minimum(middle + reach, np.array(self.sheet.warp.source.size) - 0.5)[:, None]
        shares = np.minimum(high - self.middles, self.middles - low)
        shares /= 2 * self.halves
        shares += 0.5
        np.clip(shares, 0.0, 1.0, out=shares)
        areas: FloatArray = self.areas_px * shares[0] * shares[1]
        return areas


def _shows(quads: Sequence[FloatArray], known: BoolArray, sheet: Sheet) -> BoolArray:
    """[R - 1, C - 1], of the quads of these corners [2, R - 1, C - 1] each: which show the source image.

    At the rim of what the lens sees not all corners are `known` [4, R - 1, C - 1]; there the middle is asked.
    """
    camera = sheet.warp.source
    low, high = np.minimum.reduce(quads), np.maximum.reduce(quads)
    with np.errstate(invalid="ignore"):
        shows: BoolArray = np.all((high > -0.5) & (low < np.array(camera.size)[:, None, None] - 0.5), axis=0)
    _drop_far_sides(shows, quads, known, camera)
    rim = shows & ~known.all(axis=0)
    shows[rim] = camera.unproject(np.mean([corner[:, rim] for corner in quads], axis=0).T)[1]
    if rim.any():
        _drop_bent(shows, quads, known)
    return shows


def _drop_bent(shows: BoolArray, quads: Sequence[FloatArray], known: BoolArray) -> None:
    """Mark quads that seem folded where the lens ends: they tell of its rim, not of the map.

    Its rim bends by more than a quad there is wide, and by more than a corner that is guessed is off. Whether
    the map itself is folded is looked at place by place (`check_agreement`).
    """
    rim = (~known.all(axis=0)).astype(np.uint8)
    at_rim = shows & (cv2.dilate(rim, np.ones((3, 3), np.uint8), iterations=RIM_QUADS) > 0)
    shows[at_rim] = _areas([corner[:, at_rim] for corner in quads]) > 0


def _areas(quads: Sequence[FloatArray]) -> FloatArray:
    """Of quads of these corners [2, ...] each: half the product of their diagonals."""
    top_left, top_right, low_left, low_right = quads
    falling, rising = low_right - top_left, low_left - top_right
    areas: FloatArray = (falling[0] * rising[1] - falling[1] * rising[0]) / 2
    return areas


def _drop_far_sides(shows: BoolArray, quads: Sequence[FloatArray], known: BoolArray, camera: Camera) -> None:
    """Mark quads that seem to show the source, and show none of it.

    About the direction straight back a model may have pixels all around the image, and a quad there seems to
    hold the image. What it shows is what lies between the rays of its corners.
    """
    extents = np.maximum.reduce(quads) - np.minimum.reduce(quads)
    with np.errstate(invalid="ignore"):
        is_large = np.any(extents > LARGE_SHARE * np.array(camera.size)[:, None, None], axis=0)
    large = np.argwhere(shows & is_large)
    rows, columns = large.T
    corners = np.stack([corner[:, rows, columns].T for corner in quads])
    corners[~known[:, rows, columns]] = np.nan
    off = ~camera.contains(corners).any(axis=0)
    rays = np.nansum(camera.whole.unproject(corners[:, off])[0], axis=0)
    shows[rows[off], columns[off]] = camera.whole.sees(rays)


def _about(shown: BoolArray, side: int, spacing: float) -> NDArray[np.intp]:
    """Whole numbers from 0 to `side` - 1 about so far apart, the first and the last `shown` among them.

    Up to those a table tells its derivative; a corner beyond them would have to be guessed.
    """
    places = np.flatnonzero(shown)
    if not len(places) or places[0] == places[-1]:
        return _spread(0, side - 1, spacing)
    ends = np.unique([0, places[0], places[-1], side - 1])
    spans = [_spread(first, last, spacing)[:-1] for first, last in pairwise(ends.tolist())]
    return np.concatenate([*spans, ends[-1:]])


def _spread(first: int, last: int, spacing: float) -> NDArray[np.intp]:
    """Whole numbers from the first to the last, about so far apart."""
    steps = max(1, min(last - first, round((last - first) / spacing)))
    return np.rint(np.linspace(first, last, steps + 1)).astype(np.intp)


def _intervals(sides: NDArray[np.intp]) -> NDArray[np.intp]:
    """For each whole number from 0 to the last of rising `sides`, the interval between two that holds it."""
    return np.minimum(np.searchsorted(sides, np.arange(sides[-1] + 1), side="right") - 1, len(sides) - 2)


def _corners(table: Table, columns: NDArray[np.intp], rows: NDArray[np.intp]) -> tuple[FloatArray, BoolArray]:
    """Entries of a table at rows and columns, [2, R, C], and whether they are there, [R, C].

    Beside those that are there, one beyond them is guessed: pieces at the rim of what a lens sees count too.
    """
    corners = np.stack([layer[np.ix_(rows, columns)] for layer in table]).astype(float)
    is_known: BoolArray = np.any(corners != OUTSIDE, axis=0)
    if is_known.all():
        return corners, is_known
    corners[:, ~is_known] = np.nan
    row, column = np.nonzero(cv2.dilate(is_known.view(np.uint8), _CROSS).view(bool) & ~is_known)
    guesses = [
        _extended(corners, (row, column), places, along, step)
        for along, places in enumerate((rows, columns))
        for step in (-1, 1)
    ]
    there = np.isfinite(guesses)
    with np.errstate(invalid="ignore"):
        corners[:, row, column] = np.where(there, guesses, 0).sum(axis=0) / there.sum(axis=0)
    return corners, is_known


def _extended(
    corners: FloatArray,
    wanted: tuple[NDArray[np.intp], NDArray[np.intp]],
    places: NDArray[np.intp],
    along: int,
    step: int,
) -> FloatArray:
    """Corners [2, K] wanted at (rows, columns), by the parabola through the next three, or the line of two.

    Those follow step by step along rows (0) or columns (1), which stand at `places` of the table.
    """
    at = wanted[along]
    indices = [np.clip(at + steps * step, 0, len(places) - 1) for steps in (1, 2, 3)]
    first, second, third = (
        corners[:, index, wanted[1]] if along == 0 else corners[:, wanted[0], index] for index in indices
    )
    x, (x1, x2, x3) = places[at], (places[index] for index in indices)
    with np.errstate(divide="ignore", invalid="ignore"):  # infinite at the table's end
        slope = (first - second) / (x1 - x2)
        bend = (slope - (second - third) / (x2 - x3)) / (x1 - x3)
        line = first + slope * (x - x1)
        parabola = line + bend * (x - x1) * (x - x2)
    extended: FloatArray = np.where(np.isfinite(parabola), parabola, line)
    return extended
