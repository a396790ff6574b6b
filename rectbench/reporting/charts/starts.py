"""Random starts: how far above the default start's L each of them ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rectbench.plugins.figure import Drawing, Figure, FigureData, Look
from rectbench.plugins.result import Part, Result
from rectbench.reporting.names import pair_labels
from rectbench.reporting.style import COLUMN_INCHES, INK, PAGE_INCHES, plain_log_ticks
from rectbench.reporting.tables.numbers import decade

if TYPE_CHECKING:
    import matplotlib.figure

ENERGY = "distortion_native_grid"
"""What the fit minimises, as a column."""
SAME_MINIMUM = 0.01
"""Ending at most this much above the default start's L, relatively, is ending in the same minimum."""
_LETTER_INCHES = 0.055
_FLOOR = 1e-6


@dataclass(frozen=True)
class Starts:
    """A pair's random starts: L over the default start's L, and how many gave no rectification."""

    label: str
    ratios: tuple[float, ...]
    failed: int

    @property
    def count(self) -> int:
        """All starts, those that failed included."""
        return len(self.ratios) + self.failed

    @property
    def same(self) -> int:
        """How many end in the default start's minimum, or below it."""
        return sum(ratio <= 1 + SAME_MINIMUM for ratio in self.ratios)


class RandomStarts(Figure):
    """Where a method that minimises an energy ends from random starts."""

    name = "starts"
    topic = "Random starts"

    def sets_apart(self, result: Result) -> bool:
        """Whether it is one of the starts: told something else than the default."""
        return bool(result.options)

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """One chart, where there are starts beside a default one."""
        study = start_study(given.part, given.run)
        if study:
            method = study_method(given.part)
            look = next(given.looks[r.method] for r in given.run.results if r.cell.method == method)
            yield Drawing(
                "starts",
                "Random starts",
                f"Where {method} ends from random starts: its distortion L there, relative to the one from "
                "its default start. Above each pair: how many end at most 1 % above it. At the foot of the "
                "axis stand those within 10⁻⁶ of it, and those below it.",
                study,
                lambda: draw_starts(study, look),
            )


def start_study(part: Part, run: Part) -> tuple[Starts, ...]:
    """The starts of a part by pair: its rows with options, beside that without any, of the whole run."""
    defaults = {_cell(r): r for r in run.results if r.metrics.get(ENERGY) and not r.options}
    studied = [r for r in part.results if r.options and _cell(r) in defaults]
    return tuple(
        _starts(label, [r for r in studied if r.place == place], defaults)
        for place, label in pair_labels(part).items()
        if any(r.place == place for r in studied)
    )


def study_method(part: Part) -> str:
    """The method under study."""
    return str(next(r.cell.method for r in part.results if r.options))


def _cell(result: Result) -> tuple[object, ...]:
    return *result.pair, result.pose, result.cell.method


def _starts(label: str, results: list[Result], defaults: Mapping[tuple[object, ...], Result]) -> Starts:
    measured = [r for r in results if r.ok and ENERGY in r.metrics]
    ratios = sorted(r.metrics[ENERGY] / defaults[_cell(r)].metrics[ENERGY] for r in measured)
    return Starts(label, tuple(ratios), len(results) - len(ratios))


def draw_starts(study: tuple[Starts, ...], look: Look) -> matplotlib.figure.Figure:
    """A column of points a pair, on a logarithmic axis of the excess over the default start's L."""
    import matplotlib.figure

    width = min(PAGE_INCHES, max(COLUMN_INCHES, 0.9 + 1.1 * len(study)))
    figure = matplotlib.figure.Figure(figsize=(width, 2.3), layout="constrained")
    ax = figure.subplots()
    for x, starts in enumerate(study):
        excess = np.maximum(np.array(starts.ratios) - 1, _FLOOR)
        across = x + 0.5 * (np.arange(len(excess)) / max(1, len(excess) - 1) - 0.5)
        ax.plot(
            across, excess, look.marker, color=look.colour, markersize=3, markeredgewidth=0, clip_on=False
        )
        words = f"{starts.same} of {starts.count}" + (f"\n{starts.failed} failed" if starts.failed else "")
        ax.text(x, 1.02, words, transform=ax.get_xaxis_transform(), ha="center", va="bottom", size=6.5)
    ax.set_yscale("log")
    largest = max((ratio - 1 for starts in study for ratio in starts.ratios), default=1.0)
    ax.set_ylim(_FLOOR, max(1.0, 3 * largest))
    plain_log_ticks(ax.yaxis)
    ax.yaxis.set_major_formatter(lambda value, _: ("≤ " if value < 2 * _FLOOR else "") + decade(value))
    ax.axhspan(_FLOOR, SAME_MINIMUM, color="#e8f3ec", zorder=0)
    ax.axhline(SAME_MINIMUM, color=INK, linewidth=0.6, linestyle=(0, (4, 2)), zorder=1)
    at_edge = ax.get_yaxis_transform()
    ax.text(0.995, SAME_MINIMUM / 1.5, "same minimum", transform=at_edge, ha="right", va="top", size=6)
    ax.set_xlim(-0.5, len(study) - 0.5)
    labels = [starts.label for starts in study]
    longest = max(len(line) for label in labels for line in label.split("\n"))
    slanted: dict[str, Any] = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"}
    crowded = longest * _LETTER_INCHES > (width - 0.5) / len(study)
    ax.set_xticks(range(len(study)), labels, **(slanted if crowded else {}))
    ax.tick_params(axis="x", length=0)
    ax.set_ylabel("L over the default start's, less 1")
    ax.grid(axis="y")
    return figure
