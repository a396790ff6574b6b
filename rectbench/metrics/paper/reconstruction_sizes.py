"""Reconstruction at equal view and equal size: what dense matching finds as the matched image grows.

How dense a reconstruction is depends on how large the rectified images are that are matched, which a
method's focal length or frame decides by the way. Here each method's images are cut to what they show and
resized, so that the left one shows source pixels in a stated number of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from rectbench.matching import reconstruct
from rectbench.metrics.reconstruction import COMPLETE_WITHIN, counted_pixels, depth_errors
from rectbench.plugins.metric import Case, Column, Metric
from rectbench.warps import Rectification

MEGAPIXELS = (0.25, 0.5, 1.0)
"""Pixels of the left rectified image that show the source."""
VIEWS = (0.5, 0.75, 0.95)
"""Shares of the view that are counted; a method that does not keep all of one has no number there."""
LARGEST_FRAME = 3e6
"""Pixels of a matched image, those that show nothing among them. Where more would be needed, as where a
perspective image of a wide lens runs out into four points, there is no number."""
WORKING_PIXELS = 6e6
"""An image is resampled at the source's resolution, though at no more pixels, and then made smaller: nothing
aliases."""


def _key(what: str, view: float, megapixels: float) -> str:
    size = f"{megapixels:g}".replace(".", "_")
    return f"reconstruction_{what}_{100 * view:.0f}_at_{size}mp"


class ReconstructionSizes(Metric):
    """How much of a stated part of the view dense matching finds, at several sizes of the matched image."""

    name, topic = "reconstruction_sizes", "Reconstruction"
    needs = frozenset({"truth", "images"})
    columns = tuple(
        Column.share(
            _key(what, view, megapixels),
            f"{what}, {100 * view:.0f} % of the view, {megapixels:g} MP",
            "higher",
            f"Share of the pixels in the middle {100 * view:.0f} % of the left view, of those that both "
            f"cameras see, that get {meaning}, where {megapixels:g} megapixels of the matched image show the "
            "source.",
            shown="pairs" if what == "completeness" else "rows",
        )
        for what, meaning in (("density", "any depth"), ("completeness", "a depth within 5 % of the truth"))
        for view in VIEWS
        for megapixels in MEGAPIXELS
    )

    def compute(self, case: Case) -> dict[str, float]:
        """By the report's matcher at each size."""
        kept = [view for view in VIEWS if case.delivered.keeps(view)]
        images, truth = case.pair.images, case.pair.truth
        pixels = counted_pixels(truth)
        within = {view: case.pair.scored_view.left.within(pixels, view) for view in kept}
        scores = {}
        for megapixels, rect, frame_pixels in sized(case.rect) if kept else ():
            found = reconstruct(rect, images.left, images.right, case.matcher, pixels=frame_pixels)
            error = depth_errors(found, truth, pixels)
            for view, counted in within.items():
                if counted.any():
                    scores[_key("density", view, megapixels)] = float(np.isfinite(error[counted]).mean())
                    complete = float((error[counted] <= COMPLETE_WITHIN).mean())
                    scores[_key("completeness", view, megapixels)] = complete
        return scores


def sized(rect: Rectification) -> Iterator[tuple[float, Rectification, float]]:
    """Each of MEGAPIXELS, the rectification at a working size, and the pixels its frame is to be matched at.

    Sizes that would need too large a frame are left out; nothing where the left image shows nothing.
    """
    valid = {side: rect.valid(side) for side in ("left", "right")}
    if not valid["left"].any():
        return
    shown = valid["left"] | valid["right"]
    columns, rows = np.flatnonzero(shown.any(axis=0)), np.flatnonzero(shown.any(axis=1))
    corner = (columns[0] - 0.5, rows[0] - 0.5)
    extent = (float(columns[-1] - columns[0] + 1), float(rows[-1] - rows[0] + 1))
    per_valid_pixel = extent[0] * extent[1] / valid["left"].sum()
    factor = min(_to_source_resolution(rect), math.sqrt(WORKING_PIXELS / (extent[0] * extent[1])))
    for megapixels in MEGAPIXELS:
        frame_pixels = 1e6 * megapixels * per_valid_pixel
        if frame_pixels > LARGEST_FRAME:
            return
        scale = max(factor, math.sqrt(frame_pixels / (extent[0] * extent[1])))
        size = max(1, round(scale * extent[0])), max(1, round(scale * extent[1]))
        yield megapixels, rect.windowed(corner, extent, size), frame_pixels


def _to_source_resolution(rect: Rectification) -> float:
    """The factor that gives the densest part of the left view as many pixels as the source has there."""
    middle = (np.array(rect.left.source.size) - 1) / 2
    area = abs(float(np.linalg.det(rect.left.jacobian(middle))))
    return 1 / math.sqrt(area) if math.isfinite(area) and area > 0 else 1.0
