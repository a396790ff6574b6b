"""A request: fields with descriptions, limits and defaults; and how each is written on the command line."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from numbers import Integral
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo

from rectbench.errors import InvalidInput, RectbenchError


@dataclass(frozen=True)
class Word:
    """How the command line spells a field."""

    names: tuple[str, ...] = ()
    """Of an option; as the field is called where left out."""
    metavar: str | None = None
    least: float | None = None
    is_positional: bool = False
    has_commas: bool = False
    """Whether one word may hold several values, separated by commas."""
    takes_rest: bool = False
    """Whether it may be repeated, and words that are left at the end belong to it as well."""


def word(
    text: str, *names: str, default: Any = None, parse: Callable[..., Any] | None = None, **how: Any
) -> Any:
    """A field with what it is, its default, what reads what is given, and what else its `Word` says."""
    word = Word(names, **how)
    field = Field(default, description=text, ge=word.least)
    field.metadata += [word] if parse is None else [word, BeforeValidator(parse)]
    return field


def of_text(parse: Callable[[str], Any]) -> Callable[[Any], Any]:
    """What reads a text by `parse`; what is no text stays."""
    return lambda given: parse(given) if isinstance(given, str) else given


def positional(metavar: str, text: str, default: Any = ...) -> Any:
    """A field that the command line knows by its place."""
    return word(text, default=default, metavar=metavar, is_positional=True)


class Request(BaseModel):
    """Base of what verbs take: checked, immutable; refuses in one line.

    Raises InvalidInput for a value that cannot be used, or a RectbenchError that a field's own check raises.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    def __init__(self, **given: Any) -> None:
        try:
            super().__init__(**given)
        except ValidationError as error:
            raise _refusal(error) from None


def _refusal(error: ValidationError) -> RectbenchError:
    """The first fault in one line: the field, its value, and what was expected."""
    fault = error.errors(include_url=False)[0]
    cause = fault.get("ctx", {}).get("error")
    if isinstance(cause, RectbenchError):
        return cause
    name = str(fault["loc"][0])
    if fault["type"] == "missing":
        return InvalidInput(f"{name} is missing; expected it to be given")
    expected = fault["msg"].removeprefix("Input should be ").removeprefix("Input is not ")
    return InvalidInput(f"{name} is {fault['input']!r}; expected {expected}")


def number(
    kind: type, expected: str, holds: Callable[[Any], bool], name: str | None = None
) -> BeforeValidator:
    """A check of a number of this abstract kind, NumPy's too, for which `holds` is true; bool is none.

    `name` is what an error calls it; else that of its field.
    """
    plain: Any = int if kind is Integral else float

    def check(value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, kind) or not holds(value):
            raise InvalidInput(f"{name or info.field_name} is {value!r}; expected {expected}")
        return plain(value)

    return BeforeValidator(check)


def listed(values: Any, info: ValidationInfo) -> Any:
    """Several values as a list; one that is none is refused."""
    if isinstance(values, str) or (values is not None and not isinstance(values, Iterable)):
        raise InvalidInput(f"{info.field_name} is {values!r}; expected a list")
    return None if values is None else list(values)
