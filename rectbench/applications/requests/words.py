"""Words of a command line, or a text in Python, as the values that they mean."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from pydantic import ValidationInfo

from rectbench.applications.requests.request import listed
from rectbench.errors import InvalidInput

OptionSets = dict[str, dict[str, Any]]
"""Options by method and name."""


def whole_numbers_in(words: Any, info: ValidationInfo) -> Any:
    """Words as whole numbers; numbers stay what they are, and whoever counts with them checks them."""
    values = listed(words, info)
    if not any(isinstance(value, str) for value in values or ()):
        return values
    try:
        return [int(word) for word in values]
    except ValueError:
        given = f"{info.field_name} are {_joined(values)}"
        raise InvalidInput(f"{given}; expected whole numbers such as 0,1,2") from None


def distances_in(words: Any) -> Any:
    """Words as distances in metres."""
    numbers = None if words is None else _numbers_in(words)
    if numbers is None and words is not None:
        raise InvalidInput(f"--depth-m is {_joined(words)}; expected distances in metres such as 1,10,inf")
    return numbers


def tables_in(words: Any) -> Any:
    """Kinds of tables; of the word none none."""
    return () if list(words) == ["none"] else tuple(words)


def angles_in(text: Any) -> Any:
    """Two angles with an x between them, such as 100x80; what is no text stays."""
    return _two_numbers(text, "fov", "two angles such as 100x80") if isinstance(text, str) else text


def size_in(text: Any) -> Any:
    """(width, height) in whole pixels of a text such as 1280x800; what is no text stays."""
    if not isinstance(text, str):
        return text
    sides = _two_numbers(text, "size", "width and height such as 1280x800")
    if any(side != round(side) for side in sides):
        raise InvalidInput(f"size is {text}; expected whole pixels")
    return round(sides[0]), round(sides[1])


def crop_in(text: Any) -> Any:
    """The word valid, or the four numbers of a text such as 10,20,640,480; what is no text stays."""
    if not isinstance(text, str) or text == "valid":
        return text
    numbers = _numbers_in(text.split(","))
    if numbers is None or len(numbers) != 4:
        raise InvalidInput(f"crop is {text}; expected valid, or x,y,width,height in pixels")
    return tuple(numbers)


def focal_in(text: Any) -> float | Literal["source"] | Any:
    """The word source, or the number of a text; what is no text stays."""
    if not isinstance(text, str) or text == "source":
        return text
    numbers = _numbers_in([text])
    if numbers is None:
        raise InvalidInput(f"focal is {text}; expected a number of pixels, or source")
    return numbers[0]


def option_sets_in(words: Mapping[str, Mapping[str, Any]] | Sequence[str] | None) -> Any:
    """Options by method of words `method.name=value`; a value is TOML, or a word as it stands."""
    if words is None or isinstance(words, Mapping):
        return words or {}
    options: OptionSets = {}
    for word in words:
        place, equals, value = word.partition("=")
        method, dot, name = place.strip().rpartition(".")
        if not (equals and dot and method and name):
            raise InvalidInput(f"option is {word!r}; expected method.name=value")
        options.setdefault(method, {})[name.replace("-", "_")] = _value_in(value.strip())
    return options


def options_in(words: Mapping[str, Any] | Sequence[str] | None) -> Any:
    """Options of one method of words `name=value`."""
    if words is None or isinstance(words, Mapping):
        return words or {}
    return option_sets_in([f"method.{word}" for word in words]).get("method", {})


def _value_in(text: str) -> Any:
    """A value as TOML reads it; a word that TOML does not know is itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _two_numbers(text: str, name: str, expected: str) -> tuple[float, float]:
    numbers = _numbers_in(text.lower().replace("×", "x").split("x"))
    if numbers is None or len(numbers) != 2:
        raise InvalidInput(f"{name} is {text}; expected {expected}")
    return numbers[0], numbers[1]


def _numbers_in(words: Sequence[Any]) -> list[float] | None:
    """The words as numbers; None where one is none."""
    try:
        return [float(word) for word in words]
    except ValueError:
        return None


def _joined(words: Sequence[Any]) -> str:
    return ",".join(map(str, words))
