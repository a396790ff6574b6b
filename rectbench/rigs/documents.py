"""Calibration files as text and plain data; every fault is one line with file, key and expectation."""

from __future__ import annotations

import math
import os
import re
import reprlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from rectbench.cameras.arrays import FloatArray
from rectbench.errors import InvalidInput, UnknownName

MAX_BYTES = 1 << 22
"""Calibrations take kilobytes, some with every image point a few hundred; what is larger is another file."""

MAX_YAML_CHARACTERS = 1 << 17
"""A rig or camchain takes a few thousand; PyYAML is slow enough for a megabyte to look like a hang."""

MAX_PIXELS = 1 << 16
"""Longest side of an image that a calibration may state."""


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a calibration file; raises InvalidInput where there is none to be had."""
    try:
        with Path(path).open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise InvalidInput(
            f"{path}: cannot be read ({error.strerror}); expected a calibration file"
        ) from None
    except ValueError as error:  # a NUL in the path
        raise InvalidInput(f"{str(path)!r}: cannot be read ({error}); expected a path") from None
    if len(content) > MAX_BYTES:
        raise InvalidInput(f"{path}: is larger than {MAX_BYTES >> 20} MiB; expected a calibration file")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{path}: is not text (byte {error.start}); expected a calibration file") from None
    if "\0" in text:
        raise InvalidInput(f"{path}: is binary (byte {text.index(chr(0))}); expected a calibration file")
    if not text.strip():
        raise InvalidInput(f"{path}: is empty; expected a calibration file")
    return text


def parse_yaml(text: str, file: str) -> Section:
    """The top mapping of a YAML document, OpenCV's `%YAML:1.0` header allowed.

    Only strings, lists and mappings come out of it: no tag constructs an object, and aliases, of
    which a small file can unfold into a huge one, are refused.
    """
    if len(text) > MAX_YAML_CHARACTERS:
        raise InvalidInput(
            f"{file}: is larger than {MAX_YAML_CHARACTERS >> 10} KiB; expected two cameras and a pose"
        )
    text = re.sub(r"\A%YAML:1\.0[^\n]*\n(---[^\n]*\n)?", "\n", text)
    try:
        content = yaml.load(text, Loader=_PlainLoader)
    except yaml.MarkedYAMLError as error:
        where = f" at line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InvalidInput(
            f"{file}: is no YAML{where} ({one_line(error.problem)}); expected `key: value`"
        ) from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise InvalidInput(f"{file}: is no YAML ({one_line(error)}); expected `key: value`") from None
    except RecursionError:
        raise InvalidInput(f"{file}: is nested too deeply; expected `key: value`") from None
    if not isinstance(content, dict):
        raise InvalidInput(f"{file}: is {shown(content)}; expected `key: value`")
    return Section(file, "", content)


@dataclass(frozen=True)
class Section:
    """A mapping in a calibration file, read by key; whatever is amiss is an InvalidInput."""

    file: str
    key: str
    values: Mapping[str, Any]

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def fault(self, key: str, expected: str) -> InvalidInput:
        """The error of a key that is missing, or that is not what was expected."""
        found = f"is {shown(self.values[key])}" if key in self.values else "is missing"
        return InvalidInput(f"{self.at(key)} {found}; expected {expected}")

    def at(self, key: str) -> str:
        """File and full key, as errors name them."""
        return f"{self.file}: {self.key}{key}"

    def only(self, known: Iterable[str]) -> None:
        """Raise for a key that is none of those known, which would else be passed over in silence."""
        choices = list(known)
        for key in self.values:
            if key not in choices:
                raise InvalidInput(f"{self.at('')}{UnknownName('key', one_line(key), choices)}")

    def section(self, key: str, expected: str) -> Section:
        """The mapping under `key`."""
        value = self.values.get(key)
        if not isinstance(value, dict):
            raise self.fault(key, expected)
        return Section(self.file, f"{self.key}{key}.", value)

    def text(self, key: str, expected: str) -> str:
        """The string under `key`."""
        value = self.values.get(key)
        if not isinstance(value, str) or not value:
            raise self.fault(key, expected)
        return value

    def number(self, key: str, expected: str) -> float:
        """The finite number under `key`."""
        number = finite_number(self.values.get(key))
        if number is None:
            raise self.fault(key, expected)
        return number

    def numbers(self, key: str, expected: str, count: int | None = None) -> list[float]:
        """The finite numbers under `key`, `count` of them where given."""
        values = self.values.get(key)
        if not isinstance(values, list) or count not in (None, len(values)):
            raise self.fault(key, expected)
        numbers = [number for value in values if (number := finite_number(value)) is not None]
        if len(numbers) < len(values):
            raise self.fault(key, expected)
        return numbers

    def matrix(self, key: str, expected: str, rows: int, columns: int) -> FloatArray:
        """The matrix [rows, columns] under `key`, a list of its rows."""
        values = self.values.get(key)
        if not isinstance(values, list) or len(values) != rows:
            raise self.fault(key, expected)
        parts = Section(self.file, f"{self.key}{key}.", {str(row): value for row, value in enumerate(values)})
        row_expected = f"{columns} finite numbers, a row of {expected}"
        return np.array([parts.numbers(str(row), row_expected, columns) for row in range(rows)])

    def size(self, key: str, given: tuple[int, int] | None) -> tuple[int, int]:
        """The image's (width, height) under `key`; `given` stands in where the file has none."""
        expected = "[width, height] in whole pixels"
        if key not in self.values and given is None:
            raise InvalidInput(
                f"{self.at(key)} is missing; expected {expected}, or `size=` given beside the file"
            )
        if key not in self.values:
            return checked_size(given)
        try:
            stated = checked_size(self.numbers(key, expected, 2))
        except InvalidInput:
            raise self.fault(key, expected) from None
        if given is not None and checked_size(given) != stated:
            raise self.fault(key, f"the size {given[0]}x{given[1]} given beside the file")
        return stated


def checked_size(size: Any) -> tuple[int, int]:
    """`size` as (width, height); raises InvalidInput for anything but two whole numbers of pixels."""
    try:
        width, height = (float(side) for side in size)
    except (TypeError, ValueError):
        width = height = math.nan
    if not all(1 <= side <= MAX_PIXELS and side == int(side) for side in (width, height)):
        raise InvalidInput(f"size is {shown(size)}; expected (width, height) in whole pixels")
    return int(width), int(height)


def finite_number(value: Any) -> float | None:
    """`value` as a float, or None where it is no finite number."""
    if not isinstance(value, str | int | float):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


@contextmanager
def blaming(where: str) -> Iterator[None]:
    """Errors of what is built from a file's numbers, with file and key put before them.

    Numbers so absurd that they overflow end in an error of their own, without a warning beside it.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except (ValueError, ArithmeticError) as error:
        raise InvalidInput(f"{where}: {one_line(error)}") from None


def shown(value: Any) -> str:
    """A value as an error shows it: one line, cut short."""
    return one_line(_SHORT.repr(value))


def one_line(message: Any) -> str:
    """A message with its line breaks, and whatever else does not print, made spaces."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(message)).split())


_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 40
_SHORT.maxdict = 2

_PLAIN_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "seq", "map", "int", "float", "null")}


class _PlainLoader(yaml.BaseLoader):
    """Strings, lists and mappings; no tags, no aliases, no key twice."""

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            raise yaml.MarkedYAMLError(problem="an alias", problem_mark=self.peek_event().start_mark)  # type: ignore[no-untyped-call]
        node = super().compose_node(parent, index)
        if node is not None and node.tag not in _PLAIN_TAGS:
            raise yaml.MarkedYAMLError(problem=f"the tag {node.tag}", problem_mark=node.start_mark)
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = Counter(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        for key, count in keys.items():
            if count > 1:
                raise yaml.MarkedYAMLError(problem=f"the key {key} twice", problem_mark=node.start_mark)
        return super().construct_mapping(node, deep)
