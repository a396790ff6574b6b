"""Two views of what is reconstructed through each method's rectification, and of the truth if it is known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rectbench.images.stereo_pair import StereoPair
from rectbench.plugins.catalogue import column
from rectbench.plugins.figure import FigureData, Sources
from rectbench.plugins.result import Result
from rectbench.rendering.truth import Truth
from rectbench.reporting.pictures.pair_picture import PairPicture
from rectbench.reporting.pictures.panels import attempts, fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.pictures.views import Floats, Patches, Picture, View, painted, patches_of, two_views
from rectbench.reporting.tables.numbers import shown
from rectbench.types import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (602, 334)
DPI = 170
"""Width and height of a view, pixels, and the resolution at which a panel has just as many."""
_NOTED = ("reconstruction_completeness", "reconstruction_density")
_BORDER = "#bbbbbb"


class Clouds(PairPicture):
    """What is reconstructed through each method's rectification, seen from two places."""

    name = "clouds"
    topic = "Reconstruction"
    needs = frozenset({"images"})
    stem = "clouds"
    title = "Reconstruction"
    caption = (
        "Dense matches on the rectified pair, triangulated, in the left image's colours: the same two views "
        "of all. The one from above leaves out what is well above the cameras."
    )
    dpi = DPI

    def draw(self, results: Sequence[Result], given: FigureData) -> Figure:
        """A row the truth, if it is known, and a row a method: from beside the cameras, and from above."""
        sources, looks = given.sources, given.looks
        known = sources.pair(results[0])
        clouds = attempts(results, lambda r: _reconstructed(sources, r))
        # All are seen alike: from viewpoints made from the truth, else from what they show together.
        points: FloatArray | Floats
        if known.knows_truth:
            points = known.truth.points_left[known.truth.visible_left]
        else:
            points = _together([patches for _, patches in clouds if not isinstance(patches, str)])
        views = two_views(points, SIZE)
        heads = 2 if known.knows_truth else 0
        figure, axes = panel_grid(2 * len(results) + heads, 2, SIZE[1] / SIZE[0])
        if known.knows_truth:
            _draw_row(axes[:2], _pictures(_true_patches(known.images, known.truth), views))
            _write_heads(axes[:2], "truth", "the left image at its depth")
        for i, (result, patches) in enumerate(clouds):
            row = axes[heads + 2 * i : heads + 2 * i + 2]
            _draw_row(row, patches if isinstance(patches, str) else _pictures(patches, views))
            _write_heads(row, result.method, _note(result), looks[result.method].colour)
        return figure


def _together(clouds: Sequence[Patches]) -> Floats:
    """The points [N, 3] of all methods, N at least 1."""
    points = [patches.points for patches in clouds if len(patches.points)]
    return np.concatenate(points) if points else np.array([[0.0, 0.0, 1.0]], np.float32)


def _true_patches(pair: StereoPair, truth: Truth) -> Patches:
    return patches_of(np.where(truth.visible_left[..., None], truth.points_left, np.nan), pair.left)


def _reconstructed(sources: Sources, result: Result) -> Patches:
    cloud = sources.reconstruction(result)
    return patches_of(cloud.points, cloud.colours)


def _pictures(patches: Patches, views: Sequence[View]) -> list[Picture]:
    return [painted(patches, view, SIZE) for view in views]


def _note(result: Result) -> str:
    keys = [key for key in _NOTED if key in result.metrics]
    return ",  ".join(f"{column(k).heading} {shown(result.metrics[k], column(k))} %" for k in keys)


def _write_heads(row: Sequence[Axes], name: str, note: str, colour: str | None = None) -> None:
    write_head(row[0], name, "from beside the cameras", colour)
    write_head(row[1], "from above", note, colour)


def _draw_row(row: Sequence[Axes], pictures: list[Picture] | str) -> None:
    from matplotlib.patches import Rectangle

    width, height = SIZE
    for i, ax in enumerate(row):
        if isinstance(pictures, str):
            write_message(ax, pictures, 60)
            continue
        ax.imshow(pictures[i], extent=(0, width, height, 0), interpolation="none", aspect="auto")
        fit_into_box(ax, width, height)
        border = Rectangle((0, 0), 1, 1, transform=ax.transAxes, fill=False, edgecolor=_BORDER, linewidth=0.6)
        ax.add_patch(border)
