"""A calibration's uncertainty as files: maps over the left source image, numbers, arrays."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.metrics import Uncertainty
from rectbench.reporting.pictures.panels import fit_into_box, panel_grid, write_head, write_message
from rectbench.reporting.style import LOST, PAGE_INCHES, STYLE, add_colour_bar, encode, shaded, shades
from rectbench.reporting.tables.numbers import three_digits
from rectbench.rigs.covariance import RigCovariance
from rectbench.types import FloatArray
from rectbench.warps.jacobians import finite
from rectbench.writing import write_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

MAP_PIXELS = 150_000
"""Pixels of the left image that a map is made of, at most about this many."""
DOTS_PER_INCH = 220
BAR_INCHES = 0.62
NEARLY_ALL = (0.02, 0.98)
"""Quantiles between which the colours run; what lies beyond has a colour of its own."""
LEAST_PX, LEAST_PERCENT = 1e-3, 1e-1
"""Ends of the scales where nothing is uncertain."""
WHOLE_DISTANCE = 100.0
"""Per cent; of a distance that is less sure than this, no more can be said."""
MOST_COLUMNS = 4


def map_pixels(camera: Camera) -> FloatArray:
    """A regular grid [h, w, 2] of whole pixels of the image, those the lens does not see among them."""
    step = max(1, math.ceil((camera.width * camera.height / MAP_PIXELS) ** 0.5))
    return camera.pixel_grid()[step // 2 :: step, step // 2 :: step]


def write_uncertainty(
    found: Uncertainty, covariance: RigCovariance, camera: Camera, folder: Path, facts: Mapping[str, str]
) -> list[Path]:
    """Write the files of an uncertainty on the grid of `map_pixels`; returns their paths.

    `uncertainty.png` and `.pdf`, the maps; `uncertainty.json`, the numbers for each distance, the `facts`
    and the standard deviations they come from; `uncertainty.npz`, the maps with `pixels` and `depth_m`,
    NaN where a point is not in both images. Raises Unavailable where the disk takes no more.
    """
    from matplotlib import rc_context

    with rc_context(fname=STYLE):
        figure = draw_uncertainty(found, camera)
        pictures = {f"uncertainty.{end}": encode(figure, end, DOTS_PER_INCH) for end in ("png", "pdf")}
    arrays = io.BytesIO()
    np.savez_compressed(
        arrays,
        allow_pickle=False,
        pixels=found.pixels,
        depth_m=np.array(found.depth_m),
        row_error_sigma_px=found.row_error_sigma_px,
        inverse_depth_sigma_per_m=found.inverse_depth_sigma_per_m,
        matched_inverse_depth_sigma_per_m=found.matched_inverse_depth_sigma_per_m,
    )
    numbers = {
        **facts,
        "covariance": covariance.source,
        "sigmas": {name: covariance.sigma(name) for name in covariance.parameters},
        "matching_px": found.matching_px,
        "depths": [{name: _plain(value) for name, value in row.items()} for row in found.numbers()],
    }
    contents: dict[str, str | bytes] = {
        **pictures,
        "uncertainty.json": json.dumps(numbers, indent=2, allow_nan=False) + "\n",
        "uncertainty.npz": arrays.getvalue(),
    }
    for name, content in contents.items():
        write_atomically(folder / name, content)
    return [folder / name for name in contents]


def draw_uncertainty(found: Uncertainty, camera: Camera) -> Figure:
    """σ of row error above, of distance below, a column for each distance; side by side for one.

    The distance's are those with the noise of matching where one is stated. Raises InvalidInput where
    the distances are more than fit a page.
    """
    count = len(found.depth_m)
    if count > MOST_COLUMNS:
        raise InvalidInput(f"{count} distances were given; expected at most {MOST_COLUMNS} in one picture")
    lens = camera.unproject(found.pixels)[1]
    height, width = lens.shape
    gap = {"gap_inches": BAR_INCHES} if count == 1 else {}
    figure, axes = panel_grid(2 * count, max(count, 2), height / width, BAR_INCHES, **gap)
    rows, distances = _row_maps(found), _distance_maps(found)
    _draw_maps(figure, axes[:count], rows, lens)
    _draw_maps(figure, axes[count:], distances, lens)
    if any(np.isnan(one.values[lens]).any() for one in rows.maps):
        _add_legend(figure)
    return figure


class _Map(NamedTuple):
    """A quantity over the image at one distance: values [h, w], its head, and what is noted of it."""

    values: FloatArray
    head: str
    note: str
    message: str = ""
    """What is said in its place, if it has nothing to show."""


@dataclass(frozen=True)
class _Maps:
    """Maps of one quantity, one a distance, on one colour scale."""

    maps: Sequence[_Map]
    norm: Normalize
    unit: str


def _row_maps(found: Uncertainty) -> _Maps:
    from matplotlib.colors import Normalize

    known = finite(found.row_error_sigma_px)
    top = float(np.quantile(known, NEARLY_ALL[1])) if known.size else 0.0
    maps = []
    for values, numbers in zip(found.row_error_sigma_px, found.numbers(), strict=True):
        rms = numbers["row_error_sigma_rms_px"]
        note = "" if math.isnan(rms) else f"σ {three_digits(rms)} px RMS"
        maps.append(_Map(values, f"row error {_at(numbers['depth_m'])}", note))
    return _Maps(maps, Normalize(0.0, _rounded_up(max(top, LEAST_PX))), "px")


def _distance_maps(found: Uncertainty) -> _Maps:
    from matplotlib.colors import LogNorm

    percent = 100 * found.matched_depth_sigma_share
    known = finite(percent)
    known = known[known > 0]
    low, high = np.quantile(known, NEARLY_ALL) if known.size else (LEAST_PERCENT, 1.0)
    top = min(_rounded_up(high), WHOLE_DISTANCE)
    maps = []
    for k, numbers in enumerate(found.numbers()):
        depth, median = numbers["depth_m"], 100 * numbers["depth_sigma_median_matched_share"]
        note = "" if math.isnan(median) else f"σ {three_digits(median)} % median"
        inverse = found.matched_inverse_depth_sigma_per_m[k]
        message = _told_from_infinity(inverse) if math.isinf(depth) else ""
        maps.append(_Map(percent[k], f"distance {_at(depth)}", note, message))
    return _Maps(maps, LogNorm(min(_rounded_down(low), top / 10), top), "%")


def _told_from_infinity(inverse_sigma_per_m: FloatArray) -> str:
    known = finite(inverse_sigma_per_m)
    median = float(np.median(known)) if known.size else math.nan
    if not median > 0:
        return "no σ: nothing is uncertain" if known.size else "no point in both images"
    return (
        f"half of the pixels tell a point nearer than {three_digits(1 / median)} m from one at infinity (1 σ)"
    )


def _draw_maps(figure: Figure, axes: Sequence[Axes], maps: _Maps, lens: NDArray[np.bool_]) -> None:
    for ax, one in zip(axes, maps.maps, strict=True):
        if one.message:
            write_message(ax, one.message, 30)
        else:
            ax.imshow(shaded(one.values, lens, maps.norm), interpolation="antialiased", aspect="auto")
            fit_into_box(ax, lens.shape[1], lens.shape[0])
        write_head(ax, one.head, one.note)
    if not all(one.message for one in maps.maps):
        _draw_bar(figure, axes[-1], maps)


def _draw_bar(figure: Figure, ax: Axes, maps: _Maps) -> None:
    """The colour bar of a quantity, right of its last map, and what lies beyond its end."""
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    box = ax.get_position()
    left = box.x1 + 0.07 / PAGE_INCHES
    place = (left, box.y0 + 0.15 * box.height, 0.09 / PAGE_INCHES, 0.62 * box.height)
    top = float(maps.norm.vmax or 0.0)
    clipped = any((one.values > top).any() for one in maps.maps)
    bar_ax = add_colour_bar(figure, place, maps.norm, shades(), "max" if clipped else "neither").ax
    locator = LogLocator(subs=(1.0, 2.0, 5.0)) if isinstance(maps.norm, LogNorm) else MaxNLocator(6)
    bar_ax.yaxis.set_major_locator(locator)
    bar_ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bar_ax.yaxis.set_minor_formatter(NullFormatter())
    bar_ax.set_title(f"σ [{maps.unit}]", loc="left", pad=19)
    if clipped:
        bar_ax.text(1.5, 1.08, f"> {top:g}", transform=bar_ax.transAxes, va="center", size=6.5)


def _add_legend(figure: Figure) -> None:
    from matplotlib.patches import Patch

    patch = Patch(facecolor=LOST, label="not in both\nimages")
    figure.legend(handles=[patch], loc="lower right", borderaxespad=0, fontsize=6)


def _at(depth_m: float) -> str:
    return "at infinity" if math.isinf(depth_m) else f"at {three_digits(depth_m)} m"


def _rounded_up(value: float) -> float:
    """The next of 1, 2, 5, 10, ... ."""
    decade = 10.0 ** math.floor(math.log10(value))
    return next(step * decade for step in (1, 2, 5, 10) if step * decade >= value * (1 - 1e-9))


def _rounded_down(value: float) -> float:
    decade = 10.0 ** math.floor(math.log10(value))
    return next(step * decade for step in (5, 2, 1) if step * decade <= value * (1 + 1e-9))


def _plain(value: float) -> Any:
    """A number as JSON has it: none for NaN, a word for infinity."""
    if math.isnan(value):
        return None
    return "infinity" if math.isinf(value) else value
