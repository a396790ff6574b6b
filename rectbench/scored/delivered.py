"""What a rectification does at the scored pixels: the derivative of the map itself, as it is shown."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rectbench.scored.view import ARM_PX, SHARES, ScoredPixels, ScoredView
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.jacobians import Jacobians
from rectbench.warps.lookup.resampling import Side
from rectbench.warps.rectification import Rectification, in_frame
from rectbench.warps.warp import Warp

CROSS = np.array([[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])


@dataclass(frozen=True, eq=False)
class DeliveredSide:
    """One image's map at its scored pixels."""

    scored: ScoredPixels
    px_rect: FloatArray = field(repr=False)
    """[N, 2], where each goes; NaN where it goes nowhere."""
    jacobians: FloatArray = field(repr=False)
    """[N, 2, 2], differences over one source pixel; NaN where the pixel is not in the frame that is shown."""

    @classmethod
    def of(cls, warp: Warp, scored: ScoredPixels, size: tuple[int, int]) -> DeliveredSide:
        """That of a warp into a frame of `size`."""
        px_rect, jacobians = differences(warp, scored.pixels)
        jacobians[~in_frame(px_rect, size)] = np.nan
        return cls(scored, px_rect, jacobians)

    @property
    def shown(self) -> BoolArray:
        """[N]"""
        known: BoolArray = np.all(np.isfinite(self.jacobians), axis=(1, 2))
        return known

    @property
    def kept(self) -> int:
        """How many of the scored pixels, from the middle outwards, are shown before one is not."""
        shown = self.shown
        return len(shown) if shown.all() else int(shown.argmin())


@dataclass(frozen=True, eq=False)
class Delivered:
    """The maps of both images at the scored pixels of a rig's view.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> found = rb.Delivered.of(rb.rectify(rig, method="conventional"), rb.ScoredView.of(rig))
    >>> found.keeps(0.4), found.keeps(0.95)
    (True, False)
    """

    left: DeliveredSide
    right: DeliveredSide

    @classmethod
    def of(cls, rect: Rectification, view: ScoredView) -> Delivered:
        """What `rect` does on the view of its rig."""
        return cls(
            DeliveredSide.of(rect.left, view.left, rect.size),
            DeliveredSide.of(rect.right, view.right, rect.size),
        )

    def side(self, side: Side) -> DeliveredSide:
        """The map of one image, by its name."""
        return self.left if side == "left" else self.right

    @property
    def shown(self) -> Jacobians:
        """The derivatives at all scored pixels, NaN where one is not shown."""
        return Jacobians(self.left.jacobians, self.right.jacobians)

    @property
    def kept_share(self) -> float:
        """The largest share s of the view such that all of A_s is shown, in both images."""
        sides = (self.left, self.right)
        return min((side.kept / len(side.jacobians) for side in sides if len(side.jacobians)), default=0.0)

    def keeps(self, share: float) -> bool:
        """Whether all of A_s is shown, in both images."""
        sides = (self.left, self.right)
        return all(0 < side.scored.count(share) <= side.kept for side in sides)

    def within(self, share: float) -> Jacobians:
        """The derivatives on A_s."""
        left, right = (side.jacobians[: side.scored.count(share)] for side in (self.left, self.right))
        return Jacobians(left, right)

    @property
    def shares_kept(self) -> tuple[float, ...]:
        """Those of `SHARES` that are kept."""
        return tuple(share for share in SHARES if self.keeps(share))


def differences(warp: Warp, pixels: FloatArray, arm_px: float = ARM_PX) -> tuple[FloatArray, FloatArray]:
    """Where pixels [N, 2] go, [N, 2], and the derivative there by differences over two arms, [N, 2, 2].

    What counts is the map that users get, whatever it says of its own derivative. At the end of a map's
    domain the difference is over the one arm that there is.
    """
    middle, *arms = np.moveaxis(warp.forward(pixels[:, None] + arm_px * CROSS), 1, 0)
    columns = []
    for ends in (arms[:2], arms[2:]):
        known = [np.isfinite(arm) for arm in ends]
        first, last = (np.where(there, arm, middle) for there, arm in zip(known, ends, strict=True))
        with np.errstate(invalid="ignore", divide="ignore"):
            columns.append((last - first) / (arm_px * (known[0].astype(float) + known[1])))
    return middle, np.stack(columns, axis=-1)
