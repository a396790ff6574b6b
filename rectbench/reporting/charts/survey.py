"""All methods on all classes of lenses: a row a method, a panel a class, a dot a rig."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rectbench.plugins.figure import Drawing, Figure, FigureData
from rectbench.reporting.shares import measure
from rectbench.reporting.style import FAINT, INK, LOST, PAGE_INCHES, PAPER, plain_log_ticks
from rectbench.reporting.survey import NAME, Reached, Surveyed, lens_classes, surveyed, surveyed_columns

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

ROW_INCHES, LETTER_INCHES = 0.125, 0.055
_HEAD_INCHES, _FOOT_INCHES = 0.22, 0.36
_COLOURS = {"pose": "#0072b2", "matches": "#d55e00"}
"""By what a method works from; so many methods are told apart by their names, not by colours."""
_LEAST = 1e-3
"""Less log distortion than this is as good as none, and drawn here."""
_BAND = "#f4f4f4"


@dataclass(frozen=True)
class SurveyData:
    """All that the chart shows: `classes` are the titles of the panels, with how many rigs each has."""

    label: str
    classes: tuple[tuple[str, int], ...]
    methods: tuple[Surveyed, ...]


class Survey(Figure):
    """Each method's distortion on each class of lenses, rig by rig; where it has none, why."""

    name = NAME
    topic = "Ranking"

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart a share of the view, where fields of view are known."""
        part = given.part
        classes = lens_classes(part)
        if classes:
            titles = tuple((c.title, len(c.rigs)) for c in classes)
            for share, column in surveyed_columns(part).items():
                label = f"{measure(column)} at {share} % of the view"
                yield _drawing(SurveyData(label, titles, surveyed(part, classes, column)), share)


def _drawing(data: SurveyData, share: int) -> Drawing:
    return Drawing(
        NAME,
        f"All methods, all lenses: {share} % of the view",
        f"{data.label.capitalize()}, a dot a rig, the bar their geometric mean; a panel for each class of "
        "lenses, by the horizontal field of view that both images show. Blue methods work from the pose, "
        "orange ones from matches. A method without a number on some pairs of a class says why, and has no "
        f"mean. The dotted line is the least mean of the class, by {_leaders(data)}. What serves more "
        "classes stands higher, then what distorts less.",
        data,
        lambda: draw_survey(data),
        of=str(share),
    )


def _leaders(data: SurveyData) -> str:
    """Who has the least mean of each class."""
    names = [_least(data, place)[1] for place in range(len(data.classes))]
    return ", ".join(dict.fromkeys(name for name in names if name)) or "nobody"


def _least(data: SurveyData, place: int) -> tuple[float, str]:
    means = [
        (reached.average, one.label)
        for one in data.methods
        if (reached := one.reached[place]) and reached.average is not None
    ]
    return min(means, default=(math.nan, ""))


def draw_survey(data: SurveyData) -> matplotlib.figure.Figure:
    """Panels side by side on one logarithmic axis, the names of methods at the left of the first."""
    import matplotlib.figure

    names = LETTER_INCHES * max(len(one.label) for one in data.methods) + 0.12
    height = _HEAD_INCHES + ROW_INCHES * len(data.methods) + _FOOT_INCHES
    figure = matplotlib.figure.Figure(figsize=(PAGE_INCHES, height))
    axes = figure.subplots(1, len(data.classes), sharex=True, sharey=True, squeeze=False)[0]
    figure.subplots_adjust(
        left=names / PAGE_INCHES,
        right=1 - 0.06 / PAGE_INCHES,
        top=1 - _HEAD_INCHES / height,
        bottom=_FOOT_INCHES / height,
        wspace=0.12,
    )
    axes[0].set_xscale("log")
    for place, (ax, (title, rigs)) in enumerate(zip(axes, data.classes, strict=True)):
        ax.set_title(f"{title}, {rigs} rig{'' if rigs == 1 else 's'}")
        _draw_class(ax, data, place)
    axes[0].set_yticks(range(len(data.methods)), [one.label for one in data.methods])
    for one, label in zip(data.methods, axes[0].get_yticklabels(), strict=True):
        label.set_color(_COLOURS[one.works_from])
    axes[0].set_ylim(len(data.methods) - 0.4, -0.6)
    plain_log_ticks(axes[0].xaxis)
    figure.supxlabel(f"←  {data.label}", size=7, y=0.02 / height)
    return figure


def _draw_class(ax: Axes, data: SurveyData, place: int) -> None:
    least, _ = _least(data, place)
    if math.isfinite(least):
        ax.axvline(max(least, _LEAST), color=FAINT, linewidth=0.7, linestyle=":", zorder=1)
    for row, one in enumerate(data.methods):
        band = _BAND if row % 2 else PAPER
        ax.axhspan(row - 0.5, row + 0.5, color=band, linewidth=0, zorder=0)
        reached = one.reached[place]
        if reached is not None:
            _draw_reached(ax, row, reached, _COLOURS[one.works_from], band)
    ax.tick_params(axis="y", length=0)
    ax.grid(axis="x", color=LOST, linewidth=0.4)
    ax.spines.left.set_visible(False)


def _draw_reached(ax: Axes, row: int, reached: Reached, colour: str, band: str) -> None:
    values = [max(value, _LEAST) for _, value in reached.by_rig]
    faded = reached.why != ""
    ax.plot(values, [row] * len(values), "o", color=colour, markersize=2.0, alpha=0.25 if faded else 0.55)
    if reached.average is not None:
        mean = max(reached.average, _LEAST)
        ax.plot([mean, mean], [row - 0.36, row + 0.36], color=INK, linewidth=1.3, solid_capstyle="butt")
    if faded:
        told = ax.text(0.02, row, reached.why, va="center", size=5, color=INK)
        told.set(transform=ax.get_yaxis_transform(), bbox={"facecolor": band, "linewidth": 0, "pad": 0.4})
