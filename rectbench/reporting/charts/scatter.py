"""Distortion against coverage as points, one panel a measure of distortion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rectbench.plugins.catalogue import column
from rectbench.plugins.figure import Drawing, Figure, FigureData, Look
from rectbench.plugins.result import Part
from rectbench.reporting.style import COLUMN_INCHES, FAINT, INK, PAGE_INCHES, PAPER, plain_log_ticks

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.lines import Line2D

_LOG_FROM = 20.0
Points = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Scatter:
    """Points (coverage, distortion) by method, one panel a measure of distortion, in shown units."""

    label_x: str
    label_y: tuple[str, ...]
    methods: tuple[str, ...]
    panels: tuple[Mapping[str, Points], ...]
    missing: Mapping[str, int]


class DistortionCoverage(Figure):
    """Distortion against coverage: a point a cell, so that what was bought with field of view shows."""

    name = "scatter"
    topic = "Charts"
    usual = 2

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, where both were measured."""
        metrics = given.part.metrics
        coverage = next((k for k in ("coverage_solid_angle", "coverage_pixels") if k in metrics), None)
        measures = tuple(k for k in (given.part.catalogue.ranking.key, "distortion_rescaled") if k in metrics)
        if coverage and measures:
            data = scatter(given.part, coverage, measures)
            yield Drawing(
                "distortion-coverage",
                "Distortion against coverage",
                "Small: a pair. Large: the method's mean. Best is low and to the right: little distortion, "
                "and the whole field of view kept.",
                data,
                lambda: draw_scatter(data, given.looks),
            )


def scatter(run: Part, key_x: str, keys_y: tuple[str, ...]) -> Scatter:
    """Collect the points of the pose under which distortion is shown; cells without both are counted."""
    results = run.select(pose=run.geometric_pose)
    x = column(key_x)
    panels, missing = [], dict.fromkeys(run.methods, 0)
    for key in keys_y:
        points: dict[str, Points] = {}
        for method in run.methods:
            cells = run.select(results, method=method)
            pairs = [(c.metrics.get(key_x, math.nan), c.metrics.get(key, math.nan)) for c in cells if c.ok]
            points[method] = tuple(
                (a * x.scale, b) for a, b in pairs if math.isfinite(a) and math.isfinite(b)
            )
            missing[method] = max(missing[method], len(cells) - len(points[method]))
        panels.append(points)
    labels = tuple(column(key).full_heading for key in keys_y)
    return Scatter(x.full_heading, labels, run.methods, tuple(panels), missing)


def draw_scatter(data: Scatter, looks: Mapping[str, Look]) -> matplotlib.figure.Figure:
    """Draw small points for cells and a large one for each method's mean."""
    import matplotlib.figure

    width = PAGE_INCHES if len(data.panels) > 1 else COLUMN_INCHES
    legend_columns = 3 if width == COLUMN_INCHES else 5
    height = 2.45 + 0.15 * math.ceil(len(data.methods) / legend_columns)
    figure = matplotlib.figure.Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(1, len(data.panels), squeeze=False)[0]
    for ax, label, panel in zip(axes, data.label_y, data.panels, strict=True):
        for method, points in panel.items():
            if not points:
                continue
            xs, ys = zip(*points, strict=True)
            colour, marker, _ = looks[method]
            ax.scatter(xs, ys, s=9, color=colour, marker=marker, alpha=0.55, linewidth=0)
            mean = sum(xs) / len(xs), sum(ys) / len(ys)
            ax.scatter(*mean, s=46, color=colour, marker=marker, edgecolor=INK, linewidth=0.8, zorder=3)
        values = [y for points in panel.values() for _, y in points if y > 0]
        if values and max(values) / min(values) >= _LOG_FROM:
            ax.set_yscale("log")
            plain_log_ticks(ax.yaxis)
        elif values:
            ax.set_ylim(bottom=0)
        else:
            ax.text(0.5, 0.5, "no cell has both", transform=ax.transAxes, ha="center", color=FAINT)
        shares = [x for points in panel.values() for x, _ in points]
        if shares:
            least = min(shares)
            room = max(1.0, 0.06 * (100 - least))
            ax.set_xlim(max(0.0, least - room), 100 + room if max(shares) <= 100 else None)
        ax.set_xlabel(f"{data.label_x}  →")
        ax.set_ylabel(f"←  {label}")
        ax.grid(color="#dddddd", linewidth=0.5)
    figure.legend(
        handles=[_handle(data, m, looks[m]) for m in data.methods],
        loc="outside upper center",
        ncols=legend_columns,
    )
    return figure


def _handle(data: Scatter, method: str, look: Look) -> Line2D:
    """The method's mark in the legend, without a rim where it has no point."""
    from matplotlib.lines import Line2D

    missing, rim = data.missing[method], INK if any(points[method] for points in data.panels) else PAPER
    label = f"{method} ({missing} not measured)" if missing else method
    mark: dict[str, Any] = {"markersize": 5.5, "markeredgecolor": rim, "markeredgewidth": 0.6}
    return Line2D([], [], linestyle="", marker=look.marker, color=look.colour, label=label, **mark)
