"""NumPy's `.npz` archives as plain lists, from files that are not trusted.

The format of an array is that of `numpy.lib.format`; an archive is a zip file of them. Nothing is unpickled.
"""

from __future__ import annotations

import io
import math
import struct
import zipfile
import zlib
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy

from rectbench.calibrations.documents.parsing import MAX_KEY, Malformed

MARK = b"PK\x03\x04"
"""How a zip file begins."""

MAX_ENTRIES = 200
MAX_ENTRY_BYTES = 1 << 18
"""Larger arrays are maps, images and points, which say nothing of a rig that its matrices do not."""

SUFFIX = ".npy"
DAMAGE = (zipfile.BadZipFile, zlib.error, struct.error, ValueError, EOFError, OSError, RuntimeError)
"""What zipfile raises of a file that is none, or is cut short, encrypted or compressed in another way."""

HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def parse_archive(stream: IO[bytes]) -> dict[str, Any]:
    """The arrays of an archive by name: numbers, strings, or lists of them; of large ones the size, in words.

    Raises Malformed for what is no archive of arrays.
    """
    try:
        with zipfile.ZipFile(stream) as archive:
            entries = archive.infolist()
            if len(entries) > MAX_ENTRIES:
                raise Malformed(f"has over {MAX_ENTRIES} arrays")
            return {_name(entry): _value(archive, entry) for entry in entries}
    except Malformed:
        raise
    except DAMAGE as error:
        raise Malformed(f"is no .npz archive ({error})") from None


def _name(entry: zipfile.ZipInfo) -> str:
    if not entry.filename.endswith(SUFFIX) or len(entry.filename) > MAX_KEY:
        raise Malformed(f"holds {entry.filename[:40]!r}, which is no array")
    return entry.filename.removesuffix(SUFFIX)


def _value(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Any:
    if entry.file_size > MAX_ENTRY_BYTES:
        return f"{entry.file_size} bytes"
    with archive.open(entry) as stream:
        content = stream.read(MAX_ENTRY_BYTES + 1)
    try:
        array = _array(content)
    except (ValueError, TypeError, KeyError, OverflowError, SyntaxError) as error:
        raise (
            error
            if isinstance(error, Malformed)
            else Malformed(f"holds {entry.filename[:40]!r}, which is no array ({error})")
        ) from None
    return array.astype(np.float64).tolist() if array.dtype.kind in "fiub" else array.astype(str).tolist()


def _array(content: bytes) -> np.ndarray[Any, Any]:
    """The array in those bytes, whose number its header must state, so that a short file stays short."""
    stream = io.BytesIO(content)
    version = npy.read_magic(stream)
    if version not in HEADERS:
        raise Malformed(f"has an array of version {version[0]}.{version[1]}")
    shape, is_fortran, dtype = HEADERS[version](stream)
    rest = content[stream.tell() :]
    if dtype.hasobject:
        raise Malformed("holds Python objects, which are not unpickled")
    if dtype.kind not in "fiubUS":
        raise Malformed(f"has an array of {dtype}")
    if math.prod(shape) * dtype.itemsize != len(rest) or not rest:
        raise Malformed(f"has an array of {len(rest)} bytes that says it is {shape} of {dtype}")
    return np.frombuffer(rest, dtype).reshape(shape, order="F" if is_fortran else "C")
