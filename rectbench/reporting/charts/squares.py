"""What becomes of small squares of the source image: the paper's "unit rectangle", all over the view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rectbench.cameras import Camera
from rectbench.plugins.figure import FigureData, Sources
from rectbench.plugins.result import Result
from rectbench.reporting.pictures.pair_picture import PairPicture
from rectbench.reporting.pictures.panels import attempts, fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.style import FAINT, INK, PAGE_INCHES, add_colour_bar
from rectbench.types import FloatArray
from rectbench.warps import Warp

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

SQUARES_ACROSS = 18
SIDE_SHARE = 0.62
"""Side of a square as a share of the distance to the next one."""
_POINTS_A_SIDE = 6
_COLOURS = "PuOr"
_REACHES = (1.25, 1.6, 2.5, 4.0)
"""Ends that the colour scale may have: areas from 1 / reach to reach."""
_BAR_INCHES = 0.72


class Squares(PairPicture):
    """What becomes of small squares of the left source image, all over the view."""

    name = "squares"
    topic = "Pictures"
    stem = "squares"
    title = "Unit squares"
    caption = (
        "Small squares of the left source image, and what each method makes of them where they land on its "
        "output; the colour is the change of area S. Each output is fitted to its panel: compare sizes by "
        "colour, not by eye."
    )
    shown_as = "svg"

    def draw(self, results: Sequence[Result], given: FigureData) -> Figure:
        """The squares in the left source image, then where and how each method maps them."""
        sources, looks = given.sources, given.looks
        from matplotlib.colors import LogNorm

        camera = sources.pair(results[0]).rig.left
        squares = source_squares(camera)
        panels: list[tuple[str, Cells | str]] = [("", Cells(squares, np.ones(len(squares)), camera.size))]
        mapped = attempts(results, lambda r: _mapped(sources, r, squares))
        panels += [(result.method, cells) for result, cells in mapped]
        reach = _reach([cells for _, cells in panels if isinstance(cells, Cells)])
        norm = LogNorm(1 / reach, reach)
        columns = 2 if len(panels) in (2, 4) else 3
        figure, axes = panel_grid(len(panels), columns, camera.height / camera.width, _BAR_INCHES)
        for ax, (method, cells) in zip(axes, panels, strict=True):
            note = ""
            if isinstance(cells, str):
                write_message(ax, cells, 46)
            else:
                _draw_cells(ax, cells, norm)
                note = f"{len(cells.outlines)} of {len(squares)}" if method else f"{len(squares)} squares"
            write_head(ax, method or "left source image", note, looks[method].colour if method else None)
        place = (1 - 0.85 * _BAR_INCHES / PAGE_INCHES, 0.12, 0.1 / PAGE_INCHES, 0.7)
        bar = add_colour_bar(figure, place, norm, _COLOURS)
        ticks = [reach**exponent for exponent in (-1, -0.5, 0, 0.5, 1)]
        bar.set_ticks(ticks, labels=[f"{tick:.2g}" for tick in ticks])
        bar.ax.minorticks_off()
        bar.set_label("area S of a unit square")
        return figure


@dataclass(frozen=True)
class Cells:
    """Outlines [n, m, 2] of squares in an image of `size`, and by what their areas changed [n]."""

    outlines: FloatArray
    areas: FloatArray
    size: tuple[int, int]


def _reach(shown: Sequence[Cells]) -> float:
    """The least end of the scale that holds nearly all areas."""
    factors = np.exp(np.abs(np.log(np.concatenate([cells.areas for cells in shown]))))
    return next((reach for reach in _REACHES if np.mean(factors <= reach) > 0.95), _REACHES[-1])


def source_squares(camera: Camera) -> FloatArray:
    """Outlines [n, m, 2] of a regular grid of small squares that the lens sees whole."""
    pitch = camera.width / SQUARES_ACROSS
    down = max(1, round(camera.height / pitch))
    u = (np.arange(SQUARES_ACROSS) + 0.5) * pitch - 0.5
    v = (np.arange(down) + 0.5) * camera.height / down - 0.5
    centres = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 1, 2)
    outlines = centres + 0.5 * SIDE_SHARE * pitch * _unit_outline()
    seen: FloatArray = outlines[camera.unproject(outlines)[1].all(axis=1)]
    return seen


def _unit_outline() -> FloatArray:
    """Points [m, 2] once round the square [-1, 1]²."""
    t = np.linspace(-1, 1, _POINTS_A_SIDE, endpoint=False)
    one = np.ones_like(t)
    sides = ((t, -one), (one, t), (-t, one), (-one, -t))
    return np.concatenate([np.stack(side, axis=-1) for side in sides])


def _mapped(sources: Sources, result: Result, squares: FloatArray) -> Cells:
    rect = sources.rectification(result)
    return mapped_cells(rect.left, squares, rect.size, rect.turn_px)


def mapped_cells(
    warp: Warp, squares: FloatArray, size: tuple[int, int], turn_px: float | None = None
) -> Cells:
    """The squares that land on the output, whole or in part; but for those that a seam of its rows cuts."""
    outlines = warp.forward(squares)
    areas = np.abs(np.linalg.det(warp.jacobian(squares.mean(axis=1))))
    frame = np.array(size) - 0.5
    lands = np.isfinite(outlines).all(axis=(1, 2)) & np.isfinite(areas)
    within = np.all((outlines > -0.5) & (outlines < frame), axis=2)
    lands &= within.any(axis=1)
    if turn_px is not None:
        lands &= np.ptp(outlines[..., 1], axis=1) < turn_px / 2
    return Cells(outlines[lands], areas[lands], size)


def _draw_cells(ax: Axes, cells: Cells, norm: LogNorm) -> None:
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Rectangle

    width, height = cells.size
    fit_into_box(ax, width, height)
    frame = Rectangle((0, 0), width, height, facecolor="none", edgecolor=FAINT, linewidth=0.5)
    ax.add_patch(frame)
    drawn = PolyCollection(
        list(cells.outlines + 0.5),  # pixel centres are half a pixel in
        facecolors=colormaps[_COLOURS](norm(cells.areas)),
        edgecolors=INK,
        linewidths=0.25,
    )
    drawn.set_clip_path(frame)
    ax.add_collection(drawn, autolim=False)
