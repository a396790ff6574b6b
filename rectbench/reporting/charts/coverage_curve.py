"""Distortion against coverage: a curve a method, on growing shares of the view, a panel a rig."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rectbench.plugins.figure import Drawing, Figure, FigureData, Look
from rectbench.reporting.curves import RigCurves, ranked_share, rig_curves
from rectbench.reporting.shares import measure
from rectbench.reporting.style import COLUMN_INCHES, FAINT, INK, PAGE_INCHES, plain_log_ticks

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

_MOST_COLUMNS = 5
_PANEL_INCHES = 1.42
_MARK_INCHES, _LETTER_INCHES = 0.4, 0.055
"""Of an entry of the legend in width."""
_TICKS = (10, 50, 95)
_FLOOR_SHARE = 30
"""So far from the share that it is the floor of the floor's line reaches."""
_FLOOR_LINE: Mapping[str, Any] = {"color": INK, "linewidth": 1.0, "linestyle": (0, (1, 0.7))}
_ALIKE = 1.08
"""Curves whose values differ by less than this factor lie on one another: they are a line's width apart."""
_DASH, _MARK, _RING = 2.6, 3.0, 1.7
"""Points: of a dash where curves lie on one another, of a curve's mark, and of what is seen of one behind."""
_LEAST = 1e-3
"""Less log distortion than this is as good as none, and drawn here."""


@dataclass(frozen=True)
class CoverageCurves:
    """All that the chart shows; `ranked_at` is the share (%) that methods are ranked at."""

    label: str
    methods: tuple[str, ...]
    panels: tuple[RigCurves, ...]
    ranked_at: int


class DistortionCoverage(Figure):
    """Distortion against coverage: a curve a method, so that what was bought with field of view shows."""

    name = "coverage-curve"
    topic = "Charts"
    usual = 2

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, where any method has a number on a share of the view."""
        part = given.part
        panels, ranked_at = rig_curves(part), ranked_share(part.catalogue)
        if panels and ranked_at is not None:
            label = measure(part.catalogue.ranking)
            data = CoverageCurves(label, part.methods, panels, ranked_at)
            yield Drawing(
                "distortion-coverage",
                "Distortion against coverage",
                f"{label.capitalize()} on the share of the view that is nearest to its middle, on the same "
                "source pixels for all methods; below a share, the field of view in degrees. A curve ends "
                f"where its method shows no more. Lower is better; the dotted line is at {ranked_at} %."
                f"{_FLOOR_TEXT.format(ranked_at) if any(panel.floor for panel in panels) else ''}"
                f"{_ALIKE_TEXT if any(map(_has_alike, panels)) else ''}",
                data,
                lambda: draw_curves(data, given.looks),
            )


def draw_curves(data: CoverageCurves, looks: Mapping[str, Look]) -> matplotlib.figure.Figure:
    """Small panels on common axes; each curve ends in its method's mark."""
    import matplotlib.figure

    columns = min(_MOST_COLUMNS, len(data.panels))
    columns = math.ceil(len(data.panels) / math.ceil(len(data.panels) / columns))
    width = COLUMN_INCHES if len(data.panels) == 1 else PAGE_INCHES
    rows = math.ceil(len(data.panels) / columns)
    longest = max(len(_label(data, method)) for method in data.methods)
    fitting = max(1, int(width / (_MARK_INCHES + _LETTER_INCHES * longest)))
    legend_columns = min(fitting, len(data.methods) + 1)
    panel = _PANEL_INCHES if columns > 2 else 2.1
    height = 0.35 + 0.15 * math.ceil((len(data.methods) + 1) / legend_columns) + panel * rows
    figure = matplotlib.figure.Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for ax, one in zip(axes.flat, data.panels, strict=False):
        _draw_panel(ax, one, data, looks)
    for ax in axes.flat[len(data.panels) :]:
        ax.set_axis_off()
    axes[0, 0].set_yscale("log")
    plain_log_ticks(axes[0, 0].yaxis)
    figure.supylabel(f"←  {data.label}", size=7)
    figure.supxlabel("share of the view [%], and field of view", size=7)
    figure.legend(
        handles=_handles(data, looks),
        loc="outside upper center",
        ncols=legend_columns,
    )
    return figure


def _draw_panel(ax: Axes, one: RigCurves, data: CoverageCurves, looks: Mapping[str, Look]) -> None:
    ax.set_title(one.rig)
    ax.axvline(data.ranked_at, color=FAINT, linewidth=0.6, linestyle=":", zorder=1)
    if one.floor is not None:
        level = max(one.floor, _LEAST)
        ax.plot([data.ranked_at - _FLOOR_SHARE, 104], [level, level], zorder=1, **_FLOOR_LINE)
    for group in alike(one):
        for place, method in enumerate(group):
            curve, (colour, marker, _) = one.curves[method], looks[method]
            values = [max(value, _LEAST) for value in curve.values()]
            ax.plot(list(curve), values, color=colour, linestyle=_dashes(place, len(group)))
            size = _MARK + _RING * (len(group) - 1 - place)
            ax.plot(list(curve)[-1], values[-1], color=colour, marker=marker, markersize=size)
    ax.set_xlim(0, 104)
    ticks = [data.ranked_at if tick == _TICKS[-1] else tick for tick in _TICKS]
    ax.set_xticks(ticks, [_tick(one, tick) for tick in ticks])
    ax.grid(color="#dddddd", linewidth=0.5)


def _dashes(place: int, of: int) -> str | tuple[float, tuple[float, float]]:
    """The dashes of one of several curves that take turns; a curve of its own has none."""
    return "-" if of == 1 else ((of - place) * _DASH, (_DASH, (of - 1) * _DASH))


def alike(one: RigCurves) -> list[list[str]]:
    """The methods that have a curve, those whose curves lie on one another together."""
    groups: list[list[str]] = []
    for method in (m for m, curve in one.curves.items() if curve):
        group = next((g for g in groups if _lie_together(one.curves[g[0]], one.curves[method])), None)
        if group is None:
            groups.append([method])
        else:
            group.append(method)
    return groups


def _lie_together(curve: Mapping[int, float], other: Mapping[int, float]) -> bool:
    ratios = [max(curve[s], _LEAST) / max(other[s], _LEAST) for s in curve if s in other]
    return bool(ratios) and max(max(ratio, 1 / ratio) for ratio in ratios) < _ALIKE


def _has_alike(one: RigCurves) -> bool:
    return any(len(group) > 1 for group in alike(one))


_FLOOR_LABEL = "floor"
_FLOOR_TEXT = " The level line is the floor: the least at {} % that any rectification to scan lines can have."
_ALIKE_TEXT = " Curves that lie on one another take turns in dashes, their marks one around the other."


def _tick(one: RigCurves, share: int) -> str:
    view = one.view_deg(share)
    return f"{share}" if view is None else f"{share}\n{view:.0f}°"


def _handles(data: CoverageCurves, looks: Mapping[str, Look]) -> Sequence[object]:
    from matplotlib.lines import Line2D

    curves = [
        Line2D([], [], color=looks[m].colour, marker=looks[m].marker, markersize=3, label=_label(data, m))
        for m in data.methods
    ]
    has_floor = any(one.floor is not None for one in data.panels)
    return [*curves, *([Line2D([], [], label=_FLOOR_LABEL, **_FLOOR_LINE)] if has_floor else [])]


def _label(data: CoverageCurves, method: str) -> str:
    """The method, and that it has no curve, so that nobody looks for one."""
    return method if any(one.curves.get(method) for one in data.panels) else f"{method} (no curve)"
