"""Distortion against how much of a map to scan lines is free: what freedoms gain, what scan lines cost."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from rectbench.plugins.figure import Drawing, Figure, FigureData, Look
from rectbench.plugins.result import Part, Result
from rectbench.reporting.style import FAINT, INK, PAGE_INCHES, plain_log_ticks

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

FREE = "optimal"
MEASURES = {"log": ("log_distortion", "log distortion"), "L": ("distortion_rescaled", "L, best scale")}
"""By objective, the column that it minimises over all of the view, and that one's words."""
CLOSED = {"abraham": 3, "local-homography": 9}
"""Coefficients of closed forms: of the columns of either image, and of the rows."""
ENOUGH_GAIN = 1e-3
_MARKS = {"separable": "o", "full": "s", "per-image": "x"}
_WORDS = {
    "separable": "columns h(γ)",
    "full": "columns h(β, γ)",
    "per-image": "h(β, γ), rows not shared",
}


class Point(NamedTuple):
    """A form's number of free coefficients, and its distortion: the geometric mean over rigs."""

    coefficients: float
    distortion: float


@dataclass(frozen=True)
class Freedom:
    """Of one objective: free forms by their kind, in the order of their coefficients, and closed forms."""

    objective: str
    label: str
    free: Mapping[str, tuple[Point, ...]]
    closed: Mapping[str, Point]
    rigs: int

    @property
    def least(self) -> Point:
        """The floor: full columns and shared rows."""
        return min(self.free["full"], key=lambda point: point.distortion)

    @property
    def enough(self) -> Point:
        """The first of the full ones after which no refinement gains a thousandth."""
        points = self.free["full"]
        return next(p for p in points if p.distortion <= (1 + ENOUGH_GAIN) * self.least.distortion)


class FreedomChart(Figure):
    """Distortion against the number of free coefficients, and what is gained by which of them."""

    name = "freedom"
    topic = "Charts"

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, of a part in which free forms of several sizes ran under both objectives."""
        data = [freedom(given.part, objective) for objective in MEASURES]
        if not all(one.free.keys() == _MARKS.keys() for one in data):
            return
        yield Drawing(
            "freedom",
            "What each freedom gains",
            "Distortion over all of the view against the number of free coefficients, geometric means over "
            f"{data[0].rigs} rigs; the level line is the floor. {' '.join(sentences(data))}",
            data,
            lambda: draw_freedom(data, given.looks),
        )


def sentences(data: list[Freedom]) -> tuple[str, str, str]:
    """What is gained by free lines, what sharing rows costs, and what scan lines cost at all."""

    lines = [1 - one.least.distortion / min(p.distortion for p in one.free["separable"]) for one in data]
    sharing = [_nearest(one).distortion / one.free["per-image"][0].distortion - 1 for one in data]
    above = [one.closed["local-homography"].distortion / one.least.distortion - 1 for one in data]
    enough = " and ".join(dict.fromkeys(f"{one.enough.coefficients:.0f}" for one in data))
    left = " and ".join(f"{one.least.distortion:.3g} in {one.label}" for one in data)
    return (
        f"Lines that are each as is best for it gain {_both(lines)} over columns that all lines share, and "
        f"beyond {enough} coefficients nothing gains a thousandth more.",
        f"Rows that both images share cost {_both(sharing)} over rows of each image's own.",
        f"The source images as they are have no distortion, so what is left, {left}, is the price of scan "
        f"lines; the paper's cubics are {_both(above)} above it.",
    )


def _both(shares: list[float]) -> str:
    log, L = (f"{round(share, 3) + 0.0:.1%}" for share in shares)  # without a sign before 0
    return f"{log} (log distortion) and {L} (L)"


def _nearest(one: Freedom) -> Point:
    """The full form that differs from the one with rows not shared in these alone."""
    beyond = one.free["per-image"][0].coefficients
    return max((p for p in one.free["full"] if p.coefficients < beyond), key=lambda p: p.coefficients)


def freedom(part: Part, objective: str) -> Freedom:
    """What a part has of one objective; forms that failed on a rig are left out."""
    column, label = MEASURES[objective]
    results = part.select(pose=part.geometric_pose)
    kinds: dict[str, dict[str, list[Result]]] = {}
    for result in results:
        told = result.options
        if result.cell.method == FREE and told.get("objective") == objective:
            kind = told["rows"] if told.get("rows") == "per-image" else told.get("columns", "full")
            kinds.setdefault(kind, {}).setdefault(result.method, []).append(result)
    free = {}
    for kind, forms in kinds.items():
        points = (
            Point(float(own[0].notes["coefficients"]), mean)
            for own in forms.values()
            if own[0].ok and (mean := _mean(own, column)) is not None
        )
        if found := tuple(sorted(points)):
            free[kind] = found
    closed = {
        method: Point(count, mean)
        for method, count in CLOSED.items()
        if (mean := _mean([r for r in results if r.cell.method == method], column)) is not None
    }
    return Freedom(objective, label, free, closed, len(part.rigs))


def _mean(results: list[Result], column: str) -> float | None:
    values = [r.metrics.get(column, 0.0) for r in results]
    if not values or min(values) <= 0:
        return None
    return math.exp(sum(map(math.log, values)) / len(values))


def draw_freedom(data: list[Freedom], looks: Mapping[str, Look]) -> matplotlib.figure.Figure:
    """A panel a measure."""
    import matplotlib.figure

    figure = matplotlib.figure.Figure(figsize=(PAGE_INCHES, 2.6), layout="constrained")
    axes = figure.subplots(1, len(data), squeeze=False)[0]
    for ax, one in zip(axes, data, strict=True):
        _draw_panel(ax, one, looks)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    figure.supxlabel("free coefficients", size=7)
    return figure


def _draw_panel(ax: Axes, one: Freedom, looks: Mapping[str, Look]) -> None:
    ax.set_title(one.label)
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.axhline(one.least.distortion, color=FAINT, linewidth=0.6, linestyle=":")
    for kind, marker in _MARKS.items():
        style: dict[str, Any] = {"marker": marker, "markersize": 3.5, "label": _WORDS[kind]}
        colour = INK if kind != "separable" else FAINT
        ax.plot(*zip(*one.free[kind], strict=True), color=colour, linewidth=1.0, **style)
    for method, point in one.closed.items():
        look = looks[method]
        ax.plot(*point, color=look.colour, marker=look.marker, linestyle="", markersize=4, label=method)
    plain_log_ticks(ax.xaxis)
    plain_log_ticks(ax.yaxis)
    ax.grid(color="#dddddd", linewidth=0.5)
