"""Images are read as they are stored, whatever their depth, and what is none says so in a line."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.images.reading import read_image
from rectbench.warps.lookup.resampling import REMAPPED_TYPES


@pytest.mark.parametrize(
    ("suffix", "dtype", "channels"),
    [
        (".png", "uint8", 1),
        (".png", "uint8", 3),
        (".png", "uint8", 4),
        (".png", "uint16", 1),
        (".png", "uint16", 4),
        (".tiff", "uint16", 3),
        (".tiff", "int16", 1),
        (".tiff", "float32", 3),
        (".tiff", "float64", 1),
        (".pgm", "uint16", 1),
        (".pfm", "float32", 3),
        (".bmp", "uint8", 3),
    ],
)
def test_depth_and_channels_are_kept_and_colours_are_rgb(
    tmp_path: Path, suffix: str, dtype: str, channels: int
) -> None:
    shape = (7, 9) if channels == 1 else (7, 9, channels)
    image = (np.random.default_rng(0).uniform(0, 250, shape)).astype(dtype)
    path = tmp_path / f"image{suffix}"
    assert cv2.imwrite(str(path), image if channels == 1 else image[..., [2, 1, 0, 3][:channels]])
    found = read_image(path)
    assert found.dtype == dtype
    np.testing.assert_array_equal(found, image)


@pytest.mark.parametrize(("stored", "read_as"), [("int8", "int16"), ("int32", "float64")])
def test_depths_that_cannot_be_resampled_become_wider(tmp_path: Path, stored: str, read_as: str) -> None:
    image = np.random.default_rng(0).integers(-100, 100, (7, 9)).astype(stored)
    cv2.imwrite(str(tmp_path / "image.tiff"), image)
    found = read_image(tmp_path / "image.tiff")
    assert found.dtype == read_as
    assert found.dtype in REMAPPED_TYPES
    np.testing.assert_array_equal(found, image)


def test_orientation_tags_turn_nothing(tmp_path: Path) -> None:
    """A calibration speaks of the sensor's rows and columns, however the camera was held."""
    image = np.random.default_rng(0).integers(0, 255, (6, 9), np.uint8)
    ok, data = cv2.imencode(".jpg", image)
    assert ok
    tiff = b"II*\0\x08\0\0\0" + struct.pack("<HHHIHHI", 1, 0x0112, 3, 1, 6, 0, 0)
    exif = b"Exif\0\0" + tiff
    content = data.tobytes()[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + data.tobytes()[2:]
    (tmp_path / "turned.jpg").write_bytes(content)
    assert cv2.imread(str(tmp_path / "turned.jpg")).shape[:2] == (9, 6)  # the tag is there
    assert read_image(tmp_path / "turned.jpg").shape == (6, 9)


def png_of(width: int, height: int) -> bytes:
    """A PNG whose header promises this size, and no pixels."""
    header = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"not an image",
        png_of(8, 8),
        png_of(1 << 30, 1 << 30),
        b"P5\n9 9\n255\n",
    ],
    ids=["empty", "text", "no pixels", "promises too much", "cut off"],
)
def test_what_is_no_image_is_one_line_and_opencv_is_quiet(
    tmp_path: Path, content: bytes, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "broken.png"
    path.write_bytes(content)
    with pytest.raises(rb.InvalidInput, match=r"broken\.png") as raised:
        read_image(path)
    assert len(str(raised.value).splitlines()) == 1
    assert capfd.readouterr() == ("", "")


def test_a_missing_image_and_a_folder_are_named(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.png", tmp_path):
        with pytest.raises(rb.InvalidInput, match="no such image"):
            read_image(path)
