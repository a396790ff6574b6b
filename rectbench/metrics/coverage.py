"""Coverage: how much of the source is kept, and how much of the output shows anything."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rigs import Rig
from rectbench.scored import SeenPixels, SeenView
from rectbench.warps import Rectification, Warp
from rectbench.warps.lookup.resampling import SIDES, Side
from rectbench.warps.lookup.tables import Table, reads_source
from rectbench.warps.rectification import in_frame

TRIMMED = "trimmed"
"""The column that is there where anything is trimmed."""

BAND_ROWS = 64


def trimmed_text(share: float, margin_deg: float) -> str:
    """How much of the view was trimmed, and where, in one line.

    >>> trimmed_text(0.031, 7.0)
    'trimmed: 3.1 % of the source pixels, within 7° of the epipoles'
    """
    return f"{TRIMMED}: {100 * share:.2g} % of the source pixels, within {margin_deg:g}° of the epipoles"


def coverage(rect: Rectification, rig: Rig) -> dict[str, float]:
    """Shares kept of the source pixels, of their solid angle, of the overlap; share of output valid.

    Each is the mean of both images, of all that the rig's lenses show. The overlap is what the other camera
    sees too, of points at infinity. `trimmed` is there where anything of the view is: the share of the source
    pixels that lie so near to the epipoles that the rectification starts without them.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> kept = coverage(rb.rectify(rig, method="abraham"), rig)
    >>> 0 < kept["coverage_overlap"] <= 1
    True
    """
    return coverage_of(rect, SeenView.of(rig), {side: rect.maps(side) for side in SIDES})


def coverage_of(rect: Rectification, seen: SeenView, tables: Mapping[Side, Table]) -> dict[str, float]:
    """The same, with what the rig's lenses see, and the rectification's lookup tables."""
    sides = ((rect.left, seen.left), (rect.right, seen.right))
    pixels, solid_angle, overlap = np.mean([_kept_shares(*side, rect.size) for side in sides], axis=0)
    valid = [_valid_share(tables[side], rect.warp(side)) for side in SIDES]
    source_pixels = np.mean([math.prod(warp.source.size) for warp in (rect.left, rect.right)])
    trimmed = float(np.mean([_trimmed_share(*side) for side in sides]))
    return {
        **({TRIMMED: trimmed} if trimmed else {}),
        "coverage_pixels": float(pixels),
        "coverage_solid_angle": float(solid_angle),
        "coverage_overlap": float(overlap),
        "valid_output": float(np.mean(valid)),
        "output_pixels_per_source_pixel": float(rect.size[0] * rect.size[1] / source_pixels),
    }


def _kept_shares(warp: Warp, seen: SeenPixels, size: tuple[int, int]) -> tuple[float, float, float]:
    kept = in_frame(warp.forward(seen.pixels), size)
    overlap = kept[seen.shared].mean() if seen.shared.any() else math.nan
    return (
        float(kept.mean()),
        float(seen.solid_angle_sr[kept].sum() / seen.solid_angle_sr.sum()),
        float(overlap),
    )


def _valid_share(table: Table, warp: Warp) -> float:
    """By bands of rows: masks of whole images cost more to be given memory than to be made."""
    bands = [slice(row, row + BAND_ROWS) for row in range(0, len(table[0]), BAND_ROWS)]
    masks = (reads_source(table[0][band], table[1][band], warp.source.size) for band in bands)
    return sum(map(np.count_nonzero, masks)) / table[0].size


def _trimmed_share(warp: Warp, seen: SeenPixels) -> float:
    if warp.source.blind is None:
        return 0.0
    return float(1 - warp.source.unproject(seen.pixels)[1].mean())


class Coverage(Metric):
    """How much of the source is kept, and how much of the output shows anything."""

    name, topic = "coverage", "Coverage"
    columns = (
        Column.share(
            "coverage_pixels",
            "pixels kept",
            "higher",
            "Share of source pixels that reach the output.",
            tolerance=Tolerance(0.0, 0.002),
            promised=True,
        ),
        Column.share(
            "coverage_solid_angle",
            "field of view kept",
            "higher",
            "Share of the lens's solid angle that is kept.",
            tolerance=Tolerance(0.0, 0.002),
            promised=True,
        ),
        Column.share(
            "coverage_overlap",
            "overlap kept",
            "higher",
            "Share of the view common to both cameras that is kept.",
            shown="pairs",
        ),
        Column.share(
            "valid_output",
            "output used",
            "higher",
            "Share of the output that shows anything.",
            shown="pairs",
            promised=True,
        ),
        Column.share(
            TRIMMED,
            "trimmed",
            None,
            "Share of source pixels nearer to the epipoles than the margin, where rows meet: no method is "
            "given these. They count as pixels that are not kept.",
        ),
        Column(
            "output_pixels_per_source_pixel",
            "output / source",
            "px/px",
            None,
            "Pixels of output spent on one pixel of source.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Means of both images."""
        tables = {side: case.delivered.side(side).delivered.table for side in SIDES}
        return coverage_of(case.rect, case.pair.seen_view, tables)
