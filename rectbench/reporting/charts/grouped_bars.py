"""Grouped bars: a panel for each title, in it groups of one bar a method; drawn for several figures."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rectbench.plugins.figure import Drawing, FigureData, Look
from rectbench.plugins.result import Result
from rectbench.reporting.style import COLUMN_INCHES, FAINT, INK, PAGE_INCHES, PAPER, plain_log_ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEAST_BAR_INCHES = 0.06
_LABEL_BAR_INCHES = 0.075
_LETTER_INCHES = 0.055
_LOG_FROM = 20.0
NO_VALUE = "no value"
"""Why there is no bar though nothing failed."""
_CROSS: dict[str, Any] = {"marker": "x", "markersize": 3.2}


@dataclass(frozen=True)
class Bar:
    """One method on one pair, over seeds: mean, least and largest value, or why there is none."""

    mean: float | None
    least: float | None
    largest: float | None
    failure: str


@dataclass(frozen=True)
class BarChart:
    """All a chart shows, in the shown unit; `panels` maps title -> group -> method -> Bar."""

    label: str
    floor: float
    reference: float | None
    methods: tuple[str, ...]
    panels: Mapping[str, Mapping[str, Mapping[str, Bar]]]
    stated: Mapping[str, float] = field(default_factory=dict)
    """Values that somebody else states, by group."""
    linear: tuple[str, ...] = ()
    """Panels with an axis of their own, linear from 0: of values that are bounded. No set: its order, and so
    the digest of the drawing, would differ from one process to another."""


def bar_of(results: Sequence[Result], key: str, scale: float) -> Bar:
    """The mean of a column over cells, times `scale`, with its range."""
    values = [r.metrics[key] * scale for r in results if r.ok and math.isfinite(r.metrics.get(key, math.nan))]
    failed = [r.status for r in results if not r.ok]
    failure = failed[0] if failed else NO_VALUE if len(values) < len(results) else ""
    if not values:
        return Bar(None, None, None, failure or NO_VALUE)
    return Bar(sum(values) / len(values), min(values), max(values), failure)


def bar_drawing(
    chart: BarChart, given: FigureData, stem: str, title: str, caption: str, of: str = ""
) -> Drawing:
    """The chart as a drawing, its caption ended by what its marks mean."""
    words = [caption]
    if chart.reference is not None:
        words.append(f"The dashed line is at {chart.reference:g} px.")
    bars = [bar for groups in chart.panels.values() for group in groups.values() for bar in group.values()]
    if any(bar.least != bar.largest for bar in bars):
        over = "seeds" if len({r.seed for r in given.part.results}) > 1 else "pairs and poses"
        words.append(f"Bars are means over {over}, thin lines their range.")
    if given.part.failures:
        words.append("A cross marks a method that could not be measured there.")
    return Drawing(stem, title, " ".join(words), chart, lambda: draw_bars(chart, given.looks), of)


def draw_bars(chart: BarChart, looks: Mapping[str, Look]) -> Figure:
    """Draw the chart: shared vertical axis but for linear panels, a cross where a bar is missing."""
    from matplotlib.figure import Figure

    groups = max(len(panel) for panel in chart.panels.values())
    slots = groups * (len(chart.methods) + 1)
    small = len(chart.panels) == 1 and slots * _LABEL_BAR_INCHES < COLUMN_INCHES - 0.5
    width = COLUMN_INCHES if small else PAGE_INCHES
    least = max(slots * _LEAST_BAR_INCHES, groups * _longest_word(chart) * _LETTER_INCHES)
    most = max(1, int((width - 0.5) / least))
    columns = min(len(chart.panels), 4, most)
    columns = math.ceil(len(chart.panels) / math.ceil(len(chart.panels) / columns))
    rows = math.ceil(len(chart.panels) / columns)
    legend_columns = 3 if small else 6
    legend_rows = math.ceil(len(chart.methods) / legend_columns)
    height = 0.3 + 0.15 * legend_rows + 1.45 * rows
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, sharey=not chart.linear, squeeze=False).ravel().tolist()
    slot_inches = (width - 0.5) / columns / slots
    scales = {is_linear: _scale(chart, is_linear) for is_linear in (False, True)}
    for ax, (title, panel) in zip(axes, chart.panels.items(), strict=False):
        log, (bottom, top) = scales[title in chart.linear]
        _draw_panel(ax, chart, panel, looks, bottom, slot_inches)
        ax.set_title(title)
        ax.set_yscale("log" if log else "linear")
        ax.set_ylim(bottom, top)
        if log:
            plain_log_ticks(ax.yaxis)
        ax.grid(axis="y")
        if chart.reference is not None:
            ax.axhline(chart.reference, color=INK, linewidth=0.7, linestyle=(0, (4, 2)), zorder=1)
    for ax in axes[len(chart.panels) :]:
        ax.set_axis_off()
    for ax in axes[: len(chart.panels) : columns]:
        ax.set_ylabel(chart.label)
    _add_legend(figure, chart, looks, legend_columns)
    return figure


def _scale(chart: BarChart, is_linear: bool) -> tuple[bool, tuple[float, float]]:
    """Whether the axis of the linear panels, or of the others, is logarithmic, and its limits."""
    panels = [panel for title, panel in chart.panels.items() if (title in chart.linear) == is_linear]
    bars = [b for panel in panels for group in panel.values() for b in group.values()]
    largest = [max(b.largest, chart.floor) for b in bars if b.largest is not None]
    least = [max(b.least, chart.floor) for b in bars if b.least is not None]
    positive = [value for value in least + largest if value > 0]
    if not positive:
        return False, (0.0, 1.0)
    positive += chart.stated.values()
    if max(positive) <= chart.floor:
        return True, (0.1 * chart.floor, 1e3 * chart.floor)  # all below what is shown as a number
    low, high = min(positive), max(positive)
    high = max(high, chart.reference or 0.0)
    if is_linear or high / low < _LOG_FROM:
        return False, (0.0, high * 1.08)
    bottom = 10.0 ** (math.floor(math.log10(low) - 0.15))
    return True, (bottom, high * (high / bottom) ** 0.06)


def _draw_panel(
    ax: Axes,
    chart: BarChart,
    panel: Mapping[str, Mapping[str, Bar]],
    looks: Mapping[str, Look],
    bottom: float,
    slot: float,
) -> None:
    middle = (len(chart.methods) - 1) / 2
    step = len(chart.methods) + 1
    for g, bars in enumerate(panel.values()):
        for m, method in enumerate(chart.methods):
            if method not in bars:
                continue
            bar, x = bars[method], g * step + m - middle
            if bar.mean is not None and bar.least is not None and bar.largest is not None:
                height = max(bar.mean, chart.floor) - bottom
                ax.bar(x, height, width=0.9, bottom=bottom, **_fill(looks[method]))
                if bar.largest > bar.least:
                    span = [max(bar.least, chart.floor), max(bar.largest, chart.floor)]
                    ax.plot([x, x], span, color=INK, linewidth=0.6, solid_capstyle="butt")
            if bar.failure:
                _mark_failure(ax, x, bar, looks[method].colour if bar.mean is None else INK, slot)
    for g, name in enumerate(panel):
        if name in chart.stated:
            _mark_stated(ax, g * step, step / 2 - 0.2, chart.stated[name])
    ax.set_xlim(-step / 2, (len(panel) - 0.5) * step)
    names = [_wrapped(name, slot * step) for name in panel]
    crowded = max(len(line) for name in names for line in name.split("\n")) * _LETTER_INCHES > slot * step
    slanted: dict[str, Any] = {"rotation": 25, "ha": "right", "rotation_mode": "anchor"}
    ax.set_xticks([g * step for g in range(len(panel))], names, **(slanted if crowded else {}))
    ax.tick_params(axis="x", length=0)


def _longest_word(chart: BarChart) -> int:
    """Letters of the longest part that names of several lines cannot be broken within."""
    names = [name for panel in chart.panels.values() for name in panel if "\n" in name]
    return max((len(word) for name in names for word in re.findall(r"[^\s-]+-?", name)), default=0)


def _wrapped(name: str, inches: float) -> str:
    """A name of several lines with its long ones broken at hyphens and blanks; one line stays one."""
    lines = name.split("\n")
    if len(lines) == 1:
        return name
    letters = max(1, int(inches / _LETTER_INCHES))
    return "\n".join(part for line in lines for part in textwrap.wrap(line, letters, break_long_words=False))


def _mark_stated(ax: Axes, x: float, reach: float, value: float) -> None:
    """A stated value as a line over its group, with the number on it."""
    ax.plot([x - reach, x + reach], [value, value], color=INK, linewidth=1.4, solid_capstyle="butt")
    ax.annotate(
        f"{value:g}", (x, value), (0, 1.5), textcoords="offset points", ha="center", size=6.5, color=INK
    )


def _mark_failure(ax: Axes, x: float, bar: Bar, colour: str, slot: float) -> None:
    """A cross at the foot of the gap, with the status beside it where it fits."""
    at_foot = ax.get_xaxis_transform()
    ax.plot([x], [0.035], **_CROSS, markeredgewidth=1.1, color=colour, transform=at_foot, zorder=4)
    if bar.mean is None and slot >= _LABEL_BAR_INCHES:
        upright: dict[str, Any] = {"rotation": 90, "ha": "center", "va": "bottom"}
        ax.text(x, 0.09, bar.failure, transform=at_foot, size=5, color=FAINT, **upright)


def _fill(look: Look) -> dict[str, Any]:
    """How a bar is filled; hatches take the colour of the edge."""
    return {"facecolor": look.colour, "edgecolor": PAPER, "hatch": look.hatch, "linewidth": 0}


def _add_legend(figure: Figure, chart: BarChart, looks: Mapping[str, Look], columns: int) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Artist] = [Patch(**_fill(looks[m]), label=m) for m in chart.methods]
    if any(b.failure for panel in chart.panels.values() for group in panel.values() for b in group.values()):
        handles.append(Line2D([], [], **_CROSS, linestyle="", color=INK, label="not measured"))
    if chart.stated:
        handles.append(Line2D([], [], color=INK, linewidth=1.4, label="stated"))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(columns, len(handles)))
