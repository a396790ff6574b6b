"""A TOML file that says what a run takes beside the report.

[run]
methods = ["abraham", "mine.py"]
jobs = 2

[methods.conventional]
focal = "fov"
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from rectbench.applications.requests.words import OptionSets
from rectbench.errors import InvalidInput, UnknownName


def read_config(path: Path, run_keys: Collection[str]) -> tuple[dict[str, Any], OptionSets]:
    """The `[run]` keys and the options by method of a TOML file; their values are for the request to check.

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
    _only(path, "key of [run]", settings, run_keys)
    for method, options in methods.items():
        if not isinstance(options, dict):
            raise InvalidInput(f"{path}: methods.{method} is {options!r}; expected a section of options")
    return settings, methods


def overlaid(*layers: OptionSets) -> OptionSets:
    """Option sets of which later ones win."""
    merged: OptionSets = {}
    for layer in layers:
        for method, options in layer.items():
            merged[method] = {**merged.get(method, {}), **options}
    return merged


def _only(path: Path, kind: str, given: Mapping[str, Any], known: Collection[str]) -> None:
    for key in given:
        if key not in known:
            raise UnknownName(f"{kind} in {path}", key, known)
