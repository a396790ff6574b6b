"""A rectification and its images as files: what runs on the robot, and what a person looks at."""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable, Mapping
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import Unsupported
from rectbench.images.reading import Rgb, encoded, rgb8
from rectbench.warps import Rectification, opencv_form
from rectbench.warps.description import rectification_text
from rectbench.warps.lookup.resampling import Side

SIDES: tuple[Side, Side] = ("left", "right")
PNG_TYPES = (np.dtype("uint8"), np.dtype("uint16"))
SUFFIXES = (".png", ".tiff")
SCAN_LINES = 24
LINE_RGB = (90, 220, 90)
GAP_PX = 8
"""Between the two images of a preview."""
PREVIEW_WIDTH_PX = 2400
"""A wider preview is made smaller."""

Files = dict[str, bytes]
"""Contents by name."""


def description_files(rect: Rectification, **facts: Any) -> Files:
    """`rectified.yaml`, see `rectbench.warps.description`; `opencv.yml` where OpenCV has a form for it.

    `opencv.yml` is an OpenCV FileStorage with `R1 R2 P1 P2 Q` and `image_width image_height`. Where there is
    none, `rectified.yaml` says why.
    """
    try:
        form = opencv_form(rect)
    except Unsupported as reason:
        return {"rectified.yaml": rectification_text(rect, **facts, opencv=f"none: {reason}").encode()}
    width, height = rect.size
    numbers = {"image_width": width, "image_height": height, **form._asdict()}
    described = rectification_text(rect, **facts, opencv="opencv.yml")
    return {"rectified.yaml": described.encode(), "opencv.yml": _storage(numbers)}


def mask_files(rect: Rectification) -> Files:
    """`left_mask.png` and `right_mask.png`: 255 where the image shows source pixels, 0 elsewhere."""
    return {f"{side}_mask.png": encoded(255 * rect.valid(side).astype(np.uint8)) for side in SIDES}


def npz_tables(rect: Rectification) -> Files:
    """`maps.npz`: `map_x_left map_y_left map_x_right map_y_right`, float32 for `cv2.remap`."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **_float_maps(rect))  # compressing takes seconds and saves a tenth
    return {"maps.npz": buffer.getvalue()}


def opencv_tables(rect: Rectification) -> Files:
    """`maps.yml.gz`: the same four as matrices of an OpenCV FileStorage."""
    return {"maps.yml.gz": _compressed(_storage(_float_maps(rect)))}


def fixed_tables(rect: Rectification) -> Files:
    """`maps_fixed.yml.gz`: `map1_left map2_left map1_right map2_right` as `cv2.convertMaps` makes them.

    CV_16SC2 whole pixels and CV_16UC1 thirty-seconds of one: half the memory, and quicker to remap by.
    """
    tables: dict[str, NDArray[Any]] = {}
    for side in SIDES:
        whole, fraction = cv2.convertMaps(*rect.maps(side), cv2.CV_16SC2)
        tables |= {f"map1_{side}": whole, f"map2_{side}": fraction}
    return {"maps_fixed.yml.gz": _compressed(_storage(tables))}


TABLES: Mapping[str, Callable[[Rectification], Files]] = {
    "npz": npz_tables,
    "opencv": opencv_tables,
    "fixed": fixed_tables,
}
"""The kinds of lookup tables by name."""


def image_file(image: NDArray[np.generic]) -> tuple[str, bytes]:
    """The suffix and content of an image file of the same depth: PNG for 8 and 16 bits, else TIFF."""
    suffix = SUFFIXES[0] if image.dtype in PNG_TYPES else SUFFIXES[1]
    return suffix, encoded(image, suffix)


def preview_file(left: NDArray[np.generic], right: NDArray[np.generic]) -> bytes:
    """A PNG of both rectified images, see `side_by_side`."""
    return encoded(side_by_side(left, right))


def side_by_side(left: NDArray[np.generic], right: NDArray[np.generic]) -> Rgb:
    """Both rectified images with scan lines across them, in 8 bits [H, W, 3]."""
    images = [rgb8(image) for image in (left, right)]
    scale = min(1.0, PREVIEW_WIDTH_PX / (2 * images[0].shape[1] + GAP_PX))
    if scale < 1:
        size = tuple(max(1, round(side * scale)) for side in images[0].shape[1::-1])
        images = [cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in images]
    gap = np.full((len(images[0]), GAP_PX, 3), 255, np.uint8)
    both = np.concatenate([images[0], gap, images[1]], axis=1)
    rows = np.linspace(0, len(both) - 1, SCAN_LINES + 2)[1:-1].round().astype(int)
    both[rows] = LINE_RGB
    return both


def _float_maps(rect: Rectification) -> dict[str, NDArray[Any]]:
    return {
        f"map_{axis}_{side}": table
        for side in SIDES
        for axis, table in zip("xy", rect.maps(side), strict=True)
    }


def _storage(values: Mapping[str, Any]) -> bytes:
    """An OpenCV FileStorage in YAML, its large matrices in base64, which reads a hundred times as fast."""
    large = any(np.size(value) > 1000 for value in values.values())
    # The form that OpenCV 3 and 4 write, too: it will be read by a robot of that age.
    flags = cv2.FILE_STORAGE_FORMAT_YAML_1_0 | cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY
    storage = cv2.FileStorage(".yml", flags | (cv2.FILE_STORAGE_BASE64 if large else 0))
    for name, value in values.items():
        storage.write(name, value)
    return storage.releaseAndGetString().encode()


def _compressed(content: bytes) -> bytes:
    return gzip.compress(content, compresslevel=1, mtime=0)
