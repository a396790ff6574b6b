"""Image files as arrays and back; the 8-bit grey that feature detectors take, and 8 bits of RGB."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidInput, Unavailable
from rectbench.types import Images

Grey = NDArray[np.uint8]
Rgb = NDArray[np.uint8]

IMAGE_SUFFIXES = frozenset(
    {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".pnm", ".webp", ".jp2", ".exr"}
)
"""Of files that are taken for images."""
BLACK_TO_WHITE = (0.1, 99.8)
"""Percentiles that become black and white where an image is not of 8 bits: a 12-bit sensor fills a
sixteenth of 16 bits, and a few glints must not darken all else."""


def read_images(left: str | Path, right: str | Path) -> Images:
    """Two image files as they are stored, grey or RGB(A), of any depth; InvalidInput for no image."""
    return Images(read_image(left), read_image(right))


def grey8(image: NDArray[np.generic], side: str = "") -> Grey:
    """An image [H, W], or [H, W, C] of 1 to 4 channels (RGB, alpha last), as uint8 grey [H, W].

    8-bit values stay what they are; of others the range that the image fills is stretched. `side`
    names the image in the InvalidInput that another shape, or an image of no numbers, raises.
    """
    pixels = _checked(image, side)
    channels = pixels.shape[2]
    if channels >= 3:
        grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY if channels == 3 else cv2.COLOR_RGBA2GRAY)
    else:
        grey = pixels[:, :, 0]
    return _stretched(grey)


def rgb8(image: NDArray[np.generic], side: str = "") -> Rgb:
    """An image as `grey8` takes it, as uint8 [H, W, 3]; of other than 8 bits its range is stretched alike."""
    pixels = _checked(image, side)
    return _stretched(pixels[:, :, :3] if pixels.shape[2] >= 3 else np.repeat(pixels[:, :, :1], 3, axis=2))


def _checked(image: NDArray[np.generic], side: str) -> NDArray[Any]:
    """The pixels [H, W, C] as uint8 or float32; InvalidInput, by the side's name, for what is no image."""
    pixels = np.asarray(image)
    name = f"the {side} image" if side else "the image"
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    if pixels.ndim not in (2, 3) or channels not in (1, 2, 3, 4) or not pixels.size:
        raise InvalidInput(f"{name} has shape {pixels.shape}; expected [H, W] or [H, W, 1 to 4 channels]")
    if pixels.dtype.kind not in "buif":
        raise InvalidInput(f"{name} holds {pixels.dtype}; expected numbers")
    if pixels.dtype != np.uint8:
        pixels = pixels.astype(np.float32)
    return np.ascontiguousarray(pixels).reshape(*pixels.shape[:2], channels)


def _stretched(pixels: NDArray[Any]) -> NDArray[np.uint8]:
    """Of 8 bits what it is; of others black and white by `BLACK_TO_WHITE`, the same of all channels."""
    if pixels.dtype == np.uint8:
        return np.ascontiguousarray(pixels)
    finite = pixels[np.isfinite(pixels)]
    black, white = np.percentile(finite, BLACK_TO_WHITE) if finite.size else (0.0, 0.0)
    if not white > black:
        return np.zeros(pixels.shape, np.uint8)
    levels = np.nan_to_num((pixels - black) * (255 / (white - black)), posinf=255)
    stretched: NDArray[np.uint8] = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
    return stretched


def read_image(path: str | Path) -> NDArray[np.generic]:
    """An image file as it is stored: [H, W] grey or [H, W, 3 or 4] RGB(A), of the depth it has.

    Depths that `cv2.remap` does not take are made the next wider one. Orientation tags are ignored: a
    calibration is one of the sensor's own rows and columns. Raises InvalidInput for what is no image.
    """
    image = _swapped(_opened(path, cv2.IMREAD_UNCHANGED))
    return np.ascontiguousarray(image.astype(_WIDER.get(image.dtype.name, image.dtype), copy=False))


def read_colours(path: str | Path) -> Rgb:
    """An image file as 8 bits of RGB [H, W, 3], upright by its orientation tag; InvalidInput for no image."""
    return np.ascontiguousarray(_swapped(_opened(path, cv2.IMREAD_COLOR)))


def _opened(path: str | Path, how: int) -> NDArray[Any]:
    """An image file as OpenCV reads it under this flag."""
    if not Path(path).is_file():
        raise InvalidInput(f"{path}: no such image")
    try:
        with _quiet_opencv():
            image: NDArray[Any] | None = cv2.imread(str(path), how)
    except cv2.error as error:  # a header that promises more pixels than OpenCV takes
        raise InvalidInput(f"{path}: OpenCV refuses it ({' '.join(str(error.err).split())})") from None
    if image is None:
        raise InvalidInput(f"{path}: not an image that OpenCV can read")
    return image


def encoded(image: NDArray[np.generic], suffix: str = ".png") -> bytes:
    """An image [H, W], or [H, W, 3 or 4] in RGB(A), as the content of an image file of this suffix.

    Raises Unavailable where OpenCV cannot write one of this depth.
    """
    ok, data = cv2.imencode(suffix, np.ascontiguousarray(_swapped(image)))
    if not ok:
        raise Unavailable(f"OpenCV cannot encode a {suffix} of {image.dtype}")
    return bytes(data)


def _swapped(image: NDArray[Any]) -> NDArray[Any]:
    """The image in OpenCV's order of channels, BGR(A), or back in RGB(A)."""
    return image[..., [2, 1, 0, 3][: image.shape[2]]] if image.ndim == 3 and image.shape[2] >= 3 else image


@contextmanager
def _quiet_opencv() -> Iterator[None]:
    """Without the words of its own that OpenCV has for a damaged file."""
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        yield
    finally:
        cv2.utils.logging.setLogLevel(level)


_WIDER = {"bool": "uint8", "int8": "int16", "int32": "float64", "uint32": "float64", "float16": "float32"}
