"""A grid of equal boxes, one a method, placed by hand: exact, and quicker than a layout engine."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeVar

from rectbench.errors import RectbenchError
from rectbench.plugins.result import Result
from rectbench.reporting.style import INK, PAGE_INCHES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Made = TypeVar("Made")
_GAP_INCHES = 0.07
_HEAD_INCHES = 0.2


def panel_grid(
    count: int, columns: int, aspect: float, margin_inches: float = 0.0, gap_inches: float = _GAP_INCHES
) -> tuple[Figure, list[Axes]]:
    """A figure of `count` bare boxes, each `aspect` times as high as wide, with room for a head.

    `margin_inches` stay free on the right, for a colour bar, `gap_inches` between columns.
    """
    from matplotlib.figure import Figure

    rows = math.ceil(count / columns)
    width = (PAGE_INCHES - margin_inches - (columns - 1) * gap_inches) / columns
    height = rows * (width * aspect + _HEAD_INCHES) + (rows - 1) * _GAP_INCHES
    figure = Figure(figsize=(PAGE_INCHES, height))
    axes = []
    for i in range(count):
        row, column = divmod(i, columns)
        left = column * (width + gap_inches)
        bottom = height - (row + 1) * (width * aspect + _HEAD_INCHES) - row * _GAP_INCHES
        box = (left / PAGE_INCHES, bottom / height, width / PAGE_INCHES, width * aspect / height)
        ax = figure.add_axes(box)
        ax.set_axis_off()
        axes.append(ax)
    return figure, axes


def attempts(results: Sequence[Result], make: Callable[[Result], Made]) -> list[tuple[Result, Made | str]]:
    """Each result with what `make` gives of it, or with the reason why its picture is missing."""
    return [(result, _attempted(result, make)) for result in results]


def _attempted(result: Result, make: Callable[[Result], Made]) -> Made | str:
    if not result.ok:
        return f"{result.status}: {result.reason}" if result.reason else result.status
    try:
        return make(result)
    except Exception as error:  # a plugin's code runs here, and one picture is no reason to lose a report
        return f"no picture: {error}" if isinstance(error, RectbenchError) else f"no picture: {error!r}"


def fit_into_box(ax: Axes, width: float, height: float) -> None:
    """Limits that show [0, width] x [0, height], y down, undistorted: at the top, in the middle."""
    box = ax.get_position()
    inches = ax.figure.get_size_inches()  # type: ignore[union-attr]
    aspect = box.height * inches[1] / (box.width * inches[0])
    shown = max(width, height / aspect)
    ax.set_xlim((width - shown) / 2, (width + shown) / 2)
    ax.set_ylim(shown * aspect, 0)


def write_head(ax: Axes, name: str, note: str = "", colour: str | None = None) -> None:
    """The method's name and what is said of it above the box, over a stripe in its colour."""
    ax.set_title(name, color=INK, x=0.004)
    ax.set_title(note, loc="right", color=INK, x=0.996)
    if colour:
        stripe = ax.plot([0, 1], [1, 1], color=colour, linewidth=2, transform=ax.transAxes, clip_on=False)[0]
        stripe.set_solid_capstyle("butt")


def write_message(ax: Axes, text: str, characters: int) -> None:
    """A box that says why it shows no picture."""
    from matplotlib.patches import Rectangle

    ax.add_patch(Rectangle((0, 0), 1, 1, transform=ax.transAxes, facecolor="#f4f4f4", edgecolor="none"))
    words = textwrap.fill(text, characters, max_lines=5, placeholder=" …")
    ax.text(0.5, 0.5, words, transform=ax.transAxes, ha="center", va="center", color=INK, size=6)
