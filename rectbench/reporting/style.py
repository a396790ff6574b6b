"""How every figure looks, and how it is written so that the same data give the same bytes."""

from __future__ import annotations

import io
import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rectbench.plugins.defaults import CONTENDERS
from rectbench.plugins.figure import Look
from rectbench.plugins.rectifier import METHODS, is_built_in
from rectbench.registry import registry
from rectbench.reporting.tables.numbers import decade
from rectbench.types import BoolArray, FloatArray

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.colorbar import Colorbar
    from matplotlib.colors import Colormap, Normalize
    from matplotlib.figure import Figure

COLUMN_INCHES = 3.5
PAGE_INCHES = 7.16
"""Widths of one and of both columns of an IEEE page."""

INK = "#222222"
FAINT = "#8a8a8a"
PAPER = "#ffffff"
LOST = "#d9d9d9"
BEYOND = "#8c1d40"
"""The colours of what is not there, and of what lies beyond the end of a scale."""

STYLE = Path(__file__).with_name("templates") / "rectbench.mplstyle"
"""The rest of how figures look, in matplotlib's words."""

_COLOURS = (
    *("#0072b2", "#56b4e9", "#cc79a7", "#e69f00", "#d55e00", "#009e73", "#332288"),
    *("#999933", "#882255", "#666666", "#44aa99", "#ddaa33", "#117733"),
)
"""Okabe & Ito's palette, then darker ones of Tol's: told apart under all common colour blindness."""
_MARKERS = ("o", "s", "v", "^", "D", "P", "X", "<", ">", "h", "p", "*", "d")
_HATCHES = ("", "//////", "......", "xxxxxx")


def looks(methods: Sequence[str]) -> dict[str, Look]:
    """The look of each method of a run, in the run's order.

    Built-in methods have places of their own, the contenders' first and then by name, and so the same look in
    all runs; others take the next free places, one after the other. Beyond the number of colours come hatches
    and other markers.
    """
    built_in = [plugin.name for plugin in registry(METHODS).plugins() if is_built_in(plugin)]
    ordered = dict.fromkeys([*(name for name in CONTENDERS if name in built_in), *built_in])
    own_place = {method: place for place, method in enumerate(ordered)}
    taken: dict[int, str] = {}
    for method in sorted(dict.fromkeys(methods), key=lambda method: own_place.get(method, len(built_in))):
        free = (place for place in _places(own_place.get(method, len(built_in))) if place not in taken)
        taken[next(free)] = method
    found = {method: _look(place) for place, method in taken.items()}
    return {method: found[method] for method in methods}


def _places(first: int) -> Iterator[int]:
    """All places, from `first` on round the colours, then round them again."""
    count = len(_COLOURS)
    return (lap * count + (first + i) % count for lap in itertools.count() for i in range(count))


def _look(place: int) -> Look:
    lap, colour = divmod(place, len(_COLOURS))
    marker = _MARKERS[(colour + 4 * lap) % len(_MARKERS)]
    return Look(_COLOURS[colour], marker, _HATCHES[lap % len(_HATCHES)])


def plain_log_ticks(axis: Axis) -> None:
    """Label a logarithmic axis 0.1, 1, 10, 100, and with powers of ten beyond; 2 and 5 on a short one."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    short = high < 100 * low
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if short else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: decade(value)))
    axis.set_minor_formatter(NullFormatter())


def shaded(values: FloatArray, lens: BoolArray, norm: Normalize) -> FloatArray:
    """Colours [h, w, 4] of values [h, w], NaN having its own; white where the lens shows nothing."""
    colours = shades()
    found: FloatArray = colours(norm(values))
    found[np.isnan(values)] = colours.get_bad()
    found[~lens] = (1.0, 1.0, 1.0, 1.0)
    return found


def shades() -> Colormap:
    """Viridis, with colours of their own for what lies beyond the scale and for what is not mapped."""
    from matplotlib import colormaps

    return colormaps["viridis"].with_extremes(over=BEYOND, bad=LOST)


def add_colour_bar(
    figure: Figure,
    place: tuple[float, float, float, float],
    norm: Normalize,
    colours: Colormap | str,
    extend: str = "both",
) -> Colorbar:
    """The scale of the colours, at a place (left, bottom, width, height) in shares of the figure."""
    from matplotlib.cm import ScalarMappable

    bar = figure.colorbar(ScalarMappable(norm, colours), cax=figure.add_axes(place), extend=extend)
    bar.outline.set_linewidth(0.4)
    return bar


def encode(figure: Figure, extension: str, dpi: int) -> bytes:
    """The figure as a PDF, SVG or PNG file; `dpi` also sets the detail of images within it."""
    buffer = io.BytesIO()
    with _quick_png():
        figure.savefig(buffer, format=extension, dpi=dpi, metadata=_METADATA[extension])
    return buffer.getvalue()


@contextmanager
def _quick_png() -> Iterator[None]:
    """Images as PNG in a third of the time, within SVG and PDF as well, where matplotlib offers no choice."""
    from PIL import Image

    Image.init()
    usual = Image.SAVE["PNG"]

    def save(image: Image.Image, *place: Any) -> None:
        image.encoderinfo.setdefault("compress_level", _COMPRESSION)
        usual(image, *place)

    Image.register_save("PNG", save)
    try:
        yield
    finally:
        Image.register_save("PNG", usual)


_COMPRESSION = 2
"""Photographs take 7 % more than at zlib's usual 6, and a third of the time."""


_METADATA: dict[str, dict[str, Any]] = {
    "pdf": {"CreationDate": None, "Creator": None},
    "svg": {"Date": None},
    "png": {"Software": None},
}
"""No times and no versions, so that equal pictures are equal files."""
