"""The records in COLMAP's `cameras`, `images` and `rigs` files, text (`.txt`) or binary (`.bin`).

The layouts are those of COLMAP's page "Output Format". Files of any size are read as a stream: the
key points of an image, which are most of it, are passed over. Numbers in binary files are little-endian.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from rectbench.calibrations.documents import finite_number, shown
from rectbench.errors import InvalidInput

MAX_RECORDS = 25_000
"""Cameras, images or rigs of a model that are looked at; scenes have up to some ten thousand images."""

MAX_LINE = 1 << 16
"""Bytes of a line that is read; the longest belong to rigs of many sensors."""

MAX_NAME = 4096
MAX_SENSORS = 1000
BYTES_PER_POINT = 24
"""x, y and the number of the 3-D point."""

SENSORS = {"CAMERA": 0, "IMU": 1}

Pose = tuple[float, ...]
"""Quaternion w, x, y, z and translation x, y, z, from the world, or the rig, to the camera; as the file
has them, finite or not."""


@dataclass(frozen=True)
class CameraRecord:
    """`where` names file and record in errors; `model` is a name, or a number that stands for one."""

    where: str
    model: str
    size: tuple[float, float]
    params: tuple[float, ...]


@dataclass(frozen=True)
class ImageRecord:
    """An image, the number of its camera, and the pose from the world to that."""

    where: str
    name: str
    camera: int
    pose: Pose


@dataclass(frozen=True)
class SensorRecord:
    """A camera of a rig; `pose` is from the rig to it, None where it is unknown."""

    where: str
    camera: int
    pose: Pose | None


IDENTITY: Pose = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
CAMERA_FIELDS = "a camera's number, its model, width, height and parameters"
IMAGE_FIELDS = "an image's number, qw qx qy qz tx ty tz, its camera's number and its name"
RIG_FIELDS = "a rig's number, its count of sensors, and each sensor's kind, number and pose"


def read_cameras(
    path: Path, wanted: Collection[int], models: Mapping[int, tuple[str, int]]
) -> dict[int, CameraRecord]:
    """The wanted cameras of the file by their number, as far as they are there.

    `models` gives name and count of parameters of the models that binary files call by a number.
    """
    cameras: dict[int, CameraRecord] = {}
    records = _binary_cameras(path, wanted, models) if _is_binary(path) else _text_cameras(path, wanted)
    for number, camera in records:
        if number in cameras:
            raise InvalidInput(f"{camera.where}: is there twice; expected cameras of different numbers")
        cameras[number] = camera
    return cameras


def read_images(path: Path) -> Iterator[ImageRecord]:
    """The images in the file, one by one in its order."""
    return _binary_images(path) if _is_binary(path) else _text_images(path)


def read_rigs(path: Path) -> Iterator[list[SensorRecord]]:
    """The cameras of each rig in the file, the reference first; other sensors are left out."""
    return _binary_rigs(path) if _is_binary(path) else _text_rigs(path)


def _is_binary(path: Path) -> bool:
    return path.suffix.lower() == ".bin"


@contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    try:
        if not path.is_file():  # a pipe would be waited for
            raise FileNotFoundError(2, os.strerror(2))
        with path.open("rb") as stream:
            yield stream
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read ({error.strerror}); expected a COLMAP file") from None


# Text


class _Lines:
    """The lines of a text file that hold something, none of them longer than `MAX_LINE`."""

    stream: BinaryIO

    def __init__(self, path: Path) -> None:
        self.path, self.number = path, 0

    @property
    def where(self) -> str:
        return f"{self.path}: line {self.number}"

    def __iter__(self) -> Iterator[str]:
        with _opened(self.path) as self.stream:
            yield from self._filled()

    def _filled(self) -> Iterator[str]:
        while line := self.stream.readline(MAX_LINE):
            self.number += 1
            if self.number > 2 * MAX_RECORDS:
                raise InvalidInput(f"{self.path}: has over {2 * MAX_RECORDS} lines; expected a COLMAP model")
            text = line.decode("utf-8-sig", errors="replace").strip()
            whole = line.endswith(b"\n") or len(line) < MAX_LINE
            if text.startswith("#") and not whole:
                self._skip_rest()
            if not text or text.startswith("#"):
                continue
            if not whole or "\0" in text:
                raise InvalidInput(f"{self.where}: is no text of COLMAP's; expected words and numbers")
            yield text

    def skip_points(self) -> None:
        """Pass over the line of an image's key points, which may be empty."""
        line = self.stream.readline(MAX_LINE)
        self.number += 1
        # Without this, every second image of a file that lacks the lines of points would be lost.
        if len(line) < MAX_LINE and _is_image(line.decode("utf-8", errors="replace").split()):
            raise InvalidInput(f"{self.where}: is an image; expected the line of the last one's points")
        if line and not line.endswith(b"\n"):
            self._skip_rest()

    def _skip_rest(self) -> None:
        while (chunk := self.stream.readline(1 << 20)) and not chunk.endswith(b"\n"):
            pass


def _text_cameras(path: Path, wanted: Collection[int]) -> Iterator[tuple[int, CameraRecord]]:
    lines = _Lines(path)
    for text in lines:
        words = text.split()
        if len(words) < 5 or not re.fullmatch(r"[A-Z][A-Z0-9_]*", words[1]):
            raise InvalidInput(f"{lines.where}: is {shown(text)}; expected {CAMERA_FIELDS}")
        number = _whole(words[0], lines.where, CAMERA_FIELDS)
        if number in wanted:
            width, height, *params = _numbers(words[2:], lines.where, CAMERA_FIELDS)
            where = f"{lines.where}: camera {number}"
            yield number, CameraRecord(where, words[1], (width, height), tuple(params))


def _text_images(path: Path) -> Iterator[ImageRecord]:
    lines = _Lines(path)
    for text in lines:
        words = text.split(maxsplit=9)
        if len(words) < 10:
            raise InvalidInput(f"{lines.where}: is {shown(text)}; expected {IMAGE_FIELDS}")
        pose = _numbers(words[1:8], lines.where, IMAGE_FIELDS)
        camera = _whole(words[8], lines.where, IMAGE_FIELDS)
        yield ImageRecord(lines.where, words[9], camera, pose)
        lines.skip_points()


def _is_image(words: list[str]) -> bool:
    return (
        len(words) == 10
        and all(finite_number(word) is not None for word in words[:9])
        and finite_number(words[9]) is None
    )


def _text_rigs(path: Path) -> Iterator[list[SensorRecord]]:
    lines = _Lines(path)
    for text in lines:
        _, count, *words = [*text.split(), "", ""]
        sensors = _text_sensors(words[:-2], lines.where)
        if len(sensors) != _whole(count, lines.where, RIG_FIELDS):
            raise InvalidInput(f"{lines.where}: has {len(sensors)} sensors; expected {count}")
        yield [sensor for kind, sensor in sensors if kind == "CAMERA"]


def _text_sensors(words: list[str], where: str) -> list[tuple[str, SensorRecord]]:
    """Kind and record of each sensor; the first, the reference, has no word on its pose."""
    sensors: list[tuple[str, SensorRecord]] = []
    while words:
        kind, number, has_pose = [*words, "", ""][:3]
        if kind not in SENSORS:
            raise InvalidInput(f"{where}: {shown(kind)} is no sensor; expected {' or '.join(SENSORS)}")
        pose: Pose | None = IDENTITY
        end = 2
        if sensors:
            posed = _whole(has_pose, where, RIG_FIELDS)
            end = 10 if posed else 3
            pose = _numbers(words[3:end], where, RIG_FIELDS) if posed else None
        if len(words) < end:
            raise InvalidInput(f"{where}: ends amid a sensor; expected {RIG_FIELDS}")
        sensors.append((kind, SensorRecord(where, _whole(number, where, RIG_FIELDS), pose)))
        words = words[end:]
    return sensors


def _whole(word: str, where: str, expected: str) -> int:
    if not re.fullmatch(r"\d{1,18}", word, re.ASCII):
        raise InvalidInput(f"{where}: {shown(word)} is no whole number; expected {expected}")
    return int(word)


def _numbers(words: list[str], where: str, expected: str) -> tuple[float, ...]:
    for word in words:
        if finite_number(word) is None:
            raise InvalidInput(f"{where}: {shown(word)} is no finite number; expected {expected}")
    return tuple(map(float, words))


# Binary


class _Binary:
    """Reads numbers off a stream; what the file does not hold is never allocated."""

    stream: BinaryIO
    size: int

    def __init__(self, path: Path) -> None:
        self.path = path

    def take(self, layout: str) -> tuple[float, ...]:
        """The numbers of a `struct` layout."""
        length = struct.calcsize("<" + layout)
        content = self.stream.read(length)
        if len(content) < length:
            raise self._cut_short()
        return struct.unpack("<" + layout, content)

    def count(self) -> int:
        """How many records there are; of an absurd number the first ones are read before the file ends."""
        return int(self.take("Q")[0])

    def name(self, where: str) -> str:
        """A string that ends with a NUL."""
        start = self.stream.tell()
        head, end, _ = self.stream.read(MAX_NAME).partition(b"\0")
        if not end:
            raise (
                self._cut_short()
                if self.stream.tell() == self.size
                else InvalidInput(f"{where}: has a name of over {MAX_NAME} bytes; expected an image's path")
            )
        self.stream.seek(start + len(head) + 1)
        return head.decode("utf-8", errors="replace")

    def skip(self, length: int) -> None:
        """Pass over so many bytes, which must be there."""
        if length > self.size - self.stream.tell():
            raise self._cut_short()
        self.stream.seek(length, os.SEEK_CUR)

    def records(self) -> Iterator[int]:
        """As many steps as the file says it has records, up to `MAX_RECORDS`."""
        with _opened(self.path) as self.stream:
            self.size = os.fstat(self.stream.fileno()).st_size
            count = self.count()
            yield from range(min(count, MAX_RECORDS))
            if count > MAX_RECORDS:
                raise InvalidInput(f"{self.path}: holds {count} records; expected at most {MAX_RECORDS}")

    def _cut_short(self) -> InvalidInput:
        return InvalidInput(
            f"{self.path}: is cut short after {self.size} bytes; expected as many records as it says"
        )


def _binary_cameras(
    path: Path, wanted: Collection[int], models: Mapping[int, tuple[str, int]]
) -> Iterator[tuple[int, CameraRecord]]:
    file = _Binary(path)
    for _ in file.records():
        number, model, width, height = (int(n) for n in file.take("IiQQ"))
        where = f"{path}: camera {number}"
        if model not in models:
            raise InvalidInput(f"{where}: has the model {model}; expected 0 to {len(models) - 1}")
        name, count = models[model]
        params = file.take(f"{count}d")
        if number in wanted:
            yield number, CameraRecord(where, name, (width, height), params)


def _binary_images(path: Path) -> Iterator[ImageRecord]:
    file = _Binary(path)
    for _ in file.records():
        number, *pose, camera = file.take("I7dI")
        where = f"{path}: image {number}"
        yield ImageRecord(where, file.name(where), int(camera), tuple(pose))
        file.skip(file.count() * BYTES_PER_POINT)


def _binary_rigs(path: Path) -> Iterator[list[SensorRecord]]:
    file = _Binary(path)
    for _ in file.records():
        number, count = file.take("II")
        where = f"{path}: rig {number}"
        if count > MAX_SENSORS:
            raise InvalidInput(f"{where}: has {count} sensors; expected at most {MAX_SENSORS}")
        cameras = []
        for place in range(int(count)):
            kind, sensor = file.take("iI")
            posed = place == 0 or file.take("B")[0]
            pose = IDENTITY if place == 0 else file.take("7d") if posed else None
            if kind == SENSORS["CAMERA"]:
                cameras.append(SensorRecord(where, int(sensor), pose))
        yield cameras
