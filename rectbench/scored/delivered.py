"""What a rectification does to the view of its rig: taken from its lookup tables, as they are delivered."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from rectbench.scored.pieces import FEWEST_PIECES, Pieces, Sheet
from rectbench.scored.view import SHARES, ScoredPixels, ScoredView
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.jacobians import Jacobians, LogStretches
from rectbench.warps.lookup.resampling import SIDES, Side
from rectbench.warps.rectification import Rectification, in_frame

LEAST_KEPT = 100
"""Scored pixels; fewer are all rim."""
HELD_SHARE = 0.95
"""The pieces of a table hold as much of the view as its pixels say, but for rims;"""
CLOSER = (4, 16, 64)
"""where rims are broad, as of a lens squeezed into a corner of its image, so many times as many are
looked at."""


@dataclass(frozen=True, eq=False)
class DeliveredSide:
    """One image's map: where its scored pixels go, and the pieces of its table."""

    scored: ScoredPixels
    px_rect: FloatArray = field(repr=False)
    """[N, 2], where each scored pixel goes; NaN where it goes nowhere."""
    mapped: BoolArray = field(repr=False)
    """[N], whether that is in the frame."""
    shown: BoolArray = field(repr=False)
    """[N], whether the table has it there."""
    delivered: Sheet = field(repr=False)
    """The table that the user gets."""
    pieces: Pieces = field(repr=False)
    """Of that table; of a finer one where it is coarse."""

    @classmethod
    def of(cls, rect: Rectification, side: Side, scored: ScoredPixels) -> DeliveredSide:
        """That of one side."""
        warp = rect.warp(side)
        px_rect = warp.forward(scored.pixels)
        delivered = Sheet(warp, rect.size, rect.maps(side))
        pieces, mapped = Pieces.of(delivered), in_frame(px_rect, rect.size)
        shown = mapped.copy()
        shown[mapped] = pieces.hold(scored.pixels[mapped], px_rect[mapped])
        found = cls(scored, px_rect, mapped, shown, delivered, pieces)
        for fewest in (factor * FEWEST_PIECES for factor in CLOSER):
            looked_at = found.pieces
            if found.held >= HELD_SHARE or looked_at.count < FEWEST_PIECES or looked_at.folded.any():
                break
            found = replace(found, pieces=Pieces.of(delivered, fewest))
        return found

    @property
    def kept(self) -> int:
        """How many of the scored pixels, from the middle outwards, are shown before one is not."""
        return len(self.shown) if self.shown.all() else int(self.shown.argmin())

    @cached_property
    def held(self) -> float:
        """What the pieces hold of the view that is kept, as a share of that; of too little of it, all."""
        if self.kept < LEAST_KEPT:
            return 1.0
        kept = self.kept / len(self.shown)
        return float(self.shares(kept).sum()) / kept

    def shares(self, share: float) -> FloatArray:
        """[M], what each piece holds of A_s, as shares of the view: in all s, where all of it is shown."""
        scored = self.scored
        areas = self.pieces.areas_within(scored.middle, scored.edge(share) * scored.reach)
        return areas * self._outside_cones / scored.area_px

    @cached_property
    def _outside_cones(self) -> FloatArray:
        """[M], what share of each piece lies outside the cones that are not scored; by its extents."""
        camera = self.scored.camera
        if camera.blind is None:
            return np.ones(self.pieces.count)
        middles, axis = self.pieces.middles.T, np.array(camera.blind.axis)
        along = camera.whole.unproject(middles)[0] @ axis
        by_px = axis @ camera.whole.unproject_jacobian(middles)
        reach = np.abs(by_px * self.pieces.halves.T).sum(axis=-1)
        with np.errstate(invalid="ignore", divide="ignore"):
            inwards = math.cos(math.radians(camera.blind.within_deg)) - np.abs(along)
            shares: FloatArray = np.clip(inwards / (2 * reach) + 0.5, 0.0, 1.0)
        return np.nan_to_num(shares, nan=1.0)


@dataclass(frozen=True, eq=False)
class Delivered:
    """The maps of both images on a rig's view.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> found = rb.Delivered.of(rb.rectify(rig, method="conventional"), rb.ScoredView.of(rig))
    >>> found.keeps(0.4), found.keeps(0.95)
    (True, False)
    >>> round(found.log_distortion(0.4), 2), found.log_distortion(0.95)
    (0.24, nan)
    """

    left: DeliveredSide
    right: DeliveredSide

    @classmethod
    def of(cls, rect: Rectification, view: ScoredView) -> Delivered:
        """What `rect` does on the view of its rig."""
        return cls(*(DeliveredSide.of(rect, side, view.side(side)) for side in SIDES))

    def side(self, side: Side) -> DeliveredSide:
        """The map of one image, by its name."""
        return self.left if side == "left" else self.right

    @cached_property
    def shown(self) -> Jacobians:
        """The derivatives of all pieces that are shown of the view."""
        return self.within(1.0)

    @property
    def kept_share(self) -> float:
        """The largest share s of the view such that all of A_s is shown, in both images."""
        sides = (self.left, self.right)
        return min((side.kept / len(side.shown) for side in sides if len(side.shown)), default=0.0)

    def keeps(self, share: float) -> bool:
        """Whether all of A_s is shown, in both images."""
        sides = (self.left, self.right)
        return all(0 < side.scored.count(share) <= side.kept for side in sides)

    def within(self, share: float) -> Jacobians:
        """The derivatives of what is shown of A_s, weighted by the shares of the view that pieces hold."""
        J, weights = [], []
        for side in (self.left, self.right):
            shares = side.shares(share)
            J.append(side.pieces.jacobians[shares > 0])
            weights.append(shares[shares > 0])
        return Jacobians(*J, *weights)

    def log_distortion(self, share: float) -> float:
        """That on A_s; NaN where the method does not show all of it."""
        if not self.keeps(share):
            return math.nan
        weights = np.concatenate([side.shares(share) for side in (self.left, self.right)])
        return self.log_stretches.distortion(weights)[0]

    @cached_property
    def log_stretches(self) -> LogStretches:
        """Of all pieces, left then right."""
        return LogStretches.of(np.concatenate([side.pieces.jacobians for side in (self.left, self.right)]))

    @property
    def shares_kept(self) -> tuple[float, ...]:
        """Those of `SHARES` that are kept."""
        return tuple(share for share in SHARES if self.keeps(share))
