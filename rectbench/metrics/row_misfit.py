"""Whether a map rectifies: whether its rows are epipolar planes, those of the rig."""

from __future__ import annotations

import math
from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric
from rectbench.rigs import Rig
from rectbench.scored import Delivered, DeliveredSide
from rectbench.types import FloatArray, Matches
from rectbench.warps import Rectification, Warp
from rectbench.warps.lookup.resampling import SIDES
from rectbench.warps.rectification import in_frame

LARGEST_BEND_PX = 0.05
"""What is farther from the plane of its row is no row; a formula whose rows are planes keeps 0.0001 px."""
LARGEST_MISFIT = 0.01
"""Of the source's width: what rows that were found in images come to, with room. Images left as they are have
three times as much."""
TOLD_MISFIT = 2e-3
"""The same of methods that were told the pose, and work from nothing else."""
MATCHES = 1_000
NEAREST, FARTHEST = 3.0, 10.0
"""Baselines: near points, whose rows a map has to bring together. Narrow views see farther ones alone."""
FEWEST_MATCHES = 100
ASKED_SHARE = 0.9
"""Of the view that is kept, matches are expected to be shown; its very rim lacks entries."""
FEWEST_ENTRIES = 8
"""Of a row in the view, to tell its plane by."""


@dataclass(frozen=True)
class RowMisfit:
    """How far the rows of a map are from being epipolar planes, in source pixels.

    Where distortion is compared, all maps are rectifications: one that leaves the images as they are has no
    distortion whatever.
    """

    bend_px: float
    """The farthest that an entry of the tables is from the plane of its row; all planes of an image have one
    line in common, its baseline. 0 for every map whose rows are epipolar planes of some pose."""
    misfit: float
    """95th percentile of the row errors of near points of the rig that fits best, as a share of the image's
    width."""
    allowed: float = LARGEST_MISFIT
    """How much of that there may be."""

    @property
    def reason(self) -> str:
        """Why it does not rectify; empty where it does."""
        if not self.bend_px <= LARGEST_BEND_PX:  # NaN, where nothing can be told, is no rectification either
            return f"does not rectify: rows are bent by {self.bend_px:.2g} px"
        if not self.misfit <= self.allowed:
            return f"does not rectify: rows of near points are {self.misfit:.2%} of the image's width apart"
        return ""

    @property
    def rectifies(self) -> bool:
        """Whether the rows are good enough for the map to be compared with others."""
        return not self.reason


def row_misfit(
    rect: Rectification, delivered: Delivered, *rigs: Rig, works_from: Set[str] = frozenset({"pose"})
) -> RowMisfit:
    """That of a rectification, against the best of the rigs: the true one, and the one its method was told.

    `works_from` are the method's needs: what works from a pose alone has its rows exactly.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rect = rb.rectify(rig, method="abraham")
    >>> row_misfit(rect, rb.Delivered.of(rect, rb.ScoredView.of(rig)), rig).rectifies
    True
    """
    bend_px = float(
        np.max([_bend_px(side) for side in (delivered.left, delivered.right)])
    )  # NaN where one is
    misfit = min((_misfit(rect, delivered, rig) for rig in rigs), default=math.nan)
    return RowMisfit(bend_px, misfit, TOLD_MISFIT if works_from == {"pose"} else LARGEST_MISFIT)


def case_row_misfit(case: Case) -> RowMisfit:
    """That of a case, against the true rig, and the believed one where that is another."""
    rigs = [case.rig] if case.believed in (None, case.rig) else [case.rig, case.believed]
    return row_misfit(case.rect, case.delivered, *rigs, works_from=case.works_from)


def simulated_matches(rig: Rig, count: int, nearest: float, farthest: float) -> Matches:
    """Where points all over the left view are seen, at distances in baselines; those that both images see."""
    rng = np.random.default_rng(1)
    pixels = rng.uniform(0, np.array(rig.left.size) - 1, (count, 2))
    rays, ok_left = rig.left.unproject(pixels)
    distances = rig.baseline_m * np.exp(rng.uniform(np.log(nearest), np.log(farthest), count))
    pixels_right, ok_right = rig.right.project(rig.right_from_left(rays * distances[:, None]))
    seen = ok_left & ok_right & rig.right.contains(pixels_right)
    return Matches(pixels[seen], pixels_right[seen])


def _misfit(rect: Rectification, delivered: Delivered, rig: Rig) -> float:
    """Of matches in the view that is kept; one that is not shown there is as far off as can be."""
    matches = _near_matches(rig)
    left, right = (
        _shown_rows(rect.warp(side), delivered.side(side), px)
        for side, px in zip(SIDES, matches, strict=True)
    )
    source_px_per_row = (left.source_px_per_row + right.source_px_per_row) / 2
    errors = np.abs(rect.rows_apart(left.rows, right.rows)) * source_px_per_row + left.off_px + right.off_px
    kept = ASKED_SHARE * delivered.kept_share
    asked = delivered.left.scored.within(matches[0], kept) & delivered.right.scored.within(matches[1], kept)
    found = np.where(np.isfinite(errors), errors, math.inf)[asked | np.isfinite(errors)]
    return float(np.quantile(found, 0.95, method="higher")) / rig.left.width if found.size else math.nan


def _near_matches(rig: Rig) -> Matches:
    """As near as both images see enough of them."""
    for farther in (1.0, 10.0, 100.0):
        matches = simulated_matches(rig, MATCHES, farther * NEAREST, farther * FARTHEST)
        if len(matches[0]) >= FEWEST_MATCHES:
            break
    return matches


@dataclass(frozen=True, eq=False)
class _ShownRows:
    """In which rows source pixels [K] are shown; NaN for those that are not."""

    rows: FloatArray
    source_px_per_row: FloatArray
    off_px: FloatArray
    """How far from each the table is where the map says that it is, source pixels."""


def _shown_rows(warp: Warp, side: DeliveredSide, pixels: FloatArray) -> _ShownRows:
    pieces, px_rect = side.pieces, warp.forward(pixels)
    if not len(pieces.jacobians):
        return _ShownRows(*np.full((3, len(pixels)), math.nan))
    shown = in_frame(px_rect, side.delivered.size)
    off_px = np.linalg.norm(pieces.sheet.source(px_rect) - pixels, axis=-1)
    gradients = pieces.jacobians[pieces.at(pieces.sheet.place(px_rect)), 1]
    return _ShownRows(
        np.where(shown, px_rect[:, 1], math.nan), 1 / np.linalg.norm(gradients, axis=-1), off_px
    )


def _bend_px(side: DeliveredSide) -> float:
    """Of the entries where pieces of the table meet; NaN where no row shows anything."""
    camera, table = side.scored.camera, side.pieces.sheet.table
    corners = np.ix_(side.pieces.rows[::2], side.pieces.columns[::2])
    pixels = np.stack([layer[corners] for layer in table], axis=-1).astype(float)
    rays, seen = camera.unproject(pixels)
    seen &= camera.contains(pixels)
    shows = seen.sum(axis=1) >= FEWEST_ENTRIES
    if not shows.any():
        return math.nan
    pixels, seen = pixels[shows], seen[shows]
    rays = np.where(seen[..., None], rays[shows], 0.0)
    lengths, normals = _planes(rays)
    baseline = np.linalg.eigh((normals * lengths).T @ normals)[1][:, 0]
    # Planes through the baseline: what rays have along it says nothing of them.
    _, normals = _planes(rays - (rays @ baseline)[..., None] * baseline, baseline)
    off = np.einsum("rci,ri->rc", rays, normals)
    feet, _ = camera.project(rays - off[..., None] * normals[:, None])
    return float(np.nanmax(np.linalg.norm(feet - pixels, axis=-1)[seen]))


def _planes(rays: FloatArray, within: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Of each row of rays [R, C, 3]: how much they spread in their plane [R, 1], and its unit normal [R, 3].

    The plane through the camera nearest to them, of those that hold a direction if one is given.
    """
    moments = np.einsum("rci,rcj->rij", rays, rays)
    if within is not None:
        moments += rays.shape[1] * np.outer(within, within)
    spreads, axes = np.linalg.eigh(moments)
    return spreads[:, 1:2], axes[..., 0]


class RowMisfitMetric(Metric):
    """How far the rows of the rectified images are from being epipolar planes."""

    name, topic = "row_misfit", "Row error"
    columns = (
        Column.pixels(
            "row_bend_px",
            "rows, bent",
            "The farthest that a pixel is from the epipolar plane of its row, in pixels of the source images;"
            f" above {LARGEST_BEND_PX:g} px a map is no rectification, and has no distortion at equal view.",
            shown="pairs",
        ),
        Column.share(
            "row_misfit",
            "rows, misfit",
            "lower",
            f"95th percentile of the row error of simulated points {NEAREST:g} to {FARTHEST:g} baselines "
            "away, in source pixels, as a share of the width, by the pose that the method was told or the "
            "true one, whichever fits better.",
            floor=1e-6,
            shown="pairs",
        ),
        Column.share(
            "rectifies",
            "rectifies",
            "higher",
            f"Whether rows are bent by at most {LARGEST_BEND_PX:g} px, and misfit by at most "
            f"{TOLD_MISFIT:.2%} where the method works from the pose alone, else {LARGEST_MISFIT:.0%}.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together."""
        found = case.once(case_row_misfit)
        return {
            "row_bend_px": found.bend_px,
            "row_misfit": found.misfit,
            "rectifies": float(found.rectifies) if case.delivered.kept_share > 0 else math.nan,
        }
