"""The arrays of a dataset in the file formats that other people's tools read."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench.images.reading import encoded
from rectbench.rendering.variant import mitsuba

FloatMap = NDArray[np.floating[Any]]

KITTI_STEPS = 256
"""KITTI's steps a pixel of disparity, in 16 bits; 0 stands for none."""
LARGEST_16_BIT = 65535
NO_FLOW = 1e10
"""What Middlebury's .flo has where nothing is known: all above 1e9."""
FLO_TAG = b"PIEH"
"""The float 202021.25, with which every .flo begins."""


def mask_png(mask: NDArray[np.bool_]) -> bytes:
    """A PNG with 255 where the mask holds, else 0."""
    return encoded(255 * mask.astype(np.uint8))


def pfm(values: FloatMap) -> bytes:
    """A little-endian PFM [H, W] in float32, its rows from the bottom up, as the format has them."""
    return encoded(values.astype(np.float32), ".pfm")


def exr(values: FloatMap) -> bytes:
    """An OpenEXR [H, W] with one float32 channel, Y."""
    mi = mitsuba()
    bitmap = mi.Bitmap(values.astype(np.float32)[..., None], mi.Bitmap.PixelFormat.Y)
    stream = mi.MemoryStream()
    bitmap.write(stream, mi.Bitmap.FileFormat.OpenEXR)
    return bytes(stream.raw_buffer())


def millimetres_png(metres: FloatMap) -> bytes:
    """A 16 bit PNG of millimetres; 0 where there is nothing, or more than 65.535 m."""
    return encoded(_whole(metres * 1000.0))


def kitti_png(disparity_px: FloatMap) -> bytes:
    """KITTI's 16 bit PNG of 256 steps a pixel; 0 where there is none, or one outside (0, 256) px."""
    return encoded(_whole(disparity_px * KITTI_STEPS))


def fits_kitti(disparity_px: FloatMap) -> NDArray[np.bool_]:
    """Where `kitti_png` has a place for a disparity."""
    return _whole(disparity_px * KITTI_STEPS) > 0


def flo(flow_px: FloatMap) -> bytes:
    """Middlebury's .flo of (du, dv) [H, W, 2] in float32, 1e10 where there is none."""
    height, width = flow_px.shape[:2]
    known = np.where(np.isfinite(flow_px).all(axis=-1, keepdims=True), flow_px, NO_FLOW)
    return FLO_TAG + struct.pack("<ii", width, height) + known.astype("<f4").tobytes()


def _whole(values: FloatMap) -> NDArray[np.uint16]:
    """Rounded to whole numbers of 16 bits; 0 for what is not finite or has no place."""
    rounded = np.rint(np.nan_to_num(values, nan=0.0, posinf=0.0, neginf=0.0))
    rounded[(rounded < 0) | (rounded > LARGEST_16_BIT)] = 0
    return rounded.astype(np.uint16)
