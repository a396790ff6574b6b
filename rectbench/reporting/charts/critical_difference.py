"""What the rigs of a run decide between methods, from ten rigs on: mean ranks, and who is probably better."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from rectbench.plugins.figure import Drawing, Figure, FigureData, Look
from rectbench.plugins.result import Part, distinct
from rectbench.reporting.curves import ranked_by
from rectbench.reporting.style import FAINT, INK, LOST, PAGE_INCHES, PAPER
from rectbench.runs.units import by_rig, floor_of
from rectbench.statistics.bayes import BEYOND, EQUIVALENT, Belief, signed_rank
from rectbench.statistics.intervals import ALPHA, counted
from rectbench.statistics.paired import TIE
from rectbench.statistics.ranking import rank

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.collections import PathCollection
    from matplotlib.text import Text

LEAST_RIGS = 10
"""With fewer, ranks say too little to be drawn."""
LEAST_METHODS = 3
"""Of two methods a signed-rank test tells all that their ranks do."""
MOST_PAIRS = 28
"""Of more pairs of methods only neighbours in the ranking are shown."""
ROW_INCHES, ABOVE = 0.165, 3.0
"""Of a label in height, and how many of them stand above the axis of ranks."""
LEAST_LABELLED = 0.06
"""Narrower parts of a bar have no room for their number."""


@dataclass(frozen=True)
class Decided:
    """The values of methods on each rig, best method first; infinite where one has none."""

    heading: str
    floor: float
    values: Mapping[str, Mapping[str, float]]

    @property
    def rigs(self) -> int:
        """How many rigs any of the methods has a value on."""
        return len(next(iter(self.values.values())))


class CriticalDifference(Figure):
    """Mean ranks over rigs with their critical difference, and how probably methods differ in practice."""

    name = "critical-difference"
    topic = "Charts"
    usual = 3

    def drawings(self, given: FigureData) -> Iterator[Drawing]:
        """Both, of a part with ten rigs or more; else none."""
        data = decided(given.part)
        if why_not_drawn(given.part):
            return
        yield Drawing(
            "critical-difference",
            "Critical difference",
            f"Mean rank of each method by {data.heading} over {data.rigs} rigs, 1 being the best. Methods "
            "that a bar joins are not told apart at 5 % (Friedman's test, then Nemenyi's; Demšar 2006): "
            "their mean ranks are nearer to each other than the critical difference CD. Places see no "
            "ratios, and so tell less than the ranks of the table."
            f"{_lacking(data, 'shares the last place')}",
            data,
            lambda: draw_ranks(data, given.looks),
        )
        yield Drawing(
            "practical-equivalence",
            "Practical equivalence",
            f"How probable it is that on rigs like these one method mostly has the lower {data.heading}, or "
            f"the other, or that they are mostly less than {100 * EQUIVALENT:g} % apart (grey), the same in "
            f"practice: Bayesian signed-rank test over {data.rigs} rigs (Benavoli et al. 2017)."
            f"{_lacking(data, 'is the worse one')}",
            data,
            lambda: draw_beliefs(data, given.looks),
        )


def decided(part: Part) -> Decided:
    """The ranking column of all methods that have it anywhere, under the pose that shows distortion."""
    column = part.catalogue.ranking
    values = {m: own for m, own in by_rig(part.select(pose=part.geometric_pose), column).items() if own}
    rigs = distinct(rig for own in values.values() for rig in own)
    order = rank(values, floor=floor_of(column)).order
    filled = {method: {rig: values[method].get(rig, math.inf) for rig in rigs} for method in order}
    return Decided(ranked_by(part.catalogue), floor_of(column), filled)


def why_not_drawn(part: Part) -> str:
    """Why there is no figure of critical differences, a sentence; empty where there is one."""
    data = decided(part)
    methods, rigs = len(data.values), data.rigs if data.values else 0
    if methods >= LEAST_METHODS and rigs >= LEAST_RIGS:
        return ""
    return (
        f"No figure of critical differences: it takes {LEAST_METHODS} methods with a "
        f"{ranked_by(part.catalogue)} on {LEAST_RIGS} rigs; here are {counted(methods, 'method')} on "
        f"{counted(rigs, 'rig')}."
    )


def _lacking(data: Decided, then: str) -> str:
    """The sentence about methods that have no number on some rig; empty where there are none."""
    lacking = [method for method, own in data.values.items() if math.inf in own.values()]
    return f" A method without a number on a rig ({', '.join(lacking)}) {then} there." if lacking else ""


def mean_ranks(data: Decided) -> tuple[dict[str, float], pd.DataFrame, float]:
    """The mean rank of each method over rigs, p of each two that they are alike, and the critical difference.

    All p are 1 where Friedman's test tells nothing of the methods together.
    """
    import pandas as pd
    from scikit_posthocs import posthoc_nemenyi_friedman  # its import takes seconds
    from scipy.stats import friedmanchisquare, studentized_range

    logs = np.log(np.maximum([list(numbers.values()) for numbers in data.values.values()], data.floor))
    settled = np.round(np.minimum(logs, BEYOND) / TIE)  # rounding is a tie
    table = pd.DataFrame(settled.T, columns=list(data.values))
    methods, rigs = len(table.columns), len(table)
    p = posthoc_nemenyi_friedman(table)
    with np.errstate(invalid="ignore"):  # all methods alike on all rigs
        told = friedmanchisquare(*table.to_numpy().T).pvalue < ALPHA
    # Demšar, Statistical Comparisons of Classifiers over Multiple Data Sets, JMLR 7, 2006, section 3.2.2.
    quantile = studentized_range.ppf(1 - ALPHA, methods, np.inf) / math.sqrt(2)
    difference = float(quantile * math.sqrt(methods * (methods + 1) / (6 * rigs)))
    ranks = table.rank(axis=1).mean()
    return {str(m): float(r) for m, r in ranks.items()}, p if told else p * 0 + 1, difference


def draw_ranks(data: Decided, looks: Mapping[str, Look]) -> matplotlib.figure.Figure:
    """Draw mean ranks on a line, bars below methods that are not told apart, and the difference it takes."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from scikit_posthocs import critical_difference_diagram

    ranks, p, difference = mean_ranks(data)
    figure = Figure(figsize=(PAGE_INCHES, 1.0), layout=ConstrainedLayoutEngine(w_pad=0.08))
    ax = figure.subplots()
    best, worst, last = min(ranks.values()), max(ranks.values()), len(ranks)
    beside = 0.02 * last + max(best - 1, last - worst)  # so that names stand beyond both ends of the axis
    drawn = critical_difference_diagram(
        ranks,
        p,
        alpha=ALPHA,
        ax=ax,
        label_fmt_left="{label}",
        label_fmt_right="{label}",
        color_palette={method: looks[method].colour for method in ranks},
        marker_props={"s": 26},
        elbow_props={"linewidth": 0.9},
        crossbar_props={"color": INK, "linewidth": 2.4, "solid_capstyle": "butt"},
        text_h_margin=beside,
    )
    for marks, label in zip(drawn["markers"], drawn["labels"], strict=True):
        _finish(marks, label, ranks[label.get_text()], looks[label.get_text()].marker)
    lowest = min(float(line.get_ydata()[0]) for line in drawn["elbows"])
    ax.set_xlim(best - beside, worst + beside)
    ax.set_ylim(lowest - 0.6, ABOVE)
    ax.set_xticks(range(1, last + 1))
    _add_difference(ax, difference)
    figure.set_figheight(ROW_INCHES * (ABOVE - lowest + 0.6))
    return figure


def _finish(marks: PathCollection, label: Text, rank: float, marker: str) -> None:
    """Give a method on the axis its own mark, and beside its name its mean rank."""
    from matplotlib.markers import MarkerStyle

    style = MarkerStyle(marker)
    marks.set(paths=[style.get_path().transformed(style.get_transform())], edgecolor=INK, linewidth=0.6)
    name, is_left = label.get_text(), label.get_horizontalalignment() == "right"
    words = f"{name}  {rank:.2f}\u00a0" if is_left else f"\u00a0{rank:.2f}  {name}"
    label.set(text=words, color=INK)


def _add_difference(ax: Axes, difference: float) -> None:
    """The critical difference as a bar above the axis of ranks, which is made visible."""
    ax.spines.top.set_visible(True)
    height = 0.66 * ABOVE
    ax.errorbar([1 + difference / 2], [height], xerr=difference / 2, color=INK, capsize=2.5, linewidth=1.0)
    ax.text(1 + difference, height, f"  CD {difference:.2f}", va="center", color=INK)


def draw_beliefs(data: Decided, looks: Mapping[str, Look]) -> matplotlib.figure.Figure:
    """Draw a bar for each pair of methods: the first better, no difference in practice, the second better."""
    from matplotlib.figure import Figure

    beliefs = shown_beliefs(data)
    figure = Figure(figsize=(PAGE_INCHES, 0.45 + 0.19 * len(beliefs)), layout="constrained")
    ax = figure.subplots()
    for row, belief in enumerate(beliefs):
        _add_bar(ax, row, belief, looks)
    ax.set_yticks(range(len(beliefs)), [belief.a for belief in beliefs])
    other = ax.secondary_yaxis("right")
    other.set_yticks(range(len(beliefs)), [belief.b for belief in beliefs])
    for axis in (ax, other):
        axis.tick_params("y", length=0)
        axis.spines[:].set_visible(False)
    ax.set_ylim(len(beliefs) - 0.4, -0.6)
    ax.set_xlim(0, 1)
    ax.set_xticks([])
    ax.set_title("left method better", color=FAINT)
    ax.set_title(f"less than {100 * EQUIVALENT:g} % apart", color=FAINT, loc="center")
    ax.set_title("right method better", color=FAINT, loc="right")
    return figure


def shown_beliefs(data: Decided) -> tuple[Belief, ...]:
    """Of all pairs of methods, the better one first; of many methods, of each and the next."""
    methods = list(data.values)
    if math.comb(len(methods), 2) <= MOST_PAIRS:
        return signed_rank(data.values, floor=data.floor)
    neighbours = ({a: data.values[a], b: data.values[b]} for a, b in pairwise(methods))
    return tuple(belief for two in neighbours for belief in signed_rank(two, floor=data.floor))


def _add_bar(ax: Axes, row: int, belief: Belief, looks: Mapping[str, Look]) -> None:
    a, b = looks[belief.a], looks[belief.b]
    shares = (belief.a_better, belief.equivalent, belief.b_better)
    left = 0.0
    for share, colour, hatch in zip(shares, (a.colour, LOST, b.colour), (a.hatch, "", b.hatch), strict=True):
        ax.barh(row, share, 0.78, left, color=colour, hatch=hatch, edgecolor=PAPER, linewidth=0.5)
        if share >= LEAST_LABELLED:
            ink = PAPER if _is_dark(colour) else INK
            ax.text(left + share / 2, row, f"{100 * share:.0f} %", color=ink, ha="center", va="center")
        left += share


def _is_dark(colour: str) -> bool:
    """Whether white is read more easily on it than ink; by the luminance of WCAG 2.1."""
    from matplotlib.colors import to_rgb

    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    return bool(np.dot(linear, (0.2126, 0.7152, 0.0722)) < 0.25)
