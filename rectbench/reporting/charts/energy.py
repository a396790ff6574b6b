"""The energy about the fit: L over two coefficients as contours, over each alone as curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rectbench.errors import Unsupported
from rectbench.metrics.energy import (
    COEFFICIENTS,
    SLICES,
    EnergyCurve,
    EnergySlice,
    energy_curve,
    energy_slice,
    has_cubics,
)
from rectbench.plugins.figure import FigureData, Sources
from rectbench.plugins.result import Result
from rectbench.reporting.pictures.pair_picture import PairPicture
from rectbench.reporting.pictures.panels import attempts
from rectbench.reporting.style import INK, PAGE_INCHES
from rectbench.reporting.tables.numbers import three_digits
from rectbench.warps import Rectification

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CURVES = {
    "u1": ("c₁ of Ψᵤ", "#0072b2", "-"),
    "u2": ("c₂ of Ψᵤ", "#0072b2", "--"),
    "u3": ("c₃ of Ψᵤ", "#0072b2", ":"),
    "v1": ("c₁ of Ψᵥ", "#d55e00", "-"),
    "v2": ("c₂ of Ψᵥ", "#d55e00", "--"),
    "v3": ("c₃ of Ψᵥ", "#d55e00", ":"),
}
"""What each coefficient is called, and the colour and style of its line."""
_LEVELS = 14
_UNFEASIBLE = "#c4c4c4"
_TOP_RISES = 3.0
"""Height of the curves' panel, in rises of the median curve: steeper ones leave it, and the bowl shows."""


class Energy(PairPicture):
    """The energy about the fit of each method that has coefficients to vary."""

    name = "energy"
    topic = "Energy"
    stem = "energy"
    title = "Energy about the fit"
    caption = (
        "L over two coefficients with the others held (the left image's Ψᵤ, and Ψᵥ of both), and over each "
        "alone, where the steepest leave the panel. A change of 100 % turns the slope at the far end of the "
        "range by the mean slope. Hatched: not convex; grey: rows or columns would change places."
    )
    shown_as = "svg"

    def draw(self, results: Sequence[Result], given: FigureData) -> Figure:
        """A row a method whose maps are cubics: three slices as contours, and the curves.

        Raises Unsupported with the reason where no method has a shape.
        """
        sources = given.sources
        from matplotlib.figure import Figure

        found = [shape for _, shape in attempts(results, lambda r: _shape(sources, r))]
        shapes = [shape for shape in found if isinstance(shape, Shape)]
        if not shapes:
            raise Unsupported(f"no energy to show: {'; '.join(map(str, found))}")
        figure = Figure(figsize=(PAGE_INCHES, 1.95 * len(shapes)), layout="constrained")
        grid = figure.subplots(len(shapes), len(SLICES) + 1, squeeze=False, width_ratios=[1, 1, 1, 1.05])
        for axes, shape in zip(grid, shapes, strict=True):
            for ax, over in zip(axes, shape.slices, strict=False):
                _draw_slice(ax, over)
            _draw_curves(axes[-1], shape.curves)
            if len(shapes) > 1:
                axes[0].set_ylabel(f"{shape.method}\n{axes[0].get_ylabel()}")
        return figure


@dataclass(frozen=True)
class Shape:
    """The slices and curves of one fit."""

    method: str
    slices: tuple[EnergySlice, ...]
    curves: tuple[EnergyCurve, ...]


def _shape(sources: Sources, result: Result) -> Shape:
    rect = sources.rectification(result)
    if not has_cubics(rect):
        raise Unsupported(f"{result.method} has no cubics")
    return shape_of(result.method, rect)


def shape_of(method: str, rect: Rectification) -> Shape:
    """The slices and the curves that are shown."""
    slices = tuple(energy_slice(rect, first, second) for first, second in SLICES)
    return Shape(method, slices, tuple(energy_curve(rect, name, count=81) for name in COEFFICIENTS))


def _draw_slice(ax: Axes, over: EnergySlice) -> None:
    """Contours in even steps of √L, which is about linear in the distance from the minimum."""
    from matplotlib.colors import PowerNorm

    ax.set_box_aspect(1)
    energy = np.where(over.feasible, over.energy, np.nan).T
    low, high = float(np.nanmin(energy)), float(np.nanmax(energy))
    levels = np.linspace(0, 1, _LEVELS) ** 2 * (high - low) + low
    ax.set_facecolor(_UNFEASIBLE)
    steps = 100 * over.steps
    shades = PowerNorm(0.5, low, low + 2 * (high - low))  # the darker half would drown the labels
    ax.contourf(steps, steps, energy, levels, cmap="Blues", norm=shades, extend="max")
    lines = ax.contour(steps, steps, energy, levels[1::3], colors=INK, linewidths=0.4)
    outer = levels[4::3]  # the innermost is too small for a label beside the cross
    ax.clabel(lines, outer, fmt=lambda value: three_digits(value), fontsize=5, inline_spacing=2)
    _hatch_unconvex(ax, over)
    ax.plot(0, 0, "+", color=INK, markersize=5, markeredgewidth=1)
    ax.set_xlabel(f"change of {_CURVES[over.first][0]} [%]")
    ax.set_ylabel(f"change of {_CURVES[over.second][0]} [%]")
    ax.set_title("" if math.isnan(over.convex_share) else f"convex on {100 * over.convex_share:.1f} %")


def _hatch_unconvex(ax: Axes, over: EnergySlice) -> None:
    from matplotlib import rc_context

    not_convex = (over.feasible[1:-1, 1:-1] & ~over.convex).T
    if not_convex.any():
        steps = 100 * over.steps[1:-1]
        with rc_context({"hatch.linewidth": 0.4}):
            ax.contourf(steps, steps, not_convex.astype(float), [0.5, 1.5], colors="none", hatches=["//////"])


def _draw_curves(ax: Axes, curves: Sequence[EnergyCurve]) -> None:
    """L above its minimum on a linear axis, the names above the panel."""
    ax.set_box_aspect(1)
    for curve in curves:
        label, colour, line = _CURVES[curve.name]
        energy = np.where(curve.feasible, curve.energy, np.nan)
        ax.plot(100 * curve.steps, energy, color=colour, linestyle=line, linewidth=1.1, label=label)
    highest = [float(curve.energy[curve.feasible].max()) for curve in curves]
    low = min(float(curve.energy[curve.feasible].min()) for curve in curves)
    height = min(max(highest) - low, _TOP_RISES * (float(np.median(highest)) - low))
    if height > 0:
        ax.set_ylim(low - 0.04 * height, low + height)
    ax.set_xlabel("change [%]")
    ax.set_ylabel("L")
    ax.grid(axis="y")
    by_number = sorted(ax.lines, key=lambda line: str(line.get_label())[:2])  # columns c₁, c₂, c₃
    above: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.45, 1.0)}
    ax.legend(handles=by_number, **above, ncols=3, fontsize=5.5, handlelength=1.8, columnspacing=0.8)
