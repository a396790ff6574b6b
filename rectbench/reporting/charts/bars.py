"""Grouped bars: of one metric, a panel a rig and a group a scene; or a panel a metric and a group a pair."""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING

from rectbench.metrics.catalogue import column
from rectbench.reporting.style import COLUMN_INCHES, FAINT, INK, PAGE_INCHES, looks, plain_log_ticks
from rectbench.reporting.tables.labels import pair_labels
from rectbench.runs.run import Result, Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEAST_BAR_INCHES = 0.06
_LABEL_BAR_INCHES = 0.075
_LETTER_INCHES = 0.055
_LOG_FROM = 20.0


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
    linear: frozenset[str] = frozenset()
    """Panels with an axis of their own, linear from 0: of values that are bounded."""


def bar_chart(run: Run, key: str, pose: str, reference: float | None = None) -> BarChart:
    """Collect a metric's bars; `reference` is a value worth a line, in the shown unit."""
    shown_as = column(key)
    panels: dict[str, dict[str, dict[str, Bar]]] = {}
    for rig, motion in product(run.rigs, run.motions):
        results = run.select(rig=rig, motion=motion, pose=pose)
        title = f"{rig}, {motion}" if len(run.motions) > 1 else rig
        groups = {
            scene: {
                method: _bar(run.select(cells, method=method), key, shown_as.scale)
                for method in run.methods
                if any(r.method == method for r in cells)
            }
            for scene in run.scenes
            if (cells := run.select(results, scene=scene))
        }
        if groups:
            panels[title] = groups
    present = {m for groups in panels.values() for bars in groups.values() for m in bars}
    methods = tuple(m for m in run.methods if m in present)
    values = [b.largest for g in panels.values() for bars in g.values() for b in bars.values() if b.largest]
    if reference is not None and not (values and 0.1 * reference < max(values)):
        reference = None  # far above all bars: a line there would press them to the floor
    return BarChart(shown_as.full_heading, shown_as.floor, reference, methods, panels)


def pair_chart(
    run: Run,
    label: str,
    titles: Mapping[str, str],
    pose: str,
    *,
    reference: float | None = None,
    bounded: Collection[str] = (),
) -> BarChart:
    """The bars of metrics of one kind side by side; `titles` names the panel of each column.

    The panels of `bounded` columns stand last and have a linear axis of their own.
    """
    labels = pair_labels(run)
    results = run.select(pose=pose)
    panels: dict[str, dict[str, dict[str, Bar]]] = {}
    for key, title in sorted(titles.items(), key=lambda item: item[0] in bounded):
        if key in run.metrics:
            panels[title] = {
                label: {
                    method: _bar(run.select(results, place=place, method=method), key, column(key).scale)
                    for method in run.methods
                }
                for place, label in labels.items()
                if not _is_not_to_be_had(run.select(results, place=place), key)
            }
    floor = max(column(key).floor for key in titles)
    linear = frozenset(titles[key] for key in bounded if titles[key] in panels)
    if len(linear) == len(panels):
        linear = frozenset()  # no others to set them apart from
    return BarChart(label, floor, reference, run.methods, panels, linear=linear)


def _is_not_to_be_had(results: Sequence[Result], key: str) -> bool:
    """Whether a pair has no such number though nothing failed, as one without a board has no board's."""
    return all(r.ok and key not in r.metrics for r in results)


def stage_chart(run: Run, stages: Mapping[str, str], stated: Mapping[str, float]) -> BarChart:
    """Seconds of each stage (column to name), a panel a rig and width; `stated` are somebody else's."""
    panels = {
        rig: {
            name: {
                method: _bar(run.select(rig=rig, method=method), key, 1.0)
                for method in run.methods
                if run.select(rig=rig, method=method)
            }
            for key, name in stages.items()
            if key in run.metrics
        }
        for rig in run.rigs
    }
    return BarChart("time [s]", 1e-4, None, run.methods, panels, stated)


def _bar(results: Sequence[Result], key: str, scale: float) -> Bar:
    values = [r.metrics[key] * scale for r in results if r.ok and math.isfinite(r.metrics.get(key, math.nan))]
    failed = [r.status for r in results if not r.ok]
    failure = failed[0] if failed else "no value" if len(values) < len(results) else ""
    if not values:
        return Bar(None, None, None, failure or "no value")
    return Bar(sum(values) / len(values), min(values), max(values), failure)


def draw_bars(chart: BarChart) -> Figure:
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
    figure = Figure(figsize=(width, 0.45 + 1.45 * rows + (0.18 if small else 0)), layout="constrained")
    axes = figure.subplots(rows, columns, sharey=not chart.linear, squeeze=False).ravel().tolist()
    slot_inches = (width - 0.5) / columns / slots
    scales = {is_linear: _scale(chart, is_linear) for is_linear in (False, True)}
    for ax, (title, panel) in zip(axes, chart.panels.items(), strict=False):
        log, (bottom, top) = scales[title in chart.linear]
        _draw_panel(ax, chart, panel, bottom, slot_inches)
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
    _add_legend(figure, chart, 3 if small else 6)
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
    bottom: float,
    slot: float,
) -> None:
    colours = looks(chart.methods)
    middle = (len(chart.methods) - 1) / 2
    step = len(chart.methods) + 1
    for g, bars in enumerate(panel.values()):
        for m, method in enumerate(chart.methods):
            if method not in bars:
                continue
            bar, x = bars[method], g * step + m - middle
            if bar.mean is not None and bar.least is not None and bar.largest is not None:
                height = max(bar.mean, chart.floor) - bottom
                ax.bar(x, height, width=0.9, bottom=bottom, color=colours[method][0], linewidth=0)
                if bar.largest > bar.least:
                    span = [max(bar.least, chart.floor), max(bar.largest, chart.floor)]
                    ax.plot([x, x], span, color=INK, linewidth=0.6, solid_capstyle="butt")
            if bar.failure:
                _mark_failure(ax, x, bar, colours[method][0] if bar.mean is None else INK, slot)
    for g, name in enumerate(panel):
        if name in chart.stated:
            _mark_stated(ax, g * step, step / 2 - 0.2, chart.stated[name])
    ax.set_xlim(-step / 2, (len(panel) - 0.5) * step)
    names = [_wrapped(name, slot * step) for name in panel]
    crowded = max(len(line) for name in names for line in name.split("\n")) * _LETTER_INCHES > slot * step
    ax.set_xticks(
        [g * step for g in range(len(panel))],
        names,
        rotation=25 if crowded else 0,
        ha="right" if crowded else "center",
        rotation_mode="anchor" if crowded else "default",
    )
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
        f"{value:g}",
        (x, value),
        xytext=(0, 1.5),
        textcoords="offset points",
        ha="center",
        size=6.5,
        color=INK,
    )


def _mark_failure(ax: Axes, x: float, bar: Bar, colour: str, slot: float) -> None:
    """A cross at the foot of the gap, with the status beside it where it fits."""
    at_foot = ax.get_xaxis_transform()
    ax.plot(
        [x],
        [0.035],
        marker="x",
        markersize=3.2,
        markeredgewidth=1.1,
        color=colour,
        transform=at_foot,
        zorder=4,
    )
    if bar.mean is None and slot >= _LABEL_BAR_INCHES:
        ax.text(
            x,
            0.09,
            bar.failure,
            transform=at_foot,
            rotation=90,
            size=5,
            color=FAINT,
            ha="center",
            va="bottom",
        )


def _add_legend(figure: Figure, chart: BarChart, columns: int) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colours = looks(chart.methods)
    handles: list[Artist] = [Patch(color=colours[m][0], label=m) for m in chart.methods]
    if any(b.failure for panel in chart.panels.values() for group in panel.values() for b in group.values()):
        cross = Line2D([], [], linestyle="", marker="x", markersize=3.2, color=INK, label="not measured")
        handles.append(cross)
    if chart.stated:
        handles.append(Line2D([], [], color=INK, linewidth=1.4, label="stated"))
    figure.legend(handles=handles, loc="outside upper center", ncols=min(columns, len(handles)))
