"""Lookup tables for `cv2.remap`: for each rectified pixel, where to read in the source image."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench import llvm
from rectbench.formulas.evaluation import namespaced, opaque
from rectbench.formulas.namespaces import NUMPY, drjit_namespace
from rectbench.formulas.protocol import Formulas
from rectbench.types import BoolArray
from rectbench.warps.targets import Axis
from rectbench.warps.warp import Warp, rotated_back

OUTSIDE = -16.0
"""Table entry of a rectified pixel whose ray the lens cannot see.

Beyond the support of every interpolation of `cv2.remap`, so that it reads the border colour; not
NaN, which bilinear `remap` of float images would hand on.
"""

FloatMap = NDArray[np.float32]
Table = tuple[FloatMap, FloatMap]
"""(map_x, map_y) [height, width] float32, source pixels."""


def lookup_table(warp: Warp, size: tuple[int, int]) -> Table:
    """(map_x, map_y) [height, width] float32, source pixels, for a rectified image of `size`."""
    columns, rows = warp.target.axis_tables(np.arange(size[0], dtype=float), np.arange(size[1], dtype=float))
    fill = _fill_compiled if llvm.available() else _fill_with_numpy
    return fill(warp, columns, rows)


def reads_source(map_x: FloatMap, map_y: FloatMap, size: tuple[int, int]) -> BoolArray:
    """Mask of table entries that read nothing but pixels of a source image of `size`."""
    in_columns, in_rows = (
        cv2.inRange(layer, np.zeros(1), np.array([side - 1.0]))
        for layer, side in zip((map_x, map_y), size, strict=True)
    )
    reads: BoolArray = (in_columns & in_rows).astype(bool)
    return reads


def _source_pixel(warp: Warp, c: Any, column: Any, row: Any, xp: Formulas) -> tuple[Any, Any]:
    x, y, z, ok = warp.target.ray_formula(c.target, column, row, xp)
    u, v, seen = warp.source.project_formula(c.source, *rotated_back(c.R, x, y, z), xp)
    known = ok & seen
    return xp.where(known, u, OUTSIDE), xp.where(known, v, OUTSIDE)


def _fill_with_numpy(warp: Warp, columns: Axis, rows: Axis) -> Table:
    c: SimpleNamespace = namespaced(warp.constants)
    along = tuple(values[None, :] for values in columns)
    with np.errstate(all="ignore"):
        maps = _source_pixel(warp, c, along, tuple(values[:, None] for values in rows), NUMPY)
    shape = (rows[0].size, columns[0].size)
    map_x, map_y = (np.broadcast_to(values, shape).astype(np.float32) for values in maps)
    return map_x, map_y


def _fill_compiled(warp: Warp, columns: Axis, rows: Axis) -> Table:
    xp = drjit_namespace()
    import drjit as dr
    from drjit.llvm import Float, Float64, UInt32

    width, height = columns[0].size, rows[0].size
    per_row = Float64(1 / width)
    dr.make_opaque(per_row)
    index = dr.arange(UInt32, width * height)
    y = UInt32((Float64(index) + 0.5) * per_row)  # a whole-number division costs more than the lens
    x = index - y * UInt32(dr.opaque(UInt32, width))
    column = tuple(dr.gather(Float64, Float64(values), x) for values in columns)
    row = tuple(dr.gather(Float64, Float64(values), y) for values in rows)
    maps = [Float(m) for m in _source_pixel(warp, opaque(warp.constants), column, row, xp)]
    dr.eval(*maps)
    map_x, map_y = (m.numpy().reshape(height, width) for m in maps)
    return map_x, map_y
