"""No map gains by being another one where it is looked at: a cheat is invalid, or no better than its twin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench.scored import Delivered, ScoredView, check_agreement
from rectbench.scored.agreement import TABLE_PX
from rectbench.scored.differences import differences, off_derivative
from rectbench.scored.pieces import Pieces, Sheet
from rectbench.types import FloatArray
from rectbench.warps.jacobians import LogStretches
from tests.rigs_for_tests import rig

RIG = rb.load_rig("sony-as200v").scaled(1 / 3)
HONEST = "abraham"


def scored(rect: rb.Rectification) -> float:
    """The log distortion that ranks; infinite where it has none. Raises InvalidResult as a cell would."""
    delivered = Delivered.of(rect, ScoredView.of(rect.rig))
    check_agreement(rect, delivered)
    return delivered.log_distortion(0.95) if delivered.keeps(0.95) else math.inf


def with_warps(rect: rb.Rectification, changed: Callable[[rb.Warp], rb.Warp]) -> rb.Rectification:
    return replace(rect, left=changed(rect.left), right=changed(rect.right))


@dataclass(frozen=True, eq=False)
class Discs(rb.Warp):
    """Another map within small discs about some pixels: there the image is moved, and not stretched."""

    centres: Any = None
    radius_px: float = 0.02

    def forward(self, px: Any) -> FloatArray:
        px = np.asarray(px, dtype=float)
        flat = px.reshape(-1, 2)
        moved = super().forward(flat)
        off, which = self._nearest(flat)
        inside = off <= self.radius_px
        moved[inside] = (
            super().forward(self.centres[which[inside]]) + flat[inside] - self.centres[which[inside]]
        )
        return moved.reshape(px.shape)

    def jacobian(self, px: Any) -> FloatArray:
        px = np.asarray(px, dtype=float)
        J = super().jacobian(px)
        inside = self._nearest(px.reshape(-1, 2))[0].reshape(px.shape[:-1]) <= self.radius_px
        J[inside] = np.eye(2)
        return J

    def _nearest(self, px: FloatArray) -> tuple[FloatArray, Any]:
        from scipy.spatial import cKDTree

        return cKDTree(self.centres).query(px)  # type: ignore[no-any-return]


def with_discs(centres: dict[str, FloatArray], radius_px: float = 0.02) -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    sides = {
        side: Discs(warp.source, warp.R_rect_cam, warp.target, centres[side], radius_px)
        for side, warp in (("left", rect.left), ("right", rect.right))
    }
    return replace(rect, **sides)


def discs_at_known_pixels() -> rb.Rectification:
    return with_discs({side: rb.evaluation_pixels(getattr(RIG, side)) for side in ("left", "right")})


def discs_at_scored_pixels() -> rb.Rectification:
    view = ScoredView.of(RIG)
    return with_discs({side: view.side(side).pixels for side in ("left", "right")}, 0.6)


def discs_at_some_scored_pixels() -> rb.Rectification:
    view = ScoredView.of(RIG)
    return with_discs({side: view.side(side).pixels[::4] for side in ("left", "right")}, 0.6)


def cropped() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return rb.framed(rect, rb.Framing(fov_deg=(34, 34)))


class FalseJacobian(rb.Warp):
    def jacobian(self, px: Any) -> FloatArray:
        return np.broadcast_to(np.eye(2), (*np.shape(px)[:-1], 2, 2)).copy()


def false_jacobian() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return with_warps(rect, lambda w: FalseJacobian(w.source, w.R_rect_cam, w.target))


@dataclass(frozen=True)
class Wave(rb.Profile):
    """A function that falls within, and says that it rises."""

    low: float = -1.6
    high: float = 1.6
    constants = {"low": -1.6, "high": 1.6}  # noqa: RUF012

    def value(self, c: Any, angle: Any, xp: Any) -> Any:
        return 200.0 * (angle + 0.3 * xp.sin(8.0 * angle)) + 320.0

    def angle(self, c: Any, value: Any, xp: Any) -> Any:
        return (value - 320.0) / 200.0


def folded() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return with_warps(rect, lambda w: replace(w, target=rb.Epipolar(Wave(), w.target.v)))


class OtherTables(rb.Rectification):
    def maps(self, side: Any) -> Any:
        map_x, map_y = super().maps(side)
        return map_x, map_y + np.float32(0.5)


def other_tables() -> rb.Rectification:
    rect = rb.rectify(RIG, method="local-homography")
    return OtherTables(rect.rig, rect.left, rect.right, rect.size)


class SaysThatItShowsAll(rb.Warp):
    """Whatever is asked for more than a few pixels, as the scorer does, is put into the frame."""

    def forward(self, px: Any) -> FloatArray:
        there = super().forward(px)
        return np.clip(there, 10.0, 80.0) if there.size > 15_000 else there


def says_that_it_shows_all() -> rb.Rectification:
    return with_warps(cropped(), lambda w: SaysThatItShowsAll(w.source, w.R_rect_cam, w.target))


class OtherCorners(rb.Rectification):
    """Tables whose entries, where the scored pieces meet, are those of a map with no distortion at all."""

    def maps(self, side: Any) -> Any:
        map_x, map_y = super().maps(side)
        pieces = Pieces.of(Sheet(self.warp(side), self.size, (map_x, map_y)))
        corners = np.ix_(pieces.rows, pieces.columns)
        map_x[corners], map_y[corners] = np.meshgrid(0.9 * pieces.columns, 0.9 * pieces.rows)
        return map_x, map_y


def other_corners() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return OtherCorners(rect.rig, rect.left, rect.right, rect.size)


class OtherInverse(rb.Warp):
    def inverse(self, px_rect: Any) -> FloatArray:
        return super().inverse(px_rect) + 0.01


def other_inverse() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return with_warps(rect, lambda w: OtherInverse(w.source, w.R_rect_cam, w.target))


def mirrored() -> rb.Rectification:
    """Upside down: consistent, and no image that anybody wants."""
    rect = rb.rectify(RIG, method="conventional")
    _, height = rect.size
    flip = np.array([[1, 0, 0], [0, -1, height - 1], [0, 0, 1.0]])
    return with_warps(rect, lambda w: replace(w, target=rb.Perspective(flip @ w.target.matrix)))


class Dots(Discs):
    """Nothing is shown but discs about the scored pixels, and there the image is moved alone."""

    def forward(self, px: Any) -> FloatArray:
        px = np.asarray(px, dtype=float)
        flat = px.reshape(-1, 2)
        shown = self._nearest(flat)[0] <= self.radius_px
        return np.where(shown[:, None], flat + 10.0, np.nan).reshape(px.shape)


def dots() -> rb.Rectification:
    view, rect = ScoredView.of(RIG), rb.rectify(RIG, method=HONEST)
    sides = {}
    for side in ("left", "right"):
        warp = rect.warp(side)
        sides[side] = Dots(warp.source, warp.R_rect_cam, warp.target, view.side(side).pixels, 0.51)
    return replace(rect, **sides)


@dataclass(frozen=True, eq=False)
class OtherFrame(rb.Target):
    """Smaller than the source, and where it is looked at more closely it is the source itself."""

    target: rb.Target

    @property
    def constants(self) -> Any:
        return {"target": self.target.constants}

    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Any) -> Any:
        u, v, ok = self.target.project_formula(c.target, x, y, z, xp)
        return 0.9 * u, 0.9 * v, ok

    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Any) -> Any:
        return self.target.unproject_formula(c.target, u, v, xp)

    def framed(self, left: float, top: float, across: float, down: float) -> rb.Target:
        return self.target


def other_frame() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return with_warps(rect, lambda w: replace(w, target=OtherFrame(w.target)))


def postage_stamp() -> rb.Rectification:
    """A large frame in which the image is a few pixels wide."""
    rect = rb.rectify(RIG, method=HONEST)
    width, height = rect.size
    return rect.windowed((-60.0 * width, -60.0 * height), (120.0 * width, 120.0 * height), (1500, 1500))


FOUND_OUT = {
    postage_stamp: "the left image shows the source in .* places of a table of 1500x1500 entries",
    dots: "the left lookup table shows something else at 100% of the pixels",
    other_frame: "the left lookup table shows something else at",
    says_that_it_shows_all: "the left lookup table shows something else at",
    discs_at_scored_pixels: "the map is folded or mirrored|is not x, near pixel",
    discs_at_some_scored_pixels: "the map is folded or mirrored|is not x, near pixel",
    false_jacobian: "the stated jacobian is not the derivative of forward, near pixel",
    folded: "the left lookup table shows something else at",
    other_tables: "lookup table is (folded or mirrored|not the inverse map), near pixel",
    other_corners: "the left lookup table",
    other_inverse: r"inverse\(forward\(x\)\) is not x, near pixel",
    mirrored: "the left lookup table is folded or mirrored, near pixel",
}


@pytest.mark.parametrize("cheat", FOUND_OUT, ids=lambda cheat: cheat.__name__)
def test_a_map_that_contradicts_itself_is_invalid(cheat: Callable[[], rb.Rectification]) -> None:
    with pytest.raises(rb.InvalidResult, match=FOUND_OUT[cheat]) as refusal:
        scored(cheat())
    assert "\n" not in str(refusal.value)


@dataclass(frozen=True, eq=False)
class Nudged(rb.Warp):
    """Nudged by less than any check sees, so that differences between known places have less distortion."""

    amount_px: float = 9e-4

    def forward(self, px: Any) -> FloatArray:
        px = np.asarray(px, dtype=float)
        return super().forward(px) - self.amount_px * np.sign(px - np.rint(px))


def nudged() -> rb.Rectification:
    rect = rb.rectify(RIG, method=HONEST)
    return with_warps(rect, lambda w: Nudged(w.source, w.R_rect_cam, w.target))


@pytest.mark.parametrize("cheat", [discs_at_known_pixels, nudged], ids=lambda cheat: cheat.__name__)
def test_what_is_done_where_nobody_looks_gains_nothing(cheat: Callable[[], rb.Rectification]) -> None:
    rect = cheat()
    honest = Delivered.of(rb.rectify(RIG, method=HONEST), ScoredView.of(RIG)).log_distortion(0.95)
    assert Delivered.of(rect, ScoredView.of(RIG)).log_distortion(0.95) == honest


def test_entries_moved_a_little_where_pieces_meet_gain_nothing() -> None:
    """By as much as the table may be off its map, each towards what would be no distortion."""
    rect = rb.rectify(RIG, method=HONEST)
    sheet = Sheet(rect.left, rect.size, rect.maps("left"))
    pieces = Pieces.of(sheet)
    honest, *_ = LogStretches.of(pieces.jacobians).distortion(pieces.areas_px)
    corners = np.ix_(pieces.rows, pieces.columns)
    for layer, wanted in zip(sheet.table, np.meshgrid(pieces.columns, pieces.rows), strict=True):
        layer[corners] += np.float32(TABLE_PX) * np.sign(0.9 * wanted - layer[corners])
    moved = Pieces.of(sheet)
    assert LogStretches.of(moved.jacobians).distortion(moved.areas_px)[0] > 0.999 * honest


def test_who_crops_is_not_ranked() -> None:
    assert scored(cropped()) == math.inf


@dataclass(frozen=True, eq=False)
class SaysThatItShowsTheRim(rb.Warp):
    """A few pixels that the frame cuts off are put to its edge, where many are asked for at once."""

    frame: Any = None

    def forward(self, px: Any) -> FloatArray:
        there = super().forward(px)
        return np.clip(there, 0, self.frame) if there.size > 15_000 else there


@pytest.mark.parametrize("coverage", [0.99, 0.94])
def test_who_crops_a_little_and_denies_it_is_not_ranked(coverage: float) -> None:
    rect = rb.framed(rb.rectify(RIG, method=HONEST), rb.Framing(coverage=coverage))
    frame = np.array(rect.size) - 1.0
    denied = with_warps(rect, lambda w: SaysThatItShowsTheRim(w.source, w.R_rect_cam, w.target, frame))
    delivered = Delivered.of(denied, ScoredView.of(RIG))
    assert delivered.left.mapped.all()
    assert math.isnan(delivered.log_distortion(1.0))


@pytest.mark.parametrize("width", [64, 640])
@pytest.mark.parametrize("name", ["t265", "canon-8mm", "bumblebee2", "tumvi", "ocam"])
@pytest.mark.parametrize("method", ["conventional", "abraham", "hartley", "fusiello", "local-homography"])
def test_honest_methods_agree_with_themselves(method: str, name: str, width: int) -> None:
    pair = rb.load_rig(name)
    pair = pair.scaled(width / pair.left.width)
    try:
        rect = rb.rectify(pair, method=method)
    except rb.Unsupported:
        return
    check_agreement(rect, Delivered.of(rect, ScoredView.of(pair)))
    small = rb.framed(rect, rb.Framing(focal_px=10.0))
    check_agreement(small, Delivered.of(small, ScoredView.of(pair)))


def test_where_a_map_bends_its_derivative_is_that_of_a_side() -> None:
    rect = rb.rectify(rig(), "multi-pinhole", pieces=2)
    beta = rb.view_angles(rect.rig).beta
    gamma, seam = np.linspace(-0.6, 0.6, 50), (beta.low + beta.high) / 2
    rays = np.stack([np.sin(gamma), np.cos(gamma) * np.sin(seam), np.cos(gamma) * np.cos(seam)], axis=-1)
    on_seam, _ = rect.left.source.project(rays @ rect.R_rect_left)
    pixels = np.add(on_seam, [0.0, 1e-3])  # nearer to the seam than an arm
    stated = rect.left.jacobian(pixels)
    _, across_it = differences(rect.left, pixels, 5e-3)
    assert np.abs(stated - across_it).max() > 0.1
    assert off_derivative(rect.left, pixels, stated, 5e-3).max() < 1e-4
    assert off_derivative(rect.left, pixels, 1.02 * stated, 5e-3).min(axis=0).max() > 5e-3


def squeezed(focal_px: float, size: tuple[int, int], angle_deg: float) -> rb.Camera:
    """A pinhole whose image, all but a few pixels in the middle, is its outermost degrees."""
    middle = {"cx": (size[0] - 1) / 2, "cy": (size[1] - 1) / 2}
    return rb.Camera("pinhole", size, {"fx": focal_px, "fy": focal_px, **middle}, angle_deg)


TINY = {
    "rims as broad as the picture": (squeezed(48.0, (338, 256), 74.0), squeezed(7.0, (402, 212), 88.0)),
    "all of it in a few entries": (
        rb.Camera("stereographic", (430, 273), {"fx": 150, "fy": 148, "cx": 215, "cy": 137}, 71.0),
        squeezed(4.0, (176, 96), 87.4),
    ),
    "folded guesses beyond the rim": (
        rb.Camera(
            "double-sphere",
            (73, 391),
            {"fx": 28.6, "fy": 29.1, "cx": 41, "cy": 199, "xi": -0.2, "alpha": 0.6},
        ),
        rb.Camera("equidistant", (237, 171), {"fx": 104, "fy": 105, "cx": 120, "cy": 80}),
    ),
    "a lens whose domain ends in the image": (
        rb.Camera(
            "kannala-brandt",
            (65, 305),
            {"fx": 43.6, "fy": 44.4, "cx": 28, "cy": 150, "k1": 0.01, "k2": -0.003},
        ),
        squeezed(226.0, (394, 92), 50.0),
    ),
}


@pytest.mark.parametrize("lenses", TINY)
@pytest.mark.parametrize("method", ["abraham", "local-homography"])
def test_honest_methods_agree_with_themselves_on_few_and_extreme_pixels(method: str, lenses: str) -> None:
    rotation = Rotation.from_rotvec([0.3, -0.2, 0.25]).as_matrix()
    pair = rb.Rig(*TINY[lenses], rotation, np.array([0.09, -0.175, 0.03]))
    rect = rb.rectify(pair, method=method)
    check_agreement(rect, Delivered.of(rect, ScoredView.of(pair)))


def test_the_same_rectification_is_judged_alike_twice() -> None:
    rect = with_discs({side: ScoredView.of(RIG).side(side).pixels for side in ("left", "right")}, 0.6)
    reasons = []
    for _ in range(2):
        with pytest.raises(rb.InvalidResult) as refusal:
            scored(rect)
        reasons.append(str(refusal.value))
    assert reasons[0] == reasons[1]
