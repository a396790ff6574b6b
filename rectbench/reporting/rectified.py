"""Rectified pairs side by side, with scan lines through true correspondences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras.arrays import FloatArray
from rectbench.errors import RectbenchError
from rectbench.rendering.images import StereoPair
from rectbench.rendering.truth import Truth
from rectbench.reporting.columns import column
from rectbench.reporting.numbers import shown
from rectbench.reporting.panels import fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.run_folder import Result
from rectbench.reporting.sources import Sources
from rectbench.reporting.style import PAGE_INCHES, looks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINES = 7
PIXELS_PER_INCH = 220
_LINE_COLOURS = ("#ffd400", "#00e5ff", "#ff5ca8", "#7dff5a", "#ff9a3c", "#b9a3ff", "#ffffff")
_GAP = 0.012
Image = NDArray[np.generic]


@dataclass(frozen=True)
class Panel:
    """A pair of equal size images and the points that correspond, [n, 2] each, NaN where lost."""

    note: str
    left: Image
    right: Image
    points_left: FloatArray
    points_right: FloatArray


def draw_rectified(sources: Sources, results: Sequence[Result], methods: Sequence[str]) -> Figure:
    """The originals, then each method's rectified pair, two pairs to a row.

    Raises whatever the sources raise for the pair itself; a method that fails shows why in its place.
    """
    pair, truth = sources.pair(results[0])
    points = _spread(truth, pair)
    panels: list[tuple[str, Panel | str]] = [("", Panel("", pair.left, pair.right, *points))]
    panels += [(r.method, _panel(sources, r, pair, points)) for r in results]
    height, width = pair.left.shape[:2]
    figure, axes = panel_grid(len(panels), 2, height / ((2 + _GAP) * width))
    colours = looks(methods)
    for ax, (method, panel) in zip(axes, panels, strict=True):
        if isinstance(panel, Panel):
            _draw_panel(ax, panel)
            write_head(ax, method or "source images", panel.note, colours[method][0] if method else None)
        else:
            write_message(ax, panel, 70)
            write_head(ax, method, colour=colours[method][0])
    return figure


def _panel(
    sources: Sources, result: Result, pair: StereoPair, points: tuple[FloatArray, FloatArray]
) -> Panel | str:
    """The method's pair, or the reason why there is none."""
    if not result.ok:
        return f"{result.status}: {result.reason}" if result.reason else result.status
    try:
        rect = sources.rectification(result)
        left, right = rect.remap(pair.left, pair.right)
        moved = rect.left.forward(points[0]), rect.right.forward(points[1])
    except Exception as error:  # a plugin's code runs here, and one picture is no reason to lose a report
        return f"no picture: {error}" if isinstance(error, RectbenchError) else f"no picture: {error!r}"
    keys = [key for key in ("row_error_mean_px", "log_distortion") if key in result.metrics]
    note = ",  ".join(f"{column(k).heading} {_quantity(result.metrics[k], k)}" for k in keys)
    return Panel(note, left, right, *moved)


def _quantity(value: float, key: str) -> str:
    shown_as = column(key)
    return f"{shown(value, shown_as)} {shown_as.unit}".strip()


def _spread(truth: Truth, pair: StereoPair) -> tuple[FloatArray, FloatArray]:
    """Correspondences [n, 2] in both sources, one in each band of rows, left and right by turns."""
    height, width = pair.left.shape[:2]
    left, right = truth.matches(2000, seed=0)
    chosen: list[int] = []
    for band in range(LINES):
        row = (band + 0.5) / LINES * height
        aim = np.array([width * (0.36 if band % 2 else 0.64), row])
        near = np.flatnonzero(np.abs(left[:, 1] - row) < 0.5 * height / LINES)
        if near.size:
            chosen.append(int(near[np.argmin(np.linalg.norm(left[near] - aim, axis=1))]))
    return left[chosen], right[chosen]


def _draw_panel(ax: Axes, panel: Panel) -> None:
    height, width = panel.left.shape[:2]
    gap = _GAP * width
    _show(ax, panel.left, 0.0)
    _show(ax, panel.right, width + gap)
    shift = np.array([width + gap, 0.0])
    for i, (a, b) in enumerate(zip(panel.points_left, panel.points_right + shift, strict=True)):
        if not _inside(a, width, height) or not _inside(b - shift, width, height):
            continue
        colour = _LINE_COLOURS[i % len(_LINE_COLOURS)]
        ax.plot([0, 2 * width + gap], [a[1], a[1]], color=colour, linewidth=0.6)
        for x, y in (a, b):
            ax.plot(
                x, y, "o", markersize=3.2, markerfacecolor="none", markeredgecolor=colour, markeredgewidth=0.8
            )
    fit_into_box(ax, 2 * width + gap, height)


def _inside(point: FloatArray, width: int, height: int) -> bool:
    return bool(np.isfinite(point).all() and 0 <= point[0] < width and 0 <= point[1] < height)


def _show(ax: Axes, image: Image, x: float) -> None:
    """The image, no finer than the figure can show: files stay small and drawing quick."""
    import cv2

    height, width = image.shape[:2]
    target = max(1, round(PAGE_INCHES / 4 * PIXELS_PER_INCH))
    small = image
    if width > target:
        size = (target, max(1, round(height * target / width)))
        small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    ax.imshow(small, extent=(x, x + width, height, 0), interpolation="none", aspect="auto")
