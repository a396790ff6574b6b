"""Rectified pairs side by side, with scan lines through correspondences and boxes round patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from rectbench.images.stereo_pair import StereoPair
from rectbench.plugins.catalogue import column, known
from rectbench.plugins.figure import FigureData, Sources
from rectbench.plugins.result import Result
from rectbench.reporting.pictures.pair_picture import PairPicture
from rectbench.reporting.pictures.panels import attempts, fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.shares import measure
from rectbench.reporting.style import PAGE_INCHES
from rectbench.reporting.tables.numbers import shown
from rectbench.types import FloatArray, Matches
from rectbench.warps import Rectification

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINES = 7
PIXELS_PER_INCH = 220
_LINE_COLOURS = ("#ffd400", "#00e5ff", "#ff5ca8", "#7dff5a", "#ff9a3c", "#b9a3ff", "#ffffff")
_BOX_COLOUR = "#ff1f1f"
_BOX_SHARE = 0.14
_BOX_AIMS = ((0.22, 0.4), (0.5, 0.62), (0.78, 0.48))
"""Side of a box as a share of the image's height, and about where boxes go, as shares of the image."""
_ERRORS = ("row_error_mean_px", "row_error_board_mean_px", "row_error_features_mean_px")
"""Row errors by how far they are to be trusted; the first that was measured is told."""
_RING_SHARE = 0.025
_GAP = 0.012
Image = NDArray[np.generic]


_CAPTION = (
    "Scan lines run through {points} (rings): on a rectified pair both rings lie on the line, and both boxes "
    "between the dashed ones. Each pair is fitted to its panel: sizes do not compare from one method to the "
    "next. Log distortion is that on the share of the view that methods are ranked at."
)


class RectifiedPairs(PairPicture):
    """Rectified pairs side by side, with scan lines through what corresponds."""

    name = "pairs"
    topic = "Pictures"
    needs = frozenset({"images"})
    usual = 3
    stem = "rectified"
    title = "Rectified pairs"
    caption = _CAPTION.format(points="true correspondences")
    caption_of_photographs = _CAPTION.format(
        points="matches found in the images and corners of a board, if they show one"
    )
    dpi = PIXELS_PER_INCH

    def draw(self, results: Sequence[Result], given: FigureData) -> Figure:
        """The originals, then each method's rectified pair, two pairs to a row.

        Raises whatever the sources raise for the pair itself; a method that fails shows why in its place.
        """
        sources, looks = given.sources, given.looks
        known = sources.pair(results[0])
        pair, marks = known.images, _marks(known.shown_matches(), known.images)
        panels: list[tuple[str, Panel | str]] = [("", Panel("", pair.left, pair.right, marks))]
        rectified = attempts(results, lambda r: _panel(sources, r, pair, marks))
        panels += [(result.method, panel) for result, panel in rectified]
        height, width = pair.left.shape[:2]
        figure, axes = panel_grid(len(panels), 2, height / ((2 + _GAP) * width))
        for ax, (method, panel) in zip(axes, panels, strict=True):
            note = ""
            if isinstance(panel, str):
                write_message(ax, panel, 70)
            else:
                _draw_panel(ax, panel)
                note = panel.note
            write_head(ax, method or "source images", note, looks[method].colour if method else None)
        return figure


@dataclass(frozen=True)
class Shown:
    """Correspondences [n, 2] and [m, 2] in both images: of scan lines and of boxes; NaN where lost."""

    lines: Matches
    boxes: Matches

    def moved(self, rect: Rectification) -> Shown:
        """The same points in the rectified images."""
        return Shown(
            *(
                Matches(rect.left.forward(m.left), rect.right.forward(m.right))
                for m in (self.lines, self.boxes)
            )
        )


@dataclass(frozen=True)
class Panel:
    """A pair of equal size images and what corresponds in them."""

    note: str
    left: Image
    right: Image
    shown: Shown


def _panel(sources: Sources, result: Result, pair: StereoPair, marks: Shown) -> Panel:
    rect = sources.rectification(result)
    errors = [key for key in _ERRORS if key in result.metrics][:1]
    keys = [*errors, *(key for key in (known().ranking.key,) if key in result.metrics)]
    note = ",  ".join(_quantity(result.metrics[key], key) for key in keys)
    return Panel(note, *rect.remap(pair.left, pair.right), marks.moved(rect))


def _quantity(value: float, key: str) -> str:
    """What was measured, number and unit; of what share of the view the caption says."""
    shown_as = column(key)
    return f"{measure(shown_as)} {shown(value, shown_as)} {shown_as.unit}".strip()


def _marks(matches: Matches, pair: StereoPair) -> Shown:
    """What is marked: a line in each band of rows, left and right by turns; a box in each third."""
    height, width = pair.left.shape[:2]
    aims = [(width * (0.36 if band % 2 else 0.64), (band + 0.5) / LINES * height) for band in range(LINES)]
    lines = [_nearest(matches.left, aim, 0.5 * height / LINES) for aim in aims]
    texture = _texture(pair.left, matches.left)
    places = [(x * width, y * height) for x, y in _BOX_AIMS]
    boxes = [_most_textured(matches.left, texture, place, 0.07 * width) for place in places]
    return Shown(*(Matches(*(side[_distinct(chosen)] for side in matches)) for chosen in (lines, boxes)))


def _distinct(chosen: Sequence[int | None]) -> list[int]:
    return list(dict.fromkeys(i for i in chosen if i is not None))


def _nearest(points: FloatArray, aim: tuple[float, float], rows: float) -> int | None:
    """The point nearest to `aim` of those at most `rows` above or below it."""
    near = np.flatnonzero(np.abs(points[:, 1] - aim[1]) < rows)
    return int(near[np.argmin(np.linalg.norm(points[near] - aim, axis=1))]) if near.size else None


def _most_textured(
    points: FloatArray, texture: FloatArray, aim: tuple[float, float], reach: float
) -> int | None:
    """The point within `reach` of `aim` where there is most to see."""
    near = np.flatnonzero(np.linalg.norm(points - aim, axis=1) < reach)
    return int(near[np.argmax(texture[near])]) if near.size else None


def _texture(image: Image, points: FloatArray) -> FloatArray:
    """Contrast of the image's surroundings of each point [n]."""
    import cv2

    grey = cv2.cvtColor(np.ascontiguousarray(image), cv2.COLOR_RGB2GRAY).astype(np.float32)
    side = max(3, round(_BOX_SHARE * grey.shape[0])) | 1
    mean, square = (cv2.blur(values, (side, side)) for values in (grey, grey * grey))
    u, v = np.clip(np.rint(points), 0, np.array(grey.shape[::-1]) - 1).astype(int).T
    contrast: FloatArray = (square - mean * mean)[v, u].astype(np.float64)
    return contrast


def _draw_panel(ax: Axes, panel: Panel) -> None:
    height, width = panel.left.shape[:2]
    gap = _GAP * width
    _show(ax, panel.left, 0.0)
    _show(ax, panel.right, width + gap)
    fit_into_box(ax, 2 * width + gap, height)
    shift = np.array([width + gap, 0.0])
    points = panel.shown
    for i, (a, b) in enumerate(zip(*points.lines, strict=True)):
        if not all(_inside(point, width, height, _RING_SHARE * height) for point in (a, b)):
            continue
        colour = _LINE_COLOURS[i % len(_LINE_COLOURS)]
        ax.plot([0, 2 * width + gap], [a[1], a[1]], color=colour, linewidth=0.5)
        for x, y in (a, b + shift):
            ax.plot(
                x, y, "o", markersize=3.2, markerfacecolor="none", markeredgecolor=colour, markeredgewidth=0.8
            )
    side = _BOX_SHARE * height
    for a, b in zip(*points.boxes, strict=True):
        if all(_inside(point, width, height, side / 2) for point in (a, b)):
            _draw_boxes(ax, (a, b + shift), side)


def _draw_boxes(ax: Axes, centres: tuple[FloatArray, FloatArray], side: float) -> None:
    """Boxes of one size round both points, and the first one's edges carried across, above all lines."""
    from matplotlib.patches import Rectangle

    left, right = centres
    dashes = (0, (3, 2))
    for y in (left[1] - side / 2, left[1] + side / 2):
        ax.plot([left[0], right[0]], [y, y], color=_BOX_COLOUR, linewidth=0.5, linestyle=dashes, zorder=3)
    for x, y in centres:
        corner = (x - side / 2, y - side / 2)
        ax.add_patch(Rectangle(corner, side, side, fill=False, color=_BOX_COLOUR, linewidth=1.1, zorder=4))


def _inside(point: FloatArray, width: int, height: int, margin: float) -> bool:
    """Whether a mark that reaches `margin` about a point lies on the image."""
    size = np.array([width, height])
    return bool(np.isfinite(point).all() and (point >= margin).all() and (point <= size - margin).all())


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
