"""Words of a command line, or a text in Python, as the values that they mean."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from pydantic import ValidationInfo

from rectbench.errors import InvalidInput, argument

OptionSets = dict[str, dict[str, Any]]
"""Options by method and name."""


def of_text(parse: Callable[[str], Any]) -> Callable[[Any], Any]:
    """A function of a text that leaves what is no text as it is."""
    return lambda given: parse(given) if isinstance(given, str) else given


def listed(values: Any, info: ValidationInfo) -> Any:
    """Several values as a list; one that is none is refused."""
    return None if values is None else _several(values, str(info.field_name), "a list")


def whole_numbers_in(words: Any, info: ValidationInfo) -> Any:
    """Words as whole numbers; numbers stay what they are, and whoever counts with them checks them."""
    values = listed(words, info)
    if not any(isinstance(value, str) for value in values or ()):
        return values
    try:
        return [int(word) for word in values]
    except ValueError:
        given = f"{argument(str(info.field_name))} is {','.join(map(str, values))}"
        raise InvalidInput(f"{given}; expected whole numbers such as 0,1,2") from None


def distances_in(words: Any) -> Any:
    """Words as distances in metres."""
    if words is None:
        return None
    expected = "distances in metres such as 1,10,inf"
    several = _several(words, "depth_m", expected)
    return _numbers(several, f"{argument('depth_m')} is {','.join(map(str, several))}; expected {expected}")


def tables_in(words: Any) -> Any:
    """Kinds of tables; of the word none none."""
    kinds = _several(words, "tables", "kinds of tables, or none")
    return () if kinds == ["none"] else tuple(kinds)


@of_text
def angles_in(text: str) -> Any:
    """Two angles with an x between them, such as 100x80."""
    return _numbers(
        _around_x(text), f"{argument('fov_deg')} is {text}; expected two angles such as 100x80", 2
    )


def size_in(text: Any, info: ValidationInfo) -> Any:
    """(width, height) in whole pixels of a text such as 1280x800."""
    if not isinstance(text, str):
        return text
    name = argument(str(info.field_name))
    sides = _numbers(_around_x(text), f"{name} is {text}; expected width and height such as 1280x800", 2)
    if any(side != round(side) for side in sides):
        raise InvalidInput(f"{name} is {text}; expected whole pixels")
    return [round(side) for side in sides]


@of_text
def crop_in(text: str) -> Any:
    """The word valid, or the four numbers of a text such as 10,20,640,480."""
    if text == "valid":
        return text
    return _numbers(
        text.split(","), f"{argument('crop')} is {text}; expected valid, or x,y,width,height in pixels", 4
    )


@of_text
def focal_in(text: str) -> Any:
    """The word source, or the number of a text."""
    if text == "source":
        return text
    return _numbers([text], f"{argument('focal_px')} is {text}; expected a number of pixels, or source")[0]


def share_in(given: Any, info: ValidationInfo) -> float:
    """The share that a percentage such as 2 % means, or a number below 1 such as 0.02."""
    refusal = f"{argument(str(info.field_name))} is {given!r}; expected a percentage above 0 such as 2%"
    text = str(given).strip()
    if isinstance(given, bool):
        raise InvalidInput(refusal)
    (number,) = _numbers([text.removesuffix("%")], refusal, 1)
    share = number / 100 if text.endswith("%") else number
    if not 0 < share < (math.inf if text.endswith("%") else 1):
        raise InvalidInput(refusal)
    return share


def option_sets_in(words: Mapping[str, Mapping[str, Any]] | Sequence[str] | None) -> Any:
    """Options by method of words `method.name=value`; a value is TOML, or a word as it stands."""
    if words is None or isinstance(words, Mapping):
        return words or {}
    options: OptionSets = {}
    for word in _several(words, "options", "texts such as method.name=value"):
        place, equals, value = word.partition("=")
        method, dot, name = place.strip().rpartition(".")
        if not (equals and dot and method and name):
            raise InvalidInput(f"{argument('options')} is {word!r}; expected method.name=value")
        options.setdefault(method, {})[name.replace("-", "_")] = _value_in(value.strip())
    return options


def options_in(words: Mapping[str, Any] | Sequence[str] | None) -> Any:
    """Options of one method of words `name=value`."""
    if words is None or isinstance(words, Mapping):
        return words or {}
    several = _several(words, "options", "texts such as name=value")
    return option_sets_in([f"method.{word}" for word in several]).get("method", {})


def _value_in(text: str) -> Any:
    """A value as TOML reads it; a word that TOML does not know is itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _several(values: Any, name: str, expected: str) -> list[Any]:
    """Several values as a list; InvalidInput, by the argument's name, for a text or what is no list."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise InvalidInput(f"{argument(name)} is {values!r}; expected {expected}")
    return list(values)


def _around_x(text: str) -> list[str]:
    return text.lower().replace("×", "x").split("x")


def _numbers(words: Sequence[Any], refusal: str, count: int | None = None) -> list[float]:
    """The words as numbers, `count` of them; InvalidInput with this refusal where they are not."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        raise InvalidInput(refusal) from None
    if count not in (None, len(numbers)):
        raise InvalidInput(refusal)
    return numbers
