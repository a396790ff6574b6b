"""How much of the view is left in an image of the source's size at the source's resolution."""

from __future__ import annotations

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric
from rectbench.types import FloatArray
from rectbench.warps import Rectification

STEPS = 128
"""Places tried along columns and along rows, for the window that keeps the most."""
CENTRE_SHARE = 0.02
"""The share of the view, about its middle, whose resolution is made the source's."""


class ViewAtSourceSize(Metric):
    """The share of the view that fits into an image of the source's size, at its centre resolution."""

    name, topic = "view_at_source_size", "Coverage"
    columns = (
        Column.share(
            "view_at_source_size",
            "view at source size",
            "higher",
            "Share of the source's pixels that an image of the source's size keeps, scaled so that the "
            "middle of the view has as many pixels as in the source.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """The mean over both images of what the best window keeps."""
        sides = (case.delivered.left, case.delivered.right)
        middle = case.delivered.within(CENTRE_SHARE)
        if not len(middle.both):  # it does not show the middle of the view
            return {"view_at_source_size": 0.0}
        scale = 1 / np.sqrt(np.median(np.abs(np.linalg.det(middle.both))))
        shown = [np.where(side.shown[:, None], scale * side.px_rect, np.nan) for side in sides]
        return {"view_at_source_size": share_in_window(shown, source_size(case.rect))}


def source_size(rect: Rectification) -> tuple[int, int]:
    """(width, height) of the larger source image, each way."""
    cameras = (rect.left.source, rect.right.source)
    return max(c.width for c in cameras), max(c.height for c in cameras)


def share_in_window(sides: list[FloatArray], size: tuple[int, int]) -> float:
    """The largest mean share of points [N, 2] of each side in a window of `size`, NaN being nowhere.

    Rows are shared by both images, so that their windows begin at one height; each has its own columns.
    """
    found = [side[np.isfinite(side).all(axis=1)] for side in sides]
    rows = np.concatenate([points[:, 1] for points in found])
    if not rows.size:
        return 0.0
    tops = _starts(rows, size[1])
    kept = [
        sum(
            _most_in_span(points[(points[:, 1] >= top) & (points[:, 1] <= top + size[1]), 0], size[0])
            / len(side)
            for points, side in zip(found, sides, strict=True)
        )
        for top in tops
    ]
    return float(max(kept) / len(sides))


def _starts(values: FloatArray, span: float) -> FloatArray:
    """Where windows of that span may begin: from the least value to where they end at the greatest."""
    low, high = float(values.min()), float(values.max())
    return np.linspace(low, high - span, STEPS) if high - low > span else np.array([low])


def _most_in_span(values: FloatArray, span: float) -> int:
    """The most values that one interval of that length holds, exactly."""
    ordered = np.sort(values)
    ends = np.searchsorted(ordered, ordered + span, side="right")
    return int((ends - np.arange(len(ordered))).max(initial=0))
