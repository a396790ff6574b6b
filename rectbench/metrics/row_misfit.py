"""Whether a map rectifies: whether its rows are epipolar planes, those of the rig."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric
from rectbench.rigs import Rig
from rectbench.scored import Delivered, DeliveredSide
from rectbench.types import FloatArray, Matches
from rectbench.warps import Rectification
from rectbench.warps.lookup.resampling import SIDES
from rectbench.warps.rectification import in_frame

LARGEST_BEND_PX = 0.05
"""What is farther from the plane of its row is no row; a formula whose rows are planes keeps 0.0001 px."""
LARGEST_MISFIT = 0.01
"""Of the source's width: what a pose that was found in images comes to, with room. Images left as they are
have three times as much."""
MATCHES = 1_000
NEAREST, FARTHEST = 3.0, 10.0
"""Baselines: near points, whose rows a map has to bring together."""
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

    @property
    def reason(self) -> str:
        """Why it does not rectify; empty where it does."""
        if self.bend_px > LARGEST_BEND_PX:
            return f"does not rectify: rows are bent by {self.bend_px:.2g} px"
        if self.misfit > LARGEST_MISFIT:
            return f"does not rectify: rows of near points are {self.misfit:.1%} of the image's width apart"
        return ""

    @property
    def rectifies(self) -> bool:
        """Whether the rows are good enough for the map to be compared with others."""
        return not self.reason


def row_misfit(rect: Rectification, delivered: Delivered, *rigs: Rig) -> RowMisfit:
    """That of a rectification, against the best of the rigs: the true one, and the one its method was told.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rect = rb.rectify(rig, method="abraham")
    >>> row_misfit(rect, rb.Delivered.of(rect, rb.ScoredView.of(rig)), rig).rectifies
    True
    """
    bend_px = max(_bend_px(side) for side in (delivered.left, delivered.right))
    return RowMisfit(bend_px, min((_misfit(rect, delivered, rig) for rig in rigs), default=math.nan))


def case_row_misfit(case: Case) -> RowMisfit:
    """That of a case, against the true rig, and the believed one where that is another."""
    rigs = [case.rig] if case.believed in (None, case.rig) else [case.rig, case.believed]
    return row_misfit(case.rect, case.delivered, *rigs)


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
    rows, pixels_per_row = [], []
    for side, matches in zip(SIDES, simulated_matches(rig, MATCHES, NEAREST, FARTHEST), strict=True):
        pieces, px_rect = delivered.side(side).pieces, rect.warp(side).forward(matches)
        if not len(pieces.jacobians):
            return math.nan
        piece = pieces.at(pieces.sheet.place(px_rect))
        rows.append(np.where((piece >= 0) & in_frame(px_rect, rect.size), px_rect[:, 1], np.nan))
        pixels_per_row.append(1 / np.linalg.norm(pieces.jacobians[piece, 1], axis=-1))
    errors = np.abs(rows[0] - rows[1]) * np.mean(pixels_per_row, axis=0)
    errors = errors[np.isfinite(errors)]
    return float(np.quantile(errors, 0.95)) / rig.left.width if errors.size else math.nan


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
            "away, in source pixels, as a share of the width, by the pose that the method was told or "
            f"the true one, whichever fits better; above {LARGEST_MISFIT:.0%} a map is none either.",
            floor=1e-6,
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together."""
        found = case.once(case_row_misfit)
        return {"row_bend_px": found.bend_px, "row_misfit": found.misfit}
