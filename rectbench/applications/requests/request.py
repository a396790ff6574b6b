"""Requests: fields with descriptions, limits and defaults; how each is written on the command line; and the
fields that several verbs share: the rig, the method, a folder, a seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo

from rectbench.applications.requests.words import options_in, size_in
from rectbench.errors import InvalidInput, RectbenchError
from rectbench.margin import MARGIN_DEG, checked_margin
from rectbench.plugins.defaults import DEFAULT_METHOD


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


Seed = Annotated[int, number(Integral, "a whole number from 0 on", lambda n: n >= 0, "seed")]
Positive = Annotated[float, number(Real, "a number above 0", lambda x: 0 < x < float("inf"))]
ImageWidth = Annotated[int, number(Integral, "a width in pixels", lambda n: n >= 1)]
Margin = Annotated[float, BeforeValidator(checked_margin)]
Text = Annotated[str, BeforeValidator(str)]
"""A name or a path."""

OUT = ("--out", "-o")
METHOD = ("--method", "-m")
METHOD_SEED = "Of the method's random choices."
CALIBRATION = "The rig's calibration file or folder, or a rig's name; repeatable where files are several."


class RigRequest(Request):
    """Whose calibration: the same words in every verb that takes one."""

    rig: Any = word(CALIBRATION, default=..., metavar="CALIB", takes_rest=True)
    """A `Rig`, or what `load_rig` takes."""
    max_angle_deg: float | None = word("The image circle: the lenses show nothing beyond this angle.")
    unit: str | None = word("What the calibration's translations are in, if not metres: mm, cm, in or ft.")
    cameras: Any = word(
        "Two cameras of a calibration that holds more, by its names.", metavar="LEFT,RIGHT", has_commas=True
    )


class SizedRigRequest(RigRequest):
    """A rig without images that would tell their size."""

    size: tuple[int, int] | None = word(
        "The images' size, where the calibration does not tell.", metavar="WxH", parse=size_in
    )


class MarginRequest(Request):
    """What of the view is trimmed, before any method sees it."""

    margin_deg: Margin = word(
        "Nearer to the epipoles than this, where rows meet, the view is trimmed.",
        default=MARGIN_DEG,
        metavar="DEGREES",
    )


class OptionsRequest(MarginRequest):
    """How a method is set."""

    options: dict[str, Any] = word(
        "An option of the method; repeatable.", "--option", default={}, metavar="NAME=VALUE", parse=options_in
    )


class MethodRequest(OptionsRequest):
    """Which method, and how it is set."""

    method: Text = word("A method's name, or a file.", *METHOD, default=DEFAULT_METHOD)


class SeededMethodRequest(MethodRequest):
    """The same where one seed is enough."""

    seed: Seed = word(METHOD_SEED, default=0)
