"""Whether all that a rectification says of itself is one map: forward, inverse, derivative and tables.

It is asked at places that follow from a digest of what is scored, the pieces of the lookup tables: none can
be made to fit them.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidResult
from rectbench.scored.delivered import HELD_SHARE, Delivered, DeliveredSide
from rectbench.scored.differences import differences, off_derivative
from rectbench.scored.pieces import Pieces, Sheet
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.jacobians import LogStretches, entries, singular_values
from rectbench.warps.lookup.resampling import SIDES, Side
from rectbench.warps.rectification import Rectification, in_frame
from rectbench.warps.warp import Warp

PLACES = 1_500
"""An image, each in the cell of a scored pixel."""
TABLE_PX = 0.01
"""A table's entry is this near to the inverse map; float32 keeps 0.001 px of the largest image."""
SHOWN_SHARE = 0.5
"""Of the places beside shown pixels as many are shown; the rest lies at edges."""
ENTRY_SHARE = 0.9
"""Of these places as many have the entry that the inverse map has there."""
FOUND_SHARE = 0.99
"""Of the pixels that are mapped into the frame as many are found in the table."""
ROUNDING_PX = 0.1
CLOSURE_PX = 1e-3
"""inverse(forward(x)) is this near to x."""
DERIVATIVE_SHARE, DERIVATIVE_ARM_PX = 5e-3, 5e-3
"""The stated derivative is this near to differences over so short an arm, by the largest entry there,"""
EDGE_SHARE = 0.01
"""but for as many places at the end of a lens's domain, where it has no bound, and differences no limit."""
DISTORTION_SHARE, DISTORTION_FLOOR = 0.02, 2e-3
"""A table's log distortion between neighbouring entries is this near to that between distant ones."""
LEAST_PIECES = 1_000
"""By fewer, of the finest table that is feasible, nobody can tell what a map does to the image."""
FOLDED = "the map is folded or mirrored (det J ≤ 0)"


def check_agreement(rect: Rectification, delivered: Delivered) -> None:
    """Raise InvalidResult, with the place, unless the rectification is one map, and unfolded.

    Raised too where a side's map is mirrored or folded (det J ≤ 0) anywhere in the frame.
    """
    rng = np.random.default_rng(_seed(delivered))
    for side in SIDES:
        scored, warp = delivered.side(side), rect.warp(side)
        _check_enough(side, scored.pieces)
        _check_unfolded(side, scored.pieces)
        _check_holes(side, scored)
        places = _places(side, warp, rect.size, scored, rect.turn_px, rng)
        places.require(_determinants(places.by_differences) > 0, FOLDED)
        _check_inverse(warp, places)
        _check_jacobian(warp, places, rect.turn_px)
        _check_table(places, scored.delivered)
        sheet = scored.pieces.sheet
        if sheet.scale != (1.0, 1.0):
            turn_px = None if rect.turn_px is None else rect.turn_px * sheet.scale[1]
            places = _places(side, sheet.warp, sheet.size, scored, turn_px, rng)
            _check_table(places, sheet)
        _check_distortion(places, scored.pieces)


def _seed(delivered: Delivered) -> int:
    """From every entry that is scored: who changes a score changes where it is looked at."""
    found = hashlib.sha256()
    for side in SIDES:
        found.update(np.ascontiguousarray(delivered.side(side).pieces.jacobians).tobytes())
    return int.from_bytes(found.digest()[:8], "little")


def _check_enough(side: Side, pieces: Pieces) -> None:
    if 0 < pieces.count < LEAST_PIECES:
        width, height = pieces.sheet.size
        raise InvalidResult(
            f"the {side} image shows the source in {pieces.count} places of a table of "
            f"{width}x{height} entries; expected a frame that the image fills, to be scored"
        )


def _check_unfolded(side: Side, pieces: Pieces) -> None:
    folded = np.flatnonzero(pieces.folded)
    if len(folded):
        u, v = pieces.middles[:, folded[0]]
        raise InvalidResult(
            f"the {side} lookup table is folded or mirrored, near pixel ({u:.0f}, {v:.0f}) of the source "
            f"image and in {len(folded) / pieces.count:.1%} of its pieces"
        )


def _check_holes(side: Side, delivered: DeliveredSide) -> None:
    """What is mapped into the frame is in the table, and what pixels are shown have all between them."""
    mapped, shown = delivered.mapped.sum(), delivered.shown.sum()
    if shown < FOUND_SHARE * mapped:
        raise InvalidResult(
            f"the {side} lookup table shows something else at {1 - shown / mapped:.0%} of the pixels that "
            f"are mapped into it"
        )
    if delivered.held < HELD_SHARE:
        raise InvalidResult(
            f"the {side} lookup table shows {delivered.held:.0%} of the view that the pixels looked at say: "
            f"the image has holes"
        )


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
    side: Side,
    warp: Warp,
    size: tuple[int, int],
    delivered: DeliveredSide,
    turn_px: float | None,
    rng: np.random.Generator,
) -> _Places:
    scored = delivered.scored
    chosen = np.flatnonzero(delivered.shown)
    if len(chosen) > PLACES:
        chosen = np.sort(rng.choice(chosen, PLACES, replace=False))
    pixels = scored.redrawn(chosen, rng)
    px_rect, jacobians = differences(warp, pixels, DERIVATIVE_ARM_PX, turn_px)
    there = in_frame(px_rect, size) & np.isfinite(jacobians).all(axis=(1, 2))
    if len(there) and there.mean() < SHOWN_SHARE:
        raise InvalidResult(
            f"of the places beside {side} pixels that are shown {1 - there.mean():.0%} are not; expected at "
            f"most {1 - SHOWN_SHARE:.0%}: the image has holes"
        )
    return _Places(side, chosen[there], pixels[there], px_rect[there], jacobians[there])


def _check_inverse(warp: Warp, places: _Places) -> None:
    off = np.linalg.norm(warp.inverse(places.px_rect) - places.pixels, axis=-1)
    places.require(off <= CLOSURE_PX, "inverse(forward(x)) is not x")


def _check_jacobian(warp: Warp, places: _Places, turn_px: float | None) -> None:
    stated = np.asarray(warp.jacobian(places.pixels), dtype=float).reshape(-1, 2, 2)
    off = np.abs(stated - places.by_differences).max(axis=(1, 2))
    allowed = DERIVATIVE_SHARE * np.abs(places.by_differences).max(axis=(1, 2))
    bent = ~(off <= allowed)
    off[bent] = off_derivative(warp, places.pixels[bent], stated[bent], DERIVATIVE_ARM_PX).max(axis=1)
    at_edge = off > allowed
    _, closer = differences(warp, places.pixels[at_edge], DERIVATIVE_ARM_PX / 2, turn_px)
    unsettled = np.abs(closer - places.by_differences[at_edge]).max(axis=(1, 2)) > allowed[at_edge] / 2
    at_edge[at_edge] = unsettled
    if at_edge.sum() <= EDGE_SHARE * len(at_edge):
        off[at_edge] = 0.0
    places.require(off <= allowed, "the stated jacobian is not the derivative of forward")


def _check_table(places: _Places, sheet: Sheet) -> None:
    """Entries are compared with the inverse at their own pixels, which may lie beyond the rim of the view."""
    columns, rows = _nearest(places.px_rect, sheet.table[0].shape)
    entry = sheet.entries(columns, rows)
    expected = sheet.warp.inverse(np.stack([columns, rows], axis=-1).astype(float))
    _, small = singular_values(*entries(places.by_differences), np)
    step = 1 / small  # source pixels to the next entry
    there = np.isfinite(expected).all(axis=-1) & in_frame(expected, sheet.warp.source.size)
    found = ~there | (np.linalg.norm(entry - places.pixels, axis=-1) <= step + ROUNDING_PX)
    if len(found) and found.mean() < ENTRY_SHARE:
        raise InvalidResult(
            f"the {places.side} lookup table lacks {1 - found.mean():.0%} of the places that are mapped "
            f"into it"
        )
    near = ~there | (np.abs(entry - expected).max(axis=-1) <= TABLE_PX)
    places.require(near, "the lookup table is not the inverse map")


def _check_distortion(places: _Places, pieces: Pieces) -> None:
    """The table's own distortion, by differences between entries two apart, against that of its pieces.

    Pieces of one entry have nothing between their corners.
    """
    width, height = pieces.sheet.size
    columns, rows = np.rint(places.px_rect).astype(np.intp).T
    piece = pieces.at(places.px_rect)
    inner = (piece >= 0) & (columns > 0) & (columns < width - 1) & (rows > 0) & (rows < height - 1)
    columns, rows, piece = columns[inner], rows[inner], piece[inner]
    neighbours = [
        pieces.sheet.entries(columns + across, rows + down)
        for across, down in ((-1, 0), (1, 0), (0, -1), (0, 1))
    ]
    known = np.all(np.isfinite(neighbours), axis=(0, 2))
    left, right, above, below = (entry[known] for entry in neighbours)
    inverses = np.stack([right - left, below - above], axis=-1) / 2
    unfolded = np.ones(len(places.pixels), dtype=bool)
    unfolded[np.flatnonzero(inner)[known]] = _determinants(inverses) > 0
    places.require(unfolded, "the lookup table is folded")
    piece = piece[known]
    spans = (pieces.entries_across[:, piece] > 1).any(axis=0)
    if not spans.any():
        return
    between_entries = np.linalg.inv(inverses[spans]) / np.array(pieces.sheet.scale)[:, None]
    of_entries, *_ = LogStretches.of(between_entries).distortion()
    of_pieces, *_ = LogStretches.of(pieces.jacobians[piece[spans]]).distortion()
    if abs(of_entries - of_pieces) > DISTORTION_SHARE * of_entries + DISTORTION_FLOOR:
        raise InvalidResult(
            f"the {places.side} lookup table has a log distortion of {of_entries:.4g} between entries two "
            f"apart, and {of_pieces:.4g} between those farther apart: the map is another one there"
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
