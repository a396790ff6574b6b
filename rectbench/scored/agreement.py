"""Whether all that a rectification says of itself is one map: forward, inverse, derivative and tables.

It is asked at places that follow from a digest of the lookup tables: no table can be made to fit them.
Where the tables hold another distortion than the scored pixels do, beyond what sampling explains, the
map was made for these.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidResult
from rectbench.scored.delivered import Delivered, DeliveredSide, differences
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.jacobians import entries, log_distortion_parts
from rectbench.warps.lookup.resampling import SIDES, Side
from rectbench.warps.lookup.tables import OUTSIDE, FloatMap, lookup_table
from rectbench.warps.rectification import LARGEST_SIDE_PX, Rectification, in_frame
from rectbench.warps.targets import Framed
from rectbench.warps.warp import Warp

PLACES = 1_500
"""An image, each in the cell of a scored pixel."""
TABLE_PX = 0.01
"""A table's entry is this near to the inverse map; float32 keeps 0.001 px of the largest image."""
SHOWN_SHARE = 0.9
"""Of the places beside shown pixels as many are shown, and have an entry; the rest lie at edges."""
ROUNDING_PX = 0.1
CLOSURE_PX = 1e-3
"""inverse(forward(x)) is this near to x."""
LARGEST_TABLE = 4.0
"""Entries of a table that is made for this alone, in pixels of the source image."""
DERIVATIVE_SHARE, DERIVATIVE_ARM_PX = 5e-3, 5e-3
"""The stated derivative is this near to differences over so short an arm, by the largest entry there."""
DISTORTION_SHARE, DISTORTION_FLOOR = 0.01, 2e-3
"""The tables' log distortion is this near to the scored pixels', of which it is an independent sample."""


def check_agreement(rect: Rectification, delivered: Delivered) -> None:
    """Raise InvalidResult, with the place, unless the rectification is one map, and unfolded.

    Raised too where a side's map is mirrored or folded (det J ≤ 0) anywhere in the frame.
    """
    tables = {side: rect.maps(side) for side in SIDES}
    rng = np.random.default_rng(_seed(tables))
    for side in SIDES:
        scored, warp = delivered.side(side), rect.warp(side)
        places = _places(side, warp, rect.size, scored, rng)
        _check_unfolded(scored, places)
        _check_inverse(warp, places)
        _check_jacobian(warp, places)
        _check_table(warp, places, tables[side])
        fine = _at_least_as_fine(warp, rect.size, scored)
        if fine is not None:
            places = _places(side, *fine, scored, rng)
            tables[side] = lookup_table(*fine)
            _check_table(fine[0], places, tables[side])
        _check_distortion(places, scored, tables[side])


def _at_least_as_fine(
    warp: Warp, size: tuple[int, int], delivered: DeliveredSide
) -> tuple[Warp, tuple[int, int]] | None:
    """The image at the resolution of its source where it is coarser: small tables smooth their map."""
    determinants = np.abs(_determinants(delivered.jacobians[delivered.shown]))
    shrunk = float(np.median(determinants)) if len(determinants) else 1.0
    most = LARGEST_TABLE * math.prod(warp.source.size) / math.prod(size)
    scale = math.sqrt(min(1 / shrunk, most)) if shrunk > 0 else 1.0
    if scale <= 1:
        return None
    width, height = (min(LARGEST_SIDE_PX, round(scale * side)) for side in size)
    # The harness's own frame: a target may make anything of `framed`.
    window = Framed(warp.target, -0.5, -0.5, width / size[0], height / size[1])
    return replace(warp, target=window), (width, height)


def _seed(tables: dict[Side, tuple[FloatMap, FloatMap]]) -> int:
    """From every column number of both tables."""
    found = hashlib.sha256()
    for map_x, _ in tables.values():
        found.update(np.ascontiguousarray(map_x).tobytes())
    return int.from_bytes(found.digest()[:8], "little")


@dataclass(frozen=True, eq=False)
class _Places:
    """Places in the frame, and what the map says of them."""

    side: Side
    chosen: NDArray[np.intp] = field(repr=False)
    """[K], numbers of the scored pixels in whose cells they lie."""
    pixels: FloatArray = field(repr=False)
    """[K, 2], source."""
    px_rect: FloatArray = field(repr=False)
    """[K, 2]"""
    by_differences: FloatArray = field(repr=False)
    """[K, 2, 2]"""

    def require(self, true: BoolArray, what: str) -> None:
        """Raise InvalidResult with the first place where it is not so."""
        if not true.all():
            u, v = self.pixels[int(true.argmin())]
            raise InvalidResult(
                f"{what}, near pixel ({u:.0f}, {v:.0f}) of the {self.side} source image and at "
                f"{1 - true.mean():.1%} of the places looked at"
            )


def _places(
    side: Side, warp: Warp, size: tuple[int, int], delivered: DeliveredSide, rng: np.random.Generator
) -> _Places:
    scored = delivered.scored
    chosen = np.flatnonzero(delivered.shown)
    if len(chosen) > PLACES:
        chosen = np.sort(rng.choice(chosen, PLACES, replace=False))
    pixels = scored.redrawn(chosen, rng)
    px_rect, jacobians = differences(warp, pixels, DERIVATIVE_ARM_PX)
    there = in_frame(px_rect, size) & np.isfinite(jacobians).all(axis=(1, 2))
    if len(there) and there.mean() < SHOWN_SHARE:
        raise InvalidResult(
            f"of the places beside {side} pixels that are shown {1 - there.mean():.0%} are not; expected at "
            f"most {1 - SHOWN_SHARE:.0%}: the image has holes"
        )
    return _Places(side, chosen[there], pixels[there], px_rect[there], jacobians[there])


def _check_unfolded(delivered: DeliveredSide, places: _Places) -> None:
    shown = np.flatnonzero(delivered.shown)
    px_rect, jacobians = delivered.px_rect[shown], delivered.jacobians[shown]
    scored = _Places(places.side, shown, delivered.scored.pixels[shown], px_rect, jacobians)
    for where in (scored, places):
        where.require(_determinants(where.by_differences) > 0, "the map is folded or mirrored (det J ≤ 0)")


def _check_inverse(warp: Warp, places: _Places) -> None:
    off = np.linalg.norm(warp.inverse(places.px_rect) - places.pixels, axis=-1)
    places.require(off <= CLOSURE_PX, "inverse(forward(x)) is not x")


def _check_jacobian(warp: Warp, places: _Places) -> None:
    stated = np.asarray(warp.jacobian(places.pixels), dtype=float).reshape(-1, 2, 2)
    off = np.abs(stated - places.by_differences).max(axis=(1, 2))
    scale = np.abs(places.by_differences).max(axis=(1, 2))
    places.require(off <= DERIVATIVE_SHARE * scale, "the stated jacobian is not the derivative of forward")


def _check_table(warp: Warp, places: _Places, table: tuple[FloatMap, FloatMap]) -> None:
    """Entries are compared with the inverse at their own pixels; at the rim of the view one may see more."""
    columns, rows = _nearest(places.px_rect, table[0].shape)
    entry = np.stack([layer[rows, columns] for layer in table], axis=-1).astype(float)
    expected = warp.inverse(np.stack([columns, rows], axis=-1).astype(float))
    step = 1 / np.linalg.svd(places.by_differences, compute_uv=False)[:, 1]  # source pixels to the next entry
    found = np.linalg.norm(entry - places.pixels, axis=-1) <= step + ROUNDING_PX
    if len(found) and found.mean() < SHOWN_SHARE:
        raise InvalidResult(
            f"the {places.side} lookup table lacks {1 - found.mean():.0%} of the places that are mapped "
            f"into it"
        )
    there = np.isfinite(expected).all(axis=-1) & in_frame(expected, warp.source.size)
    near = ~there | (np.abs(entry - expected).max(axis=-1) <= TABLE_PX)
    places.require(near, "the lookup table is not the inverse map")


def _check_distortion(places: _Places, delivered: DeliveredSide, table: tuple[FloatMap, FloatMap]) -> None:
    """The tables' own distortion, by differences between entries two apart, against the scored pixels'."""
    height, width = table[0].shape
    columns, rows = np.rint(places.px_rect).astype(np.intp).T
    inner = (columns > 0) & (columns < width - 1) & (rows > 0) & (rows < height - 1)
    columns, rows, chosen = columns[inner], rows[inner], places.chosen[inner]
    neighbours = [
        np.stack([layer[rows + down, columns + across] for layer in table], axis=-1).astype(float)
        for across, down in ((-1, 0), (1, 0), (0, -1), (0, 1))
    ]
    known = np.all([(entry > OUTSIDE).all(axis=-1) for entry in neighbours], axis=0)
    left, right, above, below = (entry[known] for entry in neighbours)
    inverses = np.stack([right - left, below - above], axis=-1) / 2
    unfolded = np.ones(len(places.pixels), dtype=bool)
    unfolded[np.flatnonzero(inner)[known]] = _determinants(inverses) > 0
    places.require(unfolded, "the lookup table is folded")
    if not len(inverses):  # nothing is shown
        return
    of_table, *_ = log_distortion_parts(np.linalg.inv(inverses).astype(np.float64))
    of_scored, *_ = log_distortion_parts(delivered.jacobians[chosen[known]])
    if abs(of_table - of_scored) > DISTORTION_SHARE * of_table + DISTORTION_FLOOR:
        raise InvalidResult(
            f"the {places.side} lookup table has a log distortion of {of_table:.4g}, and the scored pixels "
            f"beside its entries {of_scored:.4g}: the map is another one there"
        )


def _nearest(px_rect: FloatArray, shape: tuple[int, ...]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Columns and rows of the entries nearest to rectified pixels in the frame."""
    height, width = shape
    columns, rows = np.rint(px_rect).astype(np.intp).T
    return np.clip(columns, 0, width - 1), np.clip(rows, 0, height - 1)


def _determinants(J: FloatArray) -> FloatArray:
    a, b, c, d = entries(J)
    determinant: FloatArray = a * d - b * c
    return determinant
