"""OpenCV's stereo calibrations, YAML, XML or JSON, as `cv2.FileStorage` and OpenCV's samples write them.

| what | keys, for camera 1 (left) and 2 (right) |
|---|---|
| matrix | `M1`, `K1`, `cameraMatrix1`, `camera_matrix_1` ...; without the number in a file of one camera |
| distortion | `D1`, `distCoeffs1`, `distortion_coefficients_1` ... |
| Mei's ξ | `xi1`, `xi_1`; makes the camera omnidirectional |
| pose | `R` (3x3 or a rotation vector) and `T`, or `rvec` and `tvec`; X_right = R X_left + T, metres |
| image | `image_width` and `image_height`, or `imageSize`, `image_size` |
| lens | `model` (or `camera_model`): pinhole, fisheye or omnidir; or `fisheye_model: 1` |

Four distortion coefficients mean a pinhole camera unless the file says `fisheye`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from rectbench.cameras import Camera
from rectbench.cameras.arrays import FloatArray
from rectbench.errors import InvalidInput
from rectbench.rigs.documents import blaming, checked_size, one_line, shown
from rectbench.rigs.rig import Rig

MATRIX = ("M", "K", "cameraMatrix", "camera_matrix", "CameraMatrix")
DISTORTION = ("D", "distCoeffs", "dist_coeffs", "distortion_coefficients", "DistCoeffs")
XI = ("xi",)
ROTATION = ("R", "rvec")
TRANSLATION = ("T", "tvec")
SIZE = ("imageSize", "image_size", "ImageSize")
MODEL = ("model", "camera_model")

CAMERA_MODELS = {"pinhole": "pinhole", "fisheye": "kannala-brandt", "omnidir": "unified"}
PINHOLE_ORDER = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
ORDERS = {"pinhole": PINHOLE_ORDER, "fisheye": ("k1", "k2", "k3", "k4"), "omnidir": ("k1", "k2", "p1", "p2")}
PINHOLE_COUNTS = (4, 5, 8, 12, 14)
"""Lengths of OpenCV's distortion vector; the last two of 14 tilt the sensor."""

LENSES = {
    "pinhole": "pinhole",
    "perspective": "pinhole",
    "radtan": "pinhole",
    "plumb_bob": "pinhole",
    "rational_polynomial": "pinhole",
    "fisheye": "fisheye",
    "equidistant": "fisheye",
    "kannala-brandt": "fisheye",
    "kannala_brandt": "fisheye",
    "omnidir": "omnidir",
    "omni": "omnidir",
    "mei": "omnidir",
}
MAX_NUMBERS = 256
"""No matrix of a rig has more; one that claims so would make OpenCV allocate it."""

BASE64 = re.compile(r"!!binary|\$base64\$|type_id\s*=\s*[\"']binary")
"""OpenCV's parser can hang for good on matrices in base64, which calibrations do not use."""

MAX_OPENINGS = 8000
"""Brackets, tags and keys of a file. OpenCV's parser recurses into them and, at some tens of
thousands inside each other, overflows the stack, which kills the process."""


def read_opencv(documents: Sequence[tuple[str, str]], size: tuple[int, int] | None = None) -> Rig:
    """The rig in the (path, content) of one OpenCV file, or of several that complete each other.

    `size` (width, height) stands in for an image size that the files leave out. Raises InvalidInput
    in one line that names file, key and what was expected there.
    """
    files = _Files([_Document.parse(path, text) for path, text in documents])
    left, right = (_read_camera(files, number, size) for number in (1, 2))
    rotation_key, R = files.pose(ROTATION, "a 3x3 rotation or a rotation vector", (9, 3))
    R = R.reshape(3, 3) if R.size == 9 else cv2.Rodrigues(R)[0]
    translation_key, t = files.pose(TRANSLATION, "three metres", (3,))
    with blaming(f"{files}: {rotation_key}, {translation_key}"):
        return Rig(left, right, R, t, name=Path(documents[0][0]).stem)


@dataclass(frozen=True)
class _Document:
    """One file that OpenCV has parsed; its nodes live no longer than the storage they point into."""

    file: str
    storage: Any

    @property
    def root(self) -> Any:
        return self.storage.root()

    @staticmethod
    def parse(file: str, text: str) -> _Document:
        if len(re.findall(r"[\[{<]|[-:]\s", text)) > MAX_OPENINGS:
            raise InvalidInput(
                f"{file}: has over {MAX_OPENINGS} brackets, tags and keys; expected a calibration"
            )
        if BASE64.search(text):
            raise InvalidInput(f"{file}: holds base64; expected matrices of plain numbers")
        try:
            storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        except (cv2.error, SystemError) as error:  # the binding wraps a parser's error in SystemError
            reason = _parser_reason(str(error.__cause__ or error))
            raise InvalidInput(f"{file}: is damaged{reason}; expected an OpenCV calibration") from None
        document = _Document(file, storage)
        if document.root.empty() or not document.root.isMap():
            raise InvalidInput(f"{file}: holds no keys; expected an OpenCV calibration")
        return document

    def __contains__(self, key: str) -> bool:
        return not self.root.getNode(key).empty()

    def at(self, key: str) -> str:
        return f"{self.file}: {key}"

    def array(self, key: str, expected: str, sizes: tuple[int, ...]) -> FloatArray:
        """The finite numbers under `key`, flat: a matrix, a list or a number."""
        node = self.root.getNode(key)
        try:
            numbers = np.array(_numbers(node), dtype=np.float64).ravel()
        except (cv2.error, SystemError, TypeError, ValueError):
            raise InvalidInput(f"{self.at(key)} is no matrix; expected {expected}") from None
        if numbers.size not in sizes or not np.isfinite(numbers).all():
            raise InvalidInput(f"{self.at(key)} is {shown(numbers.tolist())}; expected {expected}")
        return numbers

    def word(self, key: str) -> str:
        """The string under `key`; empty where it is none."""
        node = self.root.getNode(key)
        return str(node.string()) if node.isString() else ""


@dataclass(frozen=True)
class _Files:
    """Files that complete each other; what one lacks is looked for in the next."""

    documents: list[_Document]

    def __str__(self) -> str:
        return " + ".join(document.file for document in self.documents)

    def holders(self, keys: tuple[str, ...]) -> Iterator[tuple[_Document, str]]:
        return ((document, key) for document in self.documents for key in keys if key in document)

    def of_camera(self, keys: tuple[str, ...], number: int) -> Iterator[tuple[_Document, str]]:
        """Numbered keys anywhere, or else the number-th file that speaks of a camera of its own."""
        yield from self.holders(tuple(f"{key}{separator}{number}" for key in keys for separator in ("", "_")))
        owners = (document for document in self.documents if any(key in document for key in MATRIX))
        for document in islice(owners, number - 1, number):
            yield from ((document, key) for key in keys if key in document)

    def first(self, keys: tuple[str, ...], number: int, expected: str) -> tuple[_Document, str]:
        """Document and key where camera `number` has one of `keys`."""
        found = next(self.of_camera(keys, number), None)
        if found is None:
            numbered = " or ".join(f"{key}{number}" for key in keys[:3])
            raise InvalidInput(f"{self}: {numbered} is missing; expected {expected}")
        return found

    def pose(self, keys: tuple[str, ...], expected: str, sizes: tuple[int, ...]) -> tuple[str, FloatArray]:
        """Key and numbers of one half of the pose."""
        for document, key in self.holders(keys):
            return key, document.array(key, expected, sizes)
        raise InvalidInput(
            f"{self}: {' or '.join(keys)} is missing; expected {expected}"
            " (intrinsics and extrinsics in two files are read as a list of both)"
        )


def _read_camera(files: _Files, number: int, size: tuple[int, int] | None) -> Camera:
    document, key = files.first(MATRIX, number, "a 3x3 camera matrix")
    fx, skew, cx, zero, fy, cy, *last = document.array(key, "a 3x3 camera matrix", (9,)).tolist()
    if [skew, zero, *last] != [0, 0, 0, 0, 1]:
        raise InvalidInput(
            f"{document.at(key)} has skew or no last row 0 0 1; expected [fx 0 cx; 0 fy cy; 0 0 1]"
        )
    xi = next(files.of_camera(XI, number), None)
    lens = _read_lens(files, "pinhole" if xi is None else "omnidir")
    counts = PINHOLE_COUNTS if lens == "pinhole" else (4,)
    expected = f"{', '.join(map(str, counts[:-1]))} or {counts[-1]}" if lens == "pinhole" else "4"
    source, name = files.first(DISTORTION, number, f"{expected} distortion coefficients ({lens})")
    distortion = source.array(name, f"{expected} distortion coefficients ({lens})", counts).tolist()
    params = {"fx": fx, "fy": fy, "cx": cx, "cy": cy}
    if lens == "omnidir":
        holder, xi_key = xi or files.first(XI, number, "Mei's xi, a number")
        params["xi"] = float(holder.array(xi_key, "Mei's xi, a number", (1,))[0])
    elif any(distortion[len(PINHOLE_ORDER) :]):
        raise InvalidInput(
            f"{source.at(name)} tilts the sensor (tau); expected its last two of 14 coefficients 0"
        )
    params |= dict(zip(ORDERS[lens], distortion, strict=False))
    image = _read_size(files, document, size)
    with blaming(f"{document.at(key)}, {name}"):
        return Camera(CAMERA_MODELS[lens], image, params)


def _read_lens(files: _Files, implied: str) -> str:
    for document, key in files.holders(("fisheye_model",)):
        if document.array(key, "0 or 1", (1,))[0] != 0:
            return "fisheye"
    for document, key in files.holders(MODEL):
        word = document.word(key).lower()
        if word not in LENSES:
            raise InvalidInput(f"{document.at(key)} is {shown(word)}; expected pinhole, fisheye or omnidir")
        return LENSES[word]
    return implied


def _read_size(files: _Files, owner: _Document, given: tuple[int, int] | None) -> tuple[int, int]:
    """The image size in the camera's own file, or else in any; `given` where no file has one."""
    for document in (owner, *files.documents):
        keys = next(([key] for key in SIZE if key in document), ["image_width", "image_height"])
        if keys[0] not in document:
            continue
        sides = [document.array(key, "whole pixels", (3 - len(keys),)) for key in keys]
        with blaming(document.at(" and ".join(keys))):
            stated = checked_size(np.concatenate(sides).tolist())
        if given is not None and checked_size(given) != stated:
            raise InvalidInput(
                f"{document.at(keys[0])}: size is {stated}; expected {given} as given beside the file"
            )
        return stated
    if given is None:
        raise InvalidInput(
            f"{files}: image_width is missing; expected it and image_height, or `size=` beside the file"
        )
    return checked_size(given)


def _numbers(node: Any) -> Any:
    """A matrix, list or number as OpenCV has parsed it; raises ValueError for what a rig cannot hold."""
    if node.isInt() or node.isReal():
        return node.real()
    if node.isSeq() and node.size() <= MAX_NUMBERS:
        return [_numbers(node.at(index)) for index in range(node.size())]
    if not node.isMap():
        raise ValueError
    sizes = np.ravel([_numbers(node.getNode(key)) for key in _matrix_sides(node)])
    if not (all(side > 0 for side in sizes) and math.prod(sizes.tolist()) <= MAX_NUMBERS):
        raise ValueError
    return node.mat()


def _matrix_sides(node: Any) -> tuple[str, ...]:
    """The keys of a matrix's sides: OpenCV 5 writes a vector with `sizes`, all else has rows and columns."""
    return ("rows", "cols") if node.getNode("sizes").empty() else ("sizes",)


def _parser_reason(message: str) -> str:
    """Line and reason out of OpenCV's `... in function 'where(line): reason'`."""
    found = re.search(r"\((\d+)\): ([^']+)'\s*$", message)
    return f" at line {found[1]} ({one_line(found[2])})" if found else ""
