"""What a user says beside the report: a TOML file, and `--option method.name=value`.

[run]
methods = ["abraham", "mine.py"]
jobs = 2

[methods.conventional]
focal = "fov"
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rectbench.errors import InvalidInput, UnknownName

RUN_KEYS: Mapping[str, type | tuple[type, ...]] = {
    "out": str,
    "methods": list,
    "scenes": list,
    "rigs": list,
    "seeds": list,
    "data": str,
    "jobs": int,
    "dask": str,
    "fresh": bool,
}

OptionSets = dict[str, dict[str, Any]]
"""Options by method and name."""


def read_config(path: Path) -> tuple[dict[str, Any], OptionSets]:
    """The `[run]` keys and the options by method of a TOML file.

    Raises InvalidInput for a file that cannot be read, UnknownName for a key that does not exist.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise InvalidInput(f"{path} is no TOML: {error}") from None
    _only(path, "section", document, ("run", "methods"))
    settings, methods = document.get("run", {}), document.get("methods", {})
    for section, values in (("run", settings), ("methods", methods)):
        if not isinstance(values, dict):
            raise InvalidInput(f"{path}: {section} is {values!r}; expected a section [{section}]")
    _only(path, "key of [run]", settings, RUN_KEYS)
    for key, value in settings.items():
        if not isinstance(value, RUN_KEYS[key]) or (isinstance(value, bool) and RUN_KEYS[key] is not bool):
            raise InvalidInput(f"{path}: {key} is {value!r}; expected {_expected(key)}")
    for method, options in methods.items():
        if not isinstance(options, dict):
            raise InvalidInput(f"{path}: methods.{method} is {options!r}; expected a section of options")
    return settings, methods


def read_options(texts: Sequence[str]) -> OptionSets:
    """Options by method of texts `method.name=value`; a value is TOML, or a word as it stands."""
    options: OptionSets = {}
    for text in texts:
        place, equals, value = text.partition("=")
        method, dot, name = place.strip().rpartition(".")
        if not (equals and dot and method and name):
            raise InvalidInput(f"option is {text!r}; expected method.name=value")
        options.setdefault(method, {})[name.replace("-", "_")] = parsed(value.strip())
    return options


def read_method_options(texts: Sequence[str] | None) -> dict[str, Any]:
    """Options of one method of texts `name=value`."""
    return read_options([f"method.{text}" for text in texts or ()]).get("method", {})


def parsed(text: str) -> Any:
    """A value as TOML reads it; a word that TOML does not know is itself."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def overlaid(*layers: OptionSets) -> OptionSets:
    """Option sets of which later ones win."""
    merged: OptionSets = {}
    for layer in layers:
        for method, options in layer.items():
            merged[method] = {**merged.get(method, {}), **options}
    return merged


def _only(path: Path, kind: str, given: Mapping[str, Any], known: Sequence[str] | Mapping[str, Any]) -> None:
    for key in given:
        if key not in known:
            raise UnknownName(f"{kind} in {path}", key, known)


def _expected(key: str) -> str:
    kind = RUN_KEYS[key]
    return {list: "a list", int: "a whole number", bool: "true or false"}.get(kind, "a text")  # type: ignore[arg-type]
