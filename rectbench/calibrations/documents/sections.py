"""The mappings of a calibration file, read by key; every fault is one line with file, key and expectation."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from rectbench.calibrations.documents.entries import take
from rectbench.calibrations.documents.faults import errors_at, one_line, shown
from rectbench.calibrations.documents.numbers import agreed_size, checked_size, finite_number, flat_numbers
from rectbench.calibrations.documents.parsing import Malformed, parse
from rectbench.calibrations.documents.telling import tell
from rectbench.errors import InvalidInput, UnknownName, argument
from rectbench.rigs.rig import checked_rotation
from rectbench.types import FloatArray

OPENING = re.compile(r"""[%<{\[-]|["'\w./ -]+:(\s|$)""")
"""How the first line of YAML, JSON or XML begins that is no comment."""

EXPECTED = "expected one of those that `rectbench list formats` names"


def parse_document(text: str, file: str) -> Section:
    """The top mapping of a YAML, JSON or XML text; raises InvalidInput where there is none."""
    try:
        content = parse(text)
    except Malformed as error:
        opening = next((line for line in map(str.strip, text.splitlines()) if line and line[0] != "#"), "")
        if not OPENING.match(opening):
            raise InvalidInput(f"{file}: is no calibration but text, {shown(opening)}; {EXPECTED}") from None
        raise InvalidInput(f"{file}: {one_line(error)}; expected `key: value`") from None
    if not isinstance(content, dict):
        raise InvalidInput(f"{file}: is no calibration known here but {shown(content)}; expected `key: ...`")
    return Section(file, "", content)


@dataclass(frozen=True)
class Section:
    """A mapping in a calibration file, read by key; whatever is amiss is an InvalidInput.

    A key counts as read once a reader asks for it; what looks like part of a lens or a pose and was not read
    is told when the reader is done (`rectbench.calibrations.checks.unread`).
    """

    file: str
    key: str
    values: Mapping[str, Any]

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def fault(self, key: str, expected: str) -> InvalidInput:
        """The error of a key that is missing, or that is not what was expected."""
        found = f"is {shown(_numbers_of(self.values[key]))}" if key in self.values else "is missing"
        return InvalidInput(f"{self.at(key)} {found}; expected {expected}")

    @property
    def where(self) -> str:
        """File and key of the mapping itself, as errors name them."""
        return self.at("").removesuffix(".").removesuffix(": ")

    def at(self, key: str) -> str:
        """File and full key, as errors name them."""
        return f"{self.file}: {one_line(f'{self.key}{key}')}"

    def only(self, known: Iterable[str]) -> None:
        """Raise for a key that is none of those known, which would else be passed over in silence."""
        choices = list(known)
        for key in self.values:
            if key not in choices:
                raise InvalidInput(f"{self.at('')}{UnknownName('key', one_line(key), choices)}")

    def knows(self, *patterns: str) -> None:
        """Count the keys by these patterns as read: the reader knows that they tell nothing that it wants."""
        for key in self.values:
            if any(fnmatchcase(key, pattern) for pattern in patterns):
                take(self.values[key])

    def section(self, key: str, expected: str) -> Section:
        """The mapping under `key`."""
        value = self.values.get(key)
        if not isinstance(value, dict):
            raise self.fault(key, expected)
        return Section(self.file, f"{self.key}{key}.", value)

    def section_of_list(self, key: str) -> Section:
        """The list under `key` with its places as keys "0", "1", ...; empty where there is none."""
        value = self.values.get(key)
        items = value if isinstance(value, list) else []
        return Section(self.file, f"{self.key}{key}.", {str(place): item for place, item in enumerate(items)})

    def item(self, key: str, place: int, expected: str) -> Section:
        """The mapping at `place` of the list under `key`."""
        if not isinstance(self.values.get(key), list):
            raise self.fault(key, f"a list with {expected}")
        return self.section_of_list(key).section(str(place), expected)

    def text(self, key: str, expected: str) -> str:
        """The string under `key`."""
        value = self.values.get(key)
        if not isinstance(value, str) or not value:
            raise self.fault(key, expected)
        return value

    def choice(self, key: str, known: Collection[str], default: str | None = None) -> str:
        """The word under `key`, one of those known; where it is missing, `default`, if any, which is told."""
        if default is not None and key not in self:
            tell(f"{self.at(key)} is missing; taken to be {default}")
            return default
        word = self.text(key, ", ".join(known))
        if word not in known:
            raise self.fault(key, ", ".join(known))
        return word

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

    def named(self, key: str, names: Collection[str]) -> dict[str, float]:
        """The finite numbers under `key` by these names, one each."""
        expected = f"{len(names)} finite numbers ({' '.join(names)})"
        return dict(zip(names, self.numbers(key, expected, len(names)), strict=True))

    def array(self, key: str, expected: str, sizes: Collection[int]) -> FloatArray:
        """The finite numbers under `key`, flat: a number, a list, a list of rows, or rows, cols and data."""
        numbers = flat_numbers(self.values.get(key))
        if numbers is None or len(numbers) not in sizes:
            raise self.fault(key, expected)
        return np.array(numbers)

    def matrix(self, key: str, expected: str, rows: int, columns: int) -> FloatArray:
        """The matrix [rows, columns] under `key`: a list of its rows, a flat list, or rows, cols and data."""
        value = self.values.get(key)
        if isinstance(value, list) and any(isinstance(row, list) for row in value):
            return self._rows(key, value, expected, rows, columns)
        return self.array(key, expected, (rows * columns,)).reshape(rows, columns)

    def rows(self, key: str, expected: str) -> FloatArray:
        """The matrix under `key`, a list of its rows, as many and as long as they are."""
        value = self.values.get(key)
        if not isinstance(value, list) or not value or not isinstance(value[0], list):
            raise self.fault(key, expected)
        return self._rows(key, value, expected, len(value), len(value[0]))

    def rotation(self, key: str, expected: str = "a 3x3 rotation") -> FloatArray:
        """The rotation [3, 3] under `key`, given as a `matrix`."""
        R = self.matrix(key, expected, 3, 3)
        with errors_at(self.at(key)):
            return checked_rotation(R, "it")

    def rigid(self, key: str, expected: str) -> FloatArray:
        """The rigid transformation [4, 4] under `key`, given as [R t; 0 0 0 1] or [R t]."""
        value = self.values.get(key)
        flat = flat_numbers(value)
        if flat is not None and len(flat) == 12:
            transform = np.vstack([np.reshape(flat, (3, 4)), [0, 0, 0, 1]])
        else:
            transform = self.matrix(key, f"{expected}, a 4x4 matrix [R t; 0 0 0 1]", 4, 4)
        if not np.array_equal(transform[3], [0, 0, 0, 1]):
            row = shown(transform[3].tolist())
            raise InvalidInput(f"{self.at(key)} has the last row {row}; expected [0, 0, 0, 1]")
        with errors_at(self.at(key)):
            transform[:3, :3] = checked_rotation(transform[:3, :3], "its 3x3 part")
        return transform

    def _rows(self, key: str, value: list[Any], expected: str, rows: int, columns: int) -> FloatArray:
        if len(value) != rows:
            raise self.fault(key, expected)
        parts = Section(self.file, f"{self.key}{key}.", {str(row): line for row, line in enumerate(value)})
        row_expected = f"{columns} finite numbers, a row of {expected}"
        return np.array([parts.numbers(str(row), row_expected, columns) for row in range(rows)])

    def size(self, key: str, given: tuple[int, int] | None) -> tuple[int, int]:
        """The image's (width, height) under `key`; `given` stands in where the file has none."""
        expected = "[width, height] in whole pixels"
        if key not in self:
            return self._size_beside(key, expected, given)
        try:
            stated = checked_size(self.numbers(key, expected, 2))
        except InvalidInput:
            raise self.fault(key, expected) from None
        if given is not None and given != stated:
            raise self.fault(key, f"the size {given[0]}x{given[1]} given beside the file")
        return stated

    def sides(self, width: str, height: str, given: tuple[int, int] | None) -> tuple[int, int]:
        """The image's (width, height) under two keys; `given` stands in where the file has neither."""
        if width not in self and height not in self:
            return self._size_beside(width, f"it and {height}", given)
        sides = [self.number(key, "whole pixels") for key in (width, height)]
        return agreed_size(f"{self.at(width)} and {height}", sides, given)

    def _size_beside(self, key: str, expected: str, given: tuple[int, int] | None) -> tuple[int, int]:
        if given is None:
            raise InvalidInput(
                f"{self.at(key)} is missing; expected {expected}, or `{argument('size')}` beside the file"
            )
        return given


def _numbers_of(value: Any) -> Any:
    """The numbers of a matrix with rows, cols and data; any other value as it is."""
    return value["data"] if isinstance(value, dict) and "data" in value else value
