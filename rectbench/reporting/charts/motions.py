"""Which method serves which lens under which motion: a disc for each, as large as the view that it keeps."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.plugins.result import Part, Result, distinct
from rectbench.reporting.curves import ranked_by
from rectbench.reporting.style import FAINT, INK, LOST, PAGE_INCHES

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize

KEPT = "coverage_pixels"
"""The column that is the area of a disc: a share of the whole lens, trimmed cones included."""
LEAST_MOTIONS = 3
"""With fewer, tables and bars show the same."""
_CELL_INCHES, _LETTER_INCHES = 0.235, 0.058
_HEAD_INCHES, _FOOT_INCHES = 0.32, 0.6
_COLUMNS = 2
_RADIUS = 0.47
"""Of a disc that keeps all, in cells."""
_COLOURS = "viridis_r"
_FRAME: dict[str, Any] = {"facecolor": "none", "edgecolor": INK, "linewidth": 1.1}
_RING: dict[str, Any] = {"facecolor": "none", "edgecolor": LOST, "linewidth": 0.4}
_BAR_INCHES = 1.9
_SHARES = (0.1, 0.5, 1.0)
"""In the legend."""


@dataclass(frozen=True)
class Served:
    """A method on a lens under a motion."""

    kept: float
    """Share of the lens's pixels, the mean of the cells; 0 where the method does not serve."""
    distortion: float | None
    """At equal view; None where the method does not keep so much of it."""
    serves: bool


@dataclass(frozen=True)
class ServedMotions:
    """All that the chart shows: by lens, method and motion."""

    label: str
    methods: tuple[str, ...]
    motions: tuple[str, ...]
    panels: tuple[tuple[str, tuple[tuple[Served | None, ...], ...]], ...]
    """The lens's name, and a row a method of a cell a motion; None where there is no such cell."""


class Motions(Figure):
    """Which methods serve which lens under which motion, how much they keep, and how they distort it."""

    name = "motions"
    topic = "Charts"

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, of a part with three motions or more."""
        data = served_motions(given.part)
        if len(data.motions) < LEAST_MOTIONS:
            return
        yield Drawing(
            "motions",
            "Lenses and motions",
            "A disc is as large as the share of the lens's pixels that the method keeps, of the whole lens, "
            f"its ring being all of it; its colour is {data.label}, grey where the method does not keep so "
            "much. The least in each column is framed. A cross marks what a method does not serve.",
            data,
            lambda: draw_motions(data),
        )


def served_motions(part: Part) -> ServedMotions:
    """The means over scenes and seeds, under the pose that shows distortion."""
    results = part.select(pose=part.geometric_pose)
    methods, motions = part.methods, distinct(r.motion for r in results)
    ranking = part.catalogue.ranking
    panels = tuple(
        (
            rig,
            tuple(
                tuple(
                    _served(part.select(results, rig=rig, method=method, motion=motion), ranking.key)
                    for motion in motions
                )
                for method in methods
            ),
        )
        for rig in distinct(r.rig for r in results)
    )
    return ServedMotions(ranked_by(part.catalogue), methods, motions, panels)


def _served(cells: Sequence[Result], ranking: str) -> Served | None:
    if not cells:
        return None
    kept = [cell.metrics.get(KEPT, 0.0) for cell in cells if cell.ok]
    logs = [math.log(cell.metrics[ranking]) for cell in cells if cell.metrics.get(ranking, 0.0) > 0]
    whole = len(logs) == len(cells)
    distortion = math.exp(sum(logs) / len(logs)) if whole else None
    return Served(sum(kept) / len(cells), distortion, len(kept) == len(cells))


def draw_motions(data: ServedMotions) -> matplotlib.figure.Figure:
    """A panel a lens: methods down, motions across."""
    import matplotlib.figure
    from matplotlib.colors import Normalize

    found = [s.distortion for _, rows in data.panels for row in rows for s in row if s and s.distortion]
    norm = Normalize(0.0, max(found, default=1.0))
    columns = min(_COLUMNS, len(data.panels))
    rows = math.ceil(len(data.panels) / columns)
    names = _LETTER_INCHES * max(map(len, data.methods)) + 0.08
    cell = min(_CELL_INCHES, (PAGE_INCHES - names - 0.15 * columns) / (columns * len(data.motions)))
    slant = 0.62 * _LETTER_INCHES * max(map(len, data.motions)) + 0.1
    panel = cell * len(data.methods), cell * len(data.motions)
    width = names + columns * panel[1] + 0.15 * (columns - 1) + 0.3
    height = slant + rows * (panel[0] + _HEAD_INCHES) + _FOOT_INCHES
    figure = matplotlib.figure.Figure(figsize=(width, height))
    for place, (rig, served) in enumerate(data.panels):
        down, across = divmod(place, columns)
        left = names + across * (panel[1] + 0.15)
        top = height - _HEAD_INCHES * (down + 1) - panel[0] * down + 0.1
        box = left / width, (top - panel[0]) / height, panel[1] / width, panel[0] / height
        ax = figure.add_axes(box)
        ax.set_title(rig)
        _draw_panel(ax, served, norm)
        is_lowest = place + columns >= len(data.panels)
        ax.set_xticks(range(len(data.motions)), data.motions if is_lowest else [""] * len(data.motions))
        ax.tick_params(axis="x", labelrotation=38, length=0)
        for label in ax.get_xticklabels():
            label.set(ha="right", rotation_mode="anchor")
        ax.set_yticks(range(len(data.methods)), data.methods if across == 0 else [""] * len(data.methods))
        ax.tick_params(axis="y", length=0)
    _draw_legend(figure, data, norm, cell, (width, height, names))
    return figure


def _draw_panel(ax: Axes, served: Sequence[Sequence[Served | None]], norm: Normalize) -> None:
    from matplotlib import colormaps
    from matplotlib.patches import Circle, Rectangle

    for m in range(len(served[0])):
        column = [row[m] for row in served]
        known = [s.distortion for s in column if s and s.distortion is not None]
        for y, one in enumerate(column):
            if one is None:
                continue
            if not one.serves:
                ax.plot([m], [y], marker="x", markersize=3.2, markeredgewidth=0.8, color=FAINT)
                continue
            colour: Any = LOST if one.distortion is None else colormaps[_COLOURS](norm(one.distortion))
            ax.add_patch(Circle((m, y), _RADIUS, **_RING))
            ax.add_patch(Circle((m, y), _RADIUS * math.sqrt(one.kept), facecolor=colour, linewidth=0))
            if known and one.distortion == min(known):
                corner = m - 0.5, y - 0.5
                ax.add_patch(Rectangle(corner, 1, 1, clip_on=False, **_FRAME))
    ax.set_xlim(-0.5, len(served[0]) - 0.5)
    ax.set_ylim(len(served) - 0.5, -0.5)
    for spine in ax.spines.values():
        spine.set_visible(False)


def _draw_legend(
    figure: matplotlib.figure.Figure,
    data: ServedMotions,
    norm: Normalize,
    cell: float,
    inches: tuple[float, float, float],
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.patches import Circle

    width, height, names = inches
    entries = 3 * len(_SHARES)
    left = max(0.1, min(names, width - _BAR_INCHES - 0.4 - entries * cell - 0.2))
    place = figure.add_axes((left / width, 0.27 / height, _BAR_INCHES / width, 0.09 / height))
    bar = figure.colorbar(ScalarMappable(norm, _COLOURS), cax=place, orientation="horizontal")
    bar.outline.set_linewidth(0.4)
    figure.text(left / width, 0.42 / height, data.label, size=6.5)
    right = left + _BAR_INCHES + 0.4
    ax = figure.add_axes((right / width, 0.14 / height, entries * cell / width, cell / height))
    for number, share in enumerate(_SHARES):
        x = 3 * number
        ax.add_patch(Circle((x, 0), _RADIUS, **_RING))
        ax.add_patch(Circle((x, 0), _RADIUS * math.sqrt(share), facecolor=FAINT, linewidth=0))
        ax.text(x + 0.7, 0, f"{100 * share:.0f} %", va="center", size=6.5)
    ax.set_xlim(-0.5, entries - 0.5)
    ax.set_ylim(0.5, -0.5)
    ax.set_axis_off()
    figure.text(right / width, 0.42 / height, "share of the lens's pixels kept", size=6.5)
