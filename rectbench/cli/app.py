"""The application that the verbs join.

A verb of a rig, or one that Python has, too, is a function of a request, whose fields are its words. The
others are functions as typer reads them. Each gives its exit code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from inspect import Parameter, Signature
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

import typer
import typer.core
from pydantic.fields import FieldInfo

from rectbench.applications.requests.request import Request, Word
from rectbench.errors import InvalidInput, in_python, spelled

GOOD, FAILED, WRONG_USAGE, INCOMPLETE = 0, 1, 2, 3
REST = "rest"
"""The parameter of words that are left at the end."""

app = typer.Typer(
    help="A bench for stereo rectification: render, rectify, measure, report.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # square brackets in help texts are TOML sections
)

R = TypeVar("R", bound=Request)


class Verb(typer.core.TyperCommand):
    """A verb, whose messages name arguments by its own options."""

    def invoke(self, ctx: Any) -> Any:
        """Run it."""
        with spelled(self._spelling):
            return super().invoke(ctx)

    def _spelling(self, name: str, value: object) -> str:
        """The option or place that an argument has here; one that has none is spelled as in Python."""
        params: list[Any] = self.params
        for param in params:
            if param.name == name:
                called = param.opts[0] if param.param_type_name == "option" else param.metavar
                return called if value is None else f"{called} {value}"
        return in_python(name, value)


def verb(request: type[R]) -> Callable[[Callable[[R], int]], Callable[..., int]]:
    """A verb of a function: it is called with the request that the words make, and gives the exit code."""

    def made(does: Callable[[R], int]) -> Callable[..., int]:
        def command(**words: Any) -> int:
            return does(request(**_given(request, words)))

        command.__signature__ = Signature([*_parameters(request)])  # type: ignore[attr-defined]
        command.__name__, command.__doc__ = does.__name__, does.__doc__
        return command

    return made


def parts(texts: Iterable[str]) -> list[str]:
    """What stands between the commas of texts."""
    return [part.strip() for text in texts for part in text.split(",") if part.strip()]


def _parameters(request: type[Request]) -> Iterator[Parameter]:
    """What typer reads: a field is an option, but for those that have a place; words at the end come last."""
    rest = []
    for name, field in request.model_fields.items():
        word = _word(field)
        info: Any = typer.Argument(metavar=word.metavar, help=field.description)
        if not word.is_positional:
            names = word.names or (f"--{name.replace('_', '-')}",)
            info = typer.Option(*names, metavar=word.metavar, min=word.least, help=field.description)
        yield _parameter(name, _word_type(field), info, _default(field))
        if word.takes_rest:
            info = typer.Argument(metavar=word.metavar, help=f"As --{name} {word.metavar}.")
            rest.append(_parameter(REST, list[str], info, None))
    yield from rest


def _parameter(name: str, kind: Any, info: Any, default: Any) -> Parameter:
    wanted = kind if default is Parameter.empty else kind | None
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[wanted, info])


def _word(field: FieldInfo) -> Word:
    return next(mark for mark in field.metadata if isinstance(mark, Word))


def _word_type(field: FieldInfo) -> Any:
    """What a word of the command line is read as; what typer has no word for is a text, or several."""
    is_union = get_origin(field.annotation) in (Union, UnionType)
    kinds = get_args(field.annotation) if is_union else (field.annotation,)
    kind, *others = [
        get_args(kind)[0] if get_origin(kind) is Annotated else kind for kind in kinds if kind is not NoneType
    ]
    word = _word(field)
    if word.has_commas or word.takes_rest or get_origin(kind) in (list, dict):
        return list[str]
    return kind if not others and kind in (bool, int, float, str, Path) else str


def _default(field: FieldInfo) -> Any:
    """As typer has it; of a calibration None, since the words at the end may have it."""
    if field.is_required():
        return None if _word(field).takes_rest else Parameter.empty
    if isinstance(field.default, list | tuple | dict):
        return [str(value) for value in field.default] or None
    return field.default


def _given(request: type[Request], words: dict[str, Any]) -> dict[str, Any]:
    """The fields that words are given for; the rest is for the request to fill."""
    given = {}
    for name, field in request.model_fields.items():
        word, value = _word(field), words[name]
        if word.takes_rest:
            value = [*(value or []), *(words[REST] or [])] or None
            if value is None and field.is_required():
                flags = f"--{name} {word.metavar}, or {word.metavar} at the end"
                raise InvalidInput(f"no {name} is given; expected {flags}")
        if value is not None and value != _default(field):
            given[name] = parts(value) if word.has_commas else value
    return given
