"""Which pixels a method is fitted to and scored on: about 500, evenly, inside the image circle."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from rectbench.cameras import Camera
from rectbench.types import FloatArray

EVALUATION_PIXELS = 500
"""The paper's "around 500 pixels evenly distributed all over the image" (section III-D)."""


def evaluation_pixels(camera: Camera, count: int = EVALUATION_PIXELS) -> FloatArray:
    """The fixed grid of about `count` pixels [N, 2], row by row.

    Cells of a grid with the image's aspect, their centres; those the lens does not see are left
    out, and the grid is made finer by their share, so that about `count` remain.

    >>> import rectbench as rb
    >>> rb.evaluation_pixels(rb.load_rig("t265").left).shape
    (489, 2)
    """
    return _seen_cell_centres(camera, count).copy()


@lru_cache(maxsize=16)
def _seen_cell_centres(camera: Camera, count: int) -> FloatArray:
    """All methods of a rig ask for them, and each several times."""
    grid = _cell_centres(camera, count)
    seen = camera.unproject(grid)[1]
    if 0 < seen.mean() < 1:
        grid = _cell_centres(camera, count / seen.mean())
        seen = camera.unproject(grid)[1]
    return grid[seen]


def _cell_centres(camera: Camera, count: float) -> FloatArray:
    across = max(1, round(math.sqrt(count * camera.width / camera.height)))
    down = max(1, round(count / across))
    u = (np.arange(across) + 0.5) * camera.width / across - 0.5
    v = (np.arange(down) + 0.5) * camera.height / down - 0.5
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)


GOLDEN_SECTION = (5**0.5 - 1) / 2


def lattice_pixels(camera: Camera, count: int) -> FloatArray:
    """As many pixels [N, 2] of Fibonacci's lattice over the image, those that the lens sees.

    As even as a grid, but no two share a row or a column (even steps across, of a golden section down), so
    that they tell more of what varies along rows or columns alone.

    >>> import rectbench as rb
    >>> rb.lattice_pixels(rb.load_rig("sony-as200v").left, 4).astype(int)
    array([[ 239,    0],
           [ 719,  666],
           [1199,  254],
           [1679,  921]])
    """
    number = np.arange(count)
    shares = np.stack([(number + 0.5) / count, number * GOLDEN_SECTION % 1], axis=-1)
    pixels: FloatArray = shares * np.array(camera.size) - 0.5
    return pixels[camera.unproject(pixels)[1]]


RIM_POINTS = 257
"""Points a side of the rim: between two of them an angle's extreme moves by hundredths of a pixel."""


def outline_pixels(camera: Camera) -> tuple[FloatArray, float]:
    """Pixels [N, 2] whose images bound the view's image under any continuous map, and their spacing.

    The rim of the image, half a pixel out, where the lens sees all of it; else a grid over the whole
    image too, since the image circle's edge, or that of the part where the lens is blind, then bounds the
    view. The spacing in pixels tells how far the bound may be off; it is 0 for the rim alone.

    >>> import rectbench as rb
    >>> pixels, spacing_px = rb.outline_pixels(rb.load_rig("bumblebee2").left)
    >>> pixels.shape, spacing_px
    ((1028, 2), 0.0)
    """
    rim = camera.rim(RIM_POINTS)
    if camera.blind is None and camera.unproject(rim)[1].all():
        return rim, 0.0
    u, v = (
        np.linspace(-0.5, camera.width - 0.5, RIM_POINTS),
        np.linspace(-0.5, camera.height - 0.5, RIM_POINTS),
    )
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    inside = grid[camera.unproject(grid)[1]]
    return inside, max(camera.size) / (RIM_POINTS - 1)
