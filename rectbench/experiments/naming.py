"""Plugins and rigs by the names a report or a user gives them, and what finds them in another process."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from rectbench.calibrations import load_rig, rig_names
from rectbench.errors import InvalidInput, UnknownName
from rectbench.registry import Kind, Plugin, is_path, registry

T = TypeVar("T")


def require_known(kind: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raise UnknownName for the first name that is not known."""
    for name in names:
        if name not in known:
            raise UnknownName(kind, name, known)


def plugins_named(kind: Kind[T], names: Sequence[str]) -> list[tuple[Plugin[T], str]]:
    """Each plugin with its source: its name, or its absolute path.

    Raises UnknownName; InvalidInput where two files hold plugins of one name.
    """
    by_name: dict[str, tuple[Plugin[T], str]] = {}
    for name in names:
        plugin, source = registry(kind).get(name), str(Path(name).resolve()) if is_path(name) else name
        rival, _ = by_name.setdefault(plugin.name, (plugin, source))
        if rival.path != plugin.path:
            raise InvalidInput(f"two {kind.name} are called '{plugin.name}': {rival.path} and {plugin.path}")
    return list(by_name.values())


def rigs_named(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """By what each rig is asked for: its name, and its source, which is that name or an absolute path.

    Raises InvalidInput for a file that is no rig, and where two files hold rigs of one name.
    """
    rigs: dict[str, tuple[str, str]] = {}
    sources: dict[str, str] = {}
    for name in names:
        rig = load_rig(name).name
        source = name if name in rig_names() else str(Path(name).resolve())
        if sources.setdefault(rig, source) != source:
            raise InvalidInput(f"two rigs are called '{rig}': {sources[rig]} and {source}")
        rigs[name] = rig, source
    return rigs
