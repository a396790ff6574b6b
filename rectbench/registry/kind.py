"""What a kind of plugins is, and a plugin of it once it is loaded."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from rectbench.errors import InvalidInput

T = TypeVar("T")


class Described(NamedTuple, Generic[T]):
    """What a module's value is as a plugin: its name, a line about it, and the plugin itself."""

    name: str
    summary: str
    value: T


def described_object(value: Any, base: Any, *texts: str) -> Described[Any] | None:
    """A module's value as a plugin: an object of the class `base`, or one made of a class; else None.

    Its summary is the first line of its class's docstring. Raises InvalidInput where its `name` or one of
    the attributes `texts` is no text.
    """
    if inspect.isclass(value) and issubclass(value, base):
        if inspect.isabstract(value) and "name" not in vars(value):
            return None  # a base class for the file's own use
        value = value()
    if not isinstance(value, base):
        return None
    for attribute in ("name", *texts):
        if not isinstance(found := getattr(value, attribute, None), str) or not found:
            raise InvalidInput(f"{type(value).__name__}.{attribute} is {found!r}; expected a text")
    return Described(value.name, (inspect.getdoc(type(value)) or "").partition("\n")[0], value)


@dataclass(frozen=True, eq=False)
class Kind(Generic[T]):
    """A kind of plugins. Its contract's module makes the one object of it: `METHODS`, `SCENES`, ...

    Parameters
    ----------
    name : plural, as in `rectbench list methods` and the entry points' group `rectbench.methods`.
    singular : as in errors.
    expected : what a plugin's file has to hold; ends a sentence of an error.
    packages : those whose files hold the built-in ones, those of their sub-packages included; a file that
        holds none is no fault there where `is_shared`.
    described : the plugin that a value of a module is, None for any other value. Raises InvalidInput for one
        that is meant as a plugin and is broken.
    by_suffix : how a file of another suffix than `.py` is read, such as a scene in Mitsuba's `.xml`: the
        plugin, and the files that shape it.
    """

    name: str
    singular: str
    expected: str
    packages: tuple[str, ...]
    described: Callable[[Any], Described[T] | None]
    by_suffix: Mapping[str, Callable[[Path], tuple[Described[T], list[Path]]]] = field(default_factory=dict)
    is_shared: bool = False


@dataclass(frozen=True, eq=False)
class Plugin(Generic[T]):
    """A loaded plugin."""

    kind: Kind[T]
    name: str
    summary: str
    value: T
    path: Path
    """The file it comes from."""
    find_digest: Callable[[], str]

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all that shapes it, for keys; found when first asked for, as not every kind is keyed."""
        return self.find_digest()
