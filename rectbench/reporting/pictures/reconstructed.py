"""A reconstruction as files: cloud, depth, disparity, and a picture to show."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import Unavailable
from rectbench.matching import Reconstruction
from rectbench.reporting.pictures.panels import fit_into_box, panel_grid, write_head
from rectbench.reporting.pictures.views import painted, patches_of, two_views
from rectbench.reporting.style import LOST, PAGE_INCHES, STYLE, add_colour_bar, encode, plain_log_ticks
from rectbench.writing import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FARTHEST_MM = 65535
"""What 16 bits hold."""
DOTS_PER_INCH = 220
NEARLY_ALL = (0.02, 0.98)
"""Quantiles of depth between which the colours run."""
BAR_INCHES = 0.5
VIEW_PX = 720


def write_reconstruction(reconstruction: Reconstruction, folder: Path) -> list[Path]:
    """Write the files of a reconstruction; returns their paths.

    `cloud.ply`, coloured points in the left camera's frame, metres. At the pixels of the rectified left
    image `left.png`: `depth.npz` with `depth_m` and `disparity_px`, float32, NaN where there is none,
    and `depth_mm.png`, millimetres in 16 bits, 0 where there is none or more than 65.5 m. `picture.png`.
    Depth is distance from the left camera along the pixel's ray. Raises InvalidInput where nothing was
    reconstructed, Unavailable where the disk takes no more.
    """
    depth = reconstruction.depth
    millimetres = np.nan_to_num(depth * np.float32(1000))
    millimetres[millimetres > FARTHEST_MM] = 0
    cloud = reconstruction.ply()
    arrays = io.BytesIO()
    np.savez_compressed(arrays, allow_pickle=False, depth_m=depth, disparity_px=reconstruction.disparity.px)
    contents = {
        "cloud.ply": cloud,
        "depth.npz": arrays.getvalue(),
        "depth_mm.png": _png(np.rint(millimetres).astype(np.uint16)),
        "left.png": _png(reconstruction.colours[..., ::-1]),
        "picture.png": encode(draw_reconstruction(reconstruction), "png", DOTS_PER_INCH),
    }
    for name, content in contents.items():
        write_atomically(folder / name, content)
    return [folder / name for name in contents]


def draw_reconstruction(reconstruction: Reconstruction) -> Figure:
    """The rectified left image, the distance of its pixels in colours, and two views of the cloud.

    Expects a reconstruction with points.
    """
    from matplotlib import colormaps, rc_context
    from matplotlib.colors import LogNorm

    depth, (width, height) = reconstruction.depth, reconstruction.rect.size
    low, high = np.nanquantile(depth, NEARLY_ALL)
    norm = LogNorm(low, max(high, 1.01 * low))
    shades = colormaps["turbo_r"](norm(depth))
    shades[np.isnan(depth)] = colormaps["turbo_r"].with_extremes(bad=LOST).get_bad()
    outside = ~reconstruction.rect.valid("left")
    shades[outside] = 1.0
    photograph = np.where(outside[..., None], np.uint8(255), reconstruction.colours)
    size = VIEW_PX, round(VIEW_PX * height / width)
    patches = patches_of(reconstruction.points, reconstruction.colours)
    beside, above = (painted(patches, view, size) for view in two_views(patches.points, size))
    panels = {
        "rectified left image": photograph,
        "distance": shades,
        "the points, seen from beside the camera": beside,
        "the points, seen from above": above,
    }
    with rc_context(fname=STYLE):
        figure, axes = panel_grid(len(panels), 2, height / width, BAR_INCHES)
        for ax, (name, image) in zip(axes, panels.items(), strict=True):
            ax.imshow(image, interpolation="antialiased", aspect="auto")
            fit_into_box(ax, image.shape[1], image.shape[0])
            write_head(ax, name, "grey: not found" if name == "distance" else "")
        box = axes[1].get_position()
        place = (1 - 0.8 * BAR_INCHES / PAGE_INCHES, box.y0, 0.1 / PAGE_INCHES, box.height)
        bar_ax = add_colour_bar(figure, place, norm, "turbo_r").ax
        plain_log_ticks(bar_ax.yaxis)
        bar_ax.set_title("m")
    return figure


def _png(image: NDArray[Any]) -> bytes:
    ok, data = cv2.imencode(".png", image)
    if not ok:
        raise Unavailable("OpenCV cannot encode a PNG")
    return bytes(data)
