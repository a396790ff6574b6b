"""Whether all that a rectification says of itself is one map: forward, inverse, derivative and tables.

It is asked at places that no method can foresee: they follow from a digest of the lookup tables, so that no
table can be made to fit them. Where the tables hold another distortion than the scored pixels do, the map
was made for these.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidResult
from rectbench.scored.delivered import Delivered, DeliveredSide, differences
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.jacobians import entries, log_distortion_parts
from rectbench.warps.lookup.resampling import SIDES, Side
from rectbench.warps.lookup.tables import OUTSIDE, FloatMap
from rectbench.warps.rectification import Rectification, in_frame
from rectbench.warps.warp import Warp

PLACES = 1_500
"""An image, each in the cell of a scored pixel."""
TABLE_PX = 0.01
"""A table's entry is this near to the inverse map; float32 keeps 0.001 px of the largest image."""
CLOSURE_PX = 1e-3
"""inverse(forward(x)) is this near to x."""
DERIVATIVE_SHARE, DERIVATIVE_ARM_PX = 1e-3, 5e-3
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
        _check_side(side, rect, delivered.side(side), tables[side], rng)


def _seed(tables: dict[Side, tuple[FloatMap, FloatMap]]) -> int:
    """From every column number of both tables."""
    found = hashlib.sha256()
    for map_x, _ in tables.values():
        found.update(np.ascontiguousarray(map_x).tobytes())
    return int.from_bytes(found.digest()[:8], "little")


@dataclass(frozen=True, eq=False)
class _Places:
    """Places in the frame, and what the map says of them."""

    method_side: Side
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
                f"{what}, near pixel ({u:.0f}, {v:.0f}) of the {self.method_side} source image and at "
                f"{1 - true.mean():.1%} of the places looked at"
            )


def _check_side(
    side: Side,
    rect: Rectification,
    delivered: DeliveredSide,
    table: tuple[FloatMap, FloatMap],
    rng: np.random.Generator,
) -> None:
    warp = rect.warp(side)
    places = _places(side, warp, rect.size, delivered, rng)
    shown = np.flatnonzero(delivered.shown)
    scored = _Places(
        side, shown, delivered.scored.pixels[shown], delivered.px_rect[shown], delivered.jacobians[shown]
    )
    for where in (scored, places):
        where.require(_determinants(where.by_differences) > 0, "the map is folded or mirrored (det J ≤ 0)")
    _check_inverse(warp, places)
    _check_jacobian(warp, places)
    _check_table(warp, places, table)
    _check_distortion(side, places, delivered, table)


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
    return _Places(side, chosen[there], pixels[there], px_rect[there], jacobians[there])


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
    there = np.isfinite(expected).all(axis=-1) & in_frame(expected, warp.source.size)
    near = ~there | (np.abs(entry - expected).max(axis=-1) <= TABLE_PX)
    places.require(near, "the lookup table is not the inverse map")


def _check_distortion(
    side: Side, places: _Places, delivered: DeliveredSide, table: tuple[FloatMap, FloatMap]
) -> None:
    """The tables' own distortion, by differences between entries two apart, against the scored pixels'."""
    columns, rows = _nearest(places.px_rect, table[0].shape, margin=1)
    neighbours = [
        np.stack([layer[rows + down, columns + across] for layer in table], axis=-1).astype(float)
        for across, down in ((-1, 0), (1, 0), (0, -1), (0, 1))
    ]
    known = np.all([(entry > OUTSIDE).all(axis=-1) for entry in neighbours], axis=0)
    left, right, above, below = (entry[known] for entry in neighbours)
    inverses = np.stack([right - left, below - above], axis=-1) / 2
    known[known] &= _determinants(inverses) > 0
    inverses = inverses[_determinants(inverses) > 0]
    if not len(inverses):
        return
    of_table, *_ = log_distortion_parts(np.linalg.inv(inverses).astype(np.float64))
    of_scored, *_ = log_distortion_parts(delivered.jacobians[places.chosen[known]])
    if abs(of_table - of_scored) > DISTORTION_SHARE * of_table + DISTORTION_FLOOR:
        raise InvalidResult(
            f"the {side} lookup table has a log distortion of {of_table:.4g}, and the scored pixels beside "
            f"its entries {of_scored:.4g}: the map is another one there"
        )


def _nearest(
    px_rect: FloatArray, shape: tuple[int, ...], margin: int = 0
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Columns and rows of the entries nearest to rectified pixels, `margin` entries from the edge."""
    height, width = shape
    whole = np.rint(px_rect).astype(np.intp)
    columns = np.clip(whole[:, 0], min(margin, width - 1), max(0, width - 1 - margin))
    rows = np.clip(whole[:, 1], min(margin, height - 1), max(0, height - 1 - margin))
    return columns, rows


def _determinants(J: FloatArray) -> FloatArray:
    a, b, c, d = entries(J)
    determinant: FloatArray = a * d - b * c
    return determinant
