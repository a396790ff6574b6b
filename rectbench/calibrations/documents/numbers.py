"""The numbers of a file: finite ones, lists and matrices of them, and an image's size."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from rectbench.calibrations.documents.faults import errors_at, shown
from rectbench.errors import InvalidInput

MAX_NUMBERS = 256
"""Numbers of one list; no matrix of a rig has more."""

MAX_PIXELS = 1 << 16
"""Longest side of an image that a calibration may state."""


def checked_size(size: Any) -> tuple[int, int]:
    """`size` as (width, height); raises InvalidInput for anything but two whole numbers of pixels."""
    try:
        width, height = (float(side) for side in size)
    except (TypeError, ValueError):
        width = height = math.nan
    if not all(1 <= side <= MAX_PIXELS and side == int(side) for side in (width, height)):
        raise InvalidInput(f"size is {shown(size)}; expected (width, height) in whole pixels")
    return int(width), int(height)


def agreed_size(where: str, size: Any, given: tuple[int, int] | None) -> tuple[int, int]:
    """`size` as (width, height), which is the one given beside the file if there is one."""
    with errors_at(where):
        stated = checked_size(size)
    if given not in (None, stated):
        raise InvalidInput(f"{where}: size is {stated}; expected {given} as given beside the file")
    return stated


def finite_number(value: Any) -> float | None:
    """`value` as a float, or None where it is no finite number."""
    if not isinstance(value, str | int | float) or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def flat_numbers(value: Any) -> list[float] | None:
    """The numbers of a number, a list, a list of lists or a mapping with rows, cols and data; else None."""
    if isinstance(value, dict):
        return _matrix_numbers(value)
    if not isinstance(value, list):
        number = finite_number(value)
        return None if number is None else [number]
    if len(value) > MAX_NUMBERS:
        return None
    numbers: list[float] = []
    for item in value:
        parts = flat_numbers(item)
        if parts is None:
            return None
        numbers += parts
    return numbers


def _matrix_numbers(matrix: Mapping[str, Any]) -> list[float] | None:
    """OpenCV 5 writes a vector with `sizes`, all else has rows and columns; a list may be a bare string."""
    data = matrix.get("data")
    numbers = flat_numbers(data) if isinstance(data, list | str) else None
    sides = [flat_numbers(matrix[key]) for key in ("sizes", "rows", "cols") if key in matrix]
    if numbers is None or not sides or any(side is None for side in sides):
        return None
    return numbers if math.prod(n for side in sides for n in side or ()) == len(numbers) else None
