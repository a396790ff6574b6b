"""A rectified image pair as files: images, masks, lookup tables, and a preview to look at."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from rectbench.errors import Unavailable
from rectbench.rendering.images import StereoPair
from rectbench.warps import Rectification

SCAN_LINES = 24
LINE_RGB = (90, 220, 90)


def write_rectified(rect: Rectification, pair: StereoPair, folder: Path) -> list[Path]:
    """Write the files of a rectified pair; returns their paths.

    `left.png`, `right.png`; `left_mask.png`, `right_mask.png` (255 where the image shows anything);
    `maps.npz` with `map_x_left`, `map_y_left`, `map_x_right`, `map_y_right` for `cv2.remap`;
    `preview.png`, both images side by side with scan lines. Raises Unavailable where the disk takes
    no more.
    """
    left, right = rect.remap(pair.left, pair.right)
    images = {
        "left.png": left,
        "right.png": right,
        "left_mask.png": _mask(rect.valid("left")),
        "right_mask.png": _mask(rect.valid("right")),
        "preview.png": _preview(left, right),
    }
    maps = {
        f"map_{axis}_{side}": table
        for side in ("left", "right")
        for axis, table in zip("xy", rect.maps(side), strict=True)
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, image in images.items():
            _write_png(folder / name, image)
        with (folder / "maps.npz").open("wb") as stream:
            np.savez_compressed(stream, allow_pickle=False, **maps)
    except OSError as error:
        raise Unavailable(f"{folder} cannot be written: {error.strerror or error}") from error
    return [folder / name for name in (*images, "maps.npz")]


def _mask(valid: NDArray[np.bool_]) -> NDArray[np.uint8]:
    mask: NDArray[np.uint8] = np.where(valid, 255, 0).astype(np.uint8)
    return mask


def _preview(left: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    both = np.concatenate([left, right], axis=1)
    rows = np.linspace(0, both.shape[0] - 1, SCAN_LINES + 2)[1:-1].round().astype(int)
    both[rows] = LINE_RGB
    return both


def _write_png(path: Path, image: NDArray[Any]) -> None:
    colours = cv2.cvtColor(image, cv2.COLOR_RGB2BGR) if image.ndim == 3 else image
    ok, data = cv2.imencode(".png", colours)
    if not ok:
        raise OSError(f"OpenCV cannot encode {path.name}")
    path.write_bytes(data.tobytes())
