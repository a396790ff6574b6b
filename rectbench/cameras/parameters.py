"""Checks the parameters of a camera against what its projection model expects."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rectbench.cameras.lens import Interval, Lens
from rectbench.errors import InvalidInput, UnknownName

Parameter = float | tuple[float, ...]


def checked_parameters(lens: Lens, given: Any) -> dict[str, Parameter]:
    """All parameters of the model by name, what is left out at its default.

    Raises UnknownName for a parameter the model does not have, InvalidInput for a value that is
    not finite, not of the right shape or not in the parameter's range.
    """
    if not isinstance(given, Mapping):
        raise InvalidInput(f"{lens.name} has params {given!r}; expected a mapping of names to numbers")
    for name in given:
        if name not in lens.parameters:
            raise UnknownName(f"parameter of {lens.name}", str(name), lens.parameters)
    return {
        name: _checked(lens, name, given[name]) if name in given else _default(lens, name)
        for name in lens.parameters
    }


def _default(lens: Lens, name: str) -> Parameter:
    if name in lens.vectors:
        return ()
    value = lens.defaults.get(name, 0.0)
    if value not in lens.ranges.get(name, Interval()):
        raise InvalidInput(f"{lens.name} lacks {name}; expected a number in {lens.ranges[name]}")
    return value


def _checked(lens: Lens, name: str, value: Any) -> Parameter:
    expected = "a list of finite numbers" if name in lens.vectors else "a finite number"
    try:
        numbers = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{lens.name} has {name} = {value!r}; expected {expected}") from None
    if numbers.ndim != (name in lens.vectors) or not np.isfinite(numbers).all():
        raise InvalidInput(f"{lens.name} has {name} = {value!r}; expected {expected}")
    if name in lens.vectors:
        return tuple(numbers.tolist())
    number = float(numbers)
    if number not in lens.ranges.get(name, Interval()):
        raise InvalidInput(f"{lens.name} has {name} = {number:g}; expected a number in {lens.ranges[name]}")
    return number
