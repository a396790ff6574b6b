"""Where in the image a method distorts: native L of every pixel, one colour scale for all methods."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.plugins.figure import FigureData, Side, Sources
from rectbench.plugins.result import Result
from rectbench.reporting.pictures.pair_picture import PairPicture
from rectbench.reporting.pictures.panels import attempts, fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.style import LOST, PAGE_INCHES, add_colour_bar, plain_log_ticks, shaded, shades
from rectbench.reporting.tables.numbers import decade, three_digits
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

SAMPLES_ACROSS = 200
_BAR_INCHES = 0.72
_GAP = 0.02
_LEAST_SHOWN, _MOST_SHOWN = 1e-3, 1e2
"""Below, no change is seen; above, a pixel has become eleven, and has one colour, not to grey the rest."""
_SIDES: tuple[Side, Side] = ("left", "right")


class DistortionMaps(PairPicture):
    """Where in the image each method distorts: L of every pixel, in colours."""

    name = "maps"
    topic = "Pictures"
    usual = 4
    stem = "distortion-map"
    title = "Distortion maps"
    caption = (
        "Native L of every pixel of both source images, one scale for all methods. The number is native L, "
        "the mean over the pixels that the method shows."
    )

    def draw(self, results: Sequence[Result], given: FigureData) -> Figure:
        """A panel a method, left and right image in it, three panels to a row."""
        sources, looks = given.sources, given.looks
        from matplotlib.colors import LogNorm
        from matplotlib.patches import Patch

        rig = sources.pair(results[0]).rig
        panels = attempts(results, lambda r: _maps(sources, r, rig))
        shown = [m for _, maps in panels if not isinstance(maps, str) for m in maps]
        bottom, top = _limits(shown)
        norm = LogNorm(bottom, top)
        camera = rig.left
        figure, axes = panel_grid(len(panels), 3, camera.height / ((2 + _GAP) * camera.width), _BAR_INCHES)
        for ax, (result, maps) in zip(axes, panels, strict=True):
            native, note = result.metrics.get("distortion_native"), ""
            if isinstance(maps, str):
                write_message(ax, maps, 46)
            else:
                _draw_panel(ax, maps, norm)
                note = "" if native is None else f"L = {three_digits(native)}"
            write_head(ax, result.method, note, looks[result.method].colour)
        place = (1 - 0.85 * _BAR_INCHES / PAGE_INCHES, 0.1, 0.1 / PAGE_INCHES, 0.68)
        bar = add_colour_bar(figure, place, norm, shades())
        plain_log_ticks(bar.ax.yaxis)
        bar.set_label("distortion L")
        if any((m.values > top).any() for m in shown):
            bar.ax.annotate(f"> {decade(top)}", (0, 1.05), (0, 4), "axes fraction", "offset points", size=6.5)
        if any(np.isnan(m.values[m.lens]).any() for m in shown):
            patch = Patch(facecolor=LOST, label="not mapped")
            figure.legend(handles=[patch], loc="lower right", borderaxespad=0, fontsize=6)
        return figure


@dataclass(frozen=True)
class SideMap:
    """L on a grid [h, w] of one image, NaN where lost; and where the lens shows anything."""

    values: FloatArray
    lens: NDArray[np.bool_]


def _maps(sources: Sources, result: Result, rig: Rig) -> tuple[SideMap, SideMap]:
    rect = sources.rectification(result)
    left, right = (_side_map(sources, rect, rig, side) for side in _SIDES)
    return left, right


def _side_map(sources: Sources, rect: Rectification, rig: Rig, side: Side) -> SideMap:
    camera: Camera = getattr(rig, side)
    across = min(SAMPLES_ACROSS, camera.width)
    down = max(1, round(across * camera.height / camera.width))
    u = (np.arange(across) + 0.5) * camera.width / across - 0.5
    v = (np.arange(down) + 0.5) * camera.height / down - 0.5
    pixels = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    values = sources.distortion(rect, rig, side, pixels).reshape(down, across)
    return SideMap(values, camera.unproject(pixels)[1].reshape(down, across))


def _limits(maps: Sequence[SideMap]) -> tuple[float, float]:
    """Ends of the colour scale: whole powers of ten about the middle 96 % of all methods' pixels."""
    values = np.concatenate([m.values[np.isfinite(m.values)] for m in maps]) if maps else np.empty(0)
    values = values[values > 0]
    if not values.size:
        return _LEAST_SHOWN, 1.0
    low, high = np.quantile(values, [0.02, 0.98])
    low, high = np.clip([low, high], [_LEAST_SHOWN, _LEAST_SHOWN], [0.1 * _MOST_SHOWN, _MOST_SHOWN])
    bottom, top = 10.0 ** math.floor(math.log10(low)), 10.0 ** math.ceil(math.log10(high))
    return bottom, max(top, 10 * bottom)


def _draw_panel(ax: Axes, maps: tuple[SideMap, SideMap], norm: LogNorm) -> None:
    start = 0.0
    for side in maps:
        height, width = side.values.shape
        image = shaded(side.values, side.lens, norm)
        ax.imshow(image, extent=(start, start + width, height, 0), interpolation="none", aspect="auto")
        start += width * (1 + _GAP)
    width, height = start - maps[1].values.shape[1] * _GAP, max(side.values.shape[0] for side in maps)
    fit_into_box(ax, width, height)
