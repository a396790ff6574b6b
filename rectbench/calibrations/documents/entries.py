"""A file's mappings that know which of their keys were asked for, so that none is left unread in silence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


class Entries(dict[str, Any]):
    """A mapping of a file. A key counts as read once it is asked for by `[key]` or `get`.

    Whether it is there (`in`), or what else is (`items`, `keys`), may be asked without reading it.
    """

    __slots__ = ("asked",)

    def __init__(self, pairs: Iterable[tuple[str, Any]] | Mapping[str, Any] = ()) -> None:
        super().__init__(pairs)
        self.asked: set[str] = set()

    def __getitem__(self, key: str) -> Any:
        self.asked.add(key)
        return super().__getitem__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self.asked.add(key)
        return super().get(key, default)


def as_entries(content: Any) -> Any:
    """The same content with each of its mappings as `Entries`."""
    if isinstance(content, dict):
        return Entries((key, as_entries(value)) for key, value in content.items())
    return [as_entries(item) for item in content] if isinstance(content, list) else content


def take(content: Any) -> None:
    """Count all keys of the content, at any depth, as read."""
    if isinstance(content, Entries):
        content.asked.update(content)
    if isinstance(content, dict | list):
        for value in content.values() if isinstance(content, dict) else content:
            take(value)


def forget(content: Any) -> None:
    """Count no key of the content, at any depth, as read."""
    if isinstance(content, Entries):
        content.asked.clear()
    if isinstance(content, dict | list):
        for value in content.values() if isinstance(content, dict) else content:
            if isinstance(value, dict | list):
                forget(value)
