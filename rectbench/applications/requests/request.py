"""A request: fields with descriptions, limits and defaults; and how each is written on the command line."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from numbers import Integral
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, ValidationInfo

from rectbench.errors import InvalidInput, RectbenchError


@dataclass(frozen=True)
class Word:
    """How the command line spells a field."""

    names: tuple[str, ...] = ()
    """Of an option; as the field is called where left out."""
    metavar: str | None = None
    is_positional: bool = False
    has_commas: bool = False
    """Whether one word may hold several values, separated by commas."""
    takes_rest: bool = False
    """Whether it may be repeated, and words that are left at the end belong to it as well."""


def positional(metavar: str) -> Word:
    """The spelling of a field that is known by its place."""
    return Word(metavar=metavar, is_positional=True)


class Request(BaseModel):
    """Base of what verbs take: checked, immutable; refuses in one line.

    Raises InvalidInput for a value that cannot be used, or a RectbenchError that a field's own check raises.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=False)

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


def number(kind: type, expected: str, holds: Callable[[Any], bool]) -> BeforeValidator:
    """A check of a number of this abstract kind, NumPy's too, for which `holds` is true; bool is none."""
    plain: Any = int if kind is Integral else float

    def check(value: Any, info: ValidationInfo) -> Any:
        if value is None:
            return None
        if isinstance(value, bool) or not isinstance(value, kind) or not holds(value):
            raise InvalidInput(f"{info.field_name} is {value!r}; expected {expected}")
        return plain(value)

    return BeforeValidator(check)


def _listed(values: Any, info: ValidationInfo) -> Any:
    if isinstance(values, str) or (values is not None and not isinstance(values, Iterable)):
        raise InvalidInput(f"{info.field_name} is {values!r}; expected a list")
    return None if values is None else list(values)


LISTED = BeforeValidator(_listed)
"""A check that several values are several, in one line."""
