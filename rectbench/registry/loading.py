"""The one loader of plugins, wherever they come from.

Built-ins are the files of a kind's packages and their sub-packages; installed packages announce theirs as
entry points of the group `rectbench.<kind>`; and wherever a name is accepted, so is the path of a file. All
of them see the same public names and get the same treatment.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import inspect
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, TypeVar

from rectbench.errors import InvalidInput, UnknownName
from rectbench.registry import beside
from rectbench.registry.beside import PRIVATE, load_beside
from rectbench.registry.kind import Kind, Plugin
from rectbench.registry.sources import plugin_digest
from rectbench.store.keys import code_digest, digest, file_digest

T = TypeVar("T")
_IMPORTING = {str(beside.__file__), "<frozen importlib._bootstrap>", "<frozen importlib._bootstrap_external>"}
"""Files of a traceback that lead to a plugin's own line."""


@dataclass
class Registry(Generic[T]):
    """The plugins of one kind by name, and the broken ones by place."""

    kind: Kind[T]
    found: dict[str, list[Plugin[T]]] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)
    """Why each could not be loaded, in one line."""

    def names(self) -> list[str]:
        """All names, sorted; two plugins of one name count once."""
        return sorted(self.found)

    def plugins(self) -> list[Plugin[T]]:
        """All sound plugins, by name."""
        return [self.found[name][0] for name in self.names() if len(self.found[name]) == 1]

    def get(self, name_or_path: str | Path) -> Plugin[T]:
        """The plugin of this name, or in this file.

        Raises UnknownName, with the nearest names; InvalidInput where the file holds no sound plugin,
        or where two plugins have the name.
        """
        if is_path(name_or_path):
            plugin = self._in_file(Path(name_or_path))
            rivals = [*self.found.get(plugin.name, []), plugin]
        else:
            if name_or_path not in self.found:
                self._blame_broken(str(name_or_path))
                raise UnknownName(self.kind.singular, str(name_or_path), self.found)
            rivals = self.found[str(name_or_path)]
        if len({rival.path for rival in rivals}) > 1:
            raise InvalidInput(_clash(rivals))
        return rivals[-1]

    def add(self, place: str, load: Callable[[], list[Plugin[T]]]) -> None:
        """Register what `load` finds at `place`, or why it finds nothing."""
        try:
            plugins = load()
        except BaseException as error:  # a plugin may raise anything
            if isinstance(error, KeyboardInterrupt):
                raise
            self.broken[place] = _reason(error)
            return
        for plugin in plugins:
            self.found.setdefault(plugin.name, []).append(plugin)
            if len({rival.path for rival in self.found[plugin.name]}) > 1:
                self.broken[place] = _clash(self.found[plugin.name])

    def _in_file(self, path: Path) -> Plugin[T]:
        if path.is_dir():
            raise InvalidInput(f"{path} is a folder; expected a file with {self.kind.expected} in it")
        if not path.is_file():
            raise InvalidInput(f"there is no file {path}; expected {self.kind.expected} in it")
        try:
            plugins = _from_file(self.kind, path.resolve())
        except BaseException as error:  # a plugin may raise anything
            if isinstance(error, KeyboardInterrupt):
                raise
            raise InvalidInput(f"{path} cannot be loaded: {_reason(error)}") from error
        if len(plugins) > 1:
            names = ", ".join(plugin.name for plugin in plugins)
            raise InvalidInput(f"{path} holds several {self.kind.name} ({names}); expected one")
        return plugins[0]

    def _blame_broken(self, name: str) -> None:
        """Say why, where the name looks like that of a file that could not be loaded."""
        for place, reason in self.broken.items():
            if Path(place).stem.replace("_", "-") == name.replace("_", "-"):
                raise InvalidInput(f"{self.kind.singular} '{name}' cannot be loaded from {place}: {reason}")


def is_path(name: str | Path) -> bool:
    """Whether a plugin is given by its file rather than by its name."""
    return isinstance(name, Path) or "/" in name or "\\" in name or name.endswith((".py", ".xml"))


def registry(kind: Kind[T]) -> Registry[T]:
    """All plugins of a kind on this machine; loaded once a process."""
    found: Registry[T] = _loaded(kind)
    return found


def forget_plugins() -> None:
    """Load every kind anew when it is next asked for."""
    _loaded.cache_clear()


@cache
def _loaded(kind: Kind[Any]) -> Registry[Any]:
    found: Registry[Any] = Registry(kind)
    for package in kind.packages:
        for module, path in _built_in_files(package):
            found.add(str(path), lambda module=module, path=path: _built_in(kind, module, path))  # type: ignore[misc]
    for point in importlib.metadata.entry_points(group=f"rectbench.{kind.name}"):
        place = f"{point.group}:{point.name} = {point.value}"
        found.add(place, lambda point=point: _announced(kind, point))  # type: ignore[misc]
    return found


def _built_in_files(package: str) -> Iterator[tuple[str, Path]]:
    """Module and file of all in a package and its sub-packages that is not private, by path."""
    spec = importlib.util.find_spec(package)
    for folder in (spec.submodule_search_locations or []) if spec else []:
        for path in sorted(Path(folder).rglob("*.py")):
            names = path.relative_to(folder).with_suffix("").parts
            if (path.parent / "__init__.py").is_file() and not any(name.startswith("_") for name in names):
                yield ".".join((package, *names)), path


def _built_in(kind: Kind[T], module: str, path: Path) -> list[Plugin[T]]:
    loaded = importlib.import_module(module)
    if module.startswith("rectbench."):  # sees more than the public names
        plugins = _plugins_in(kind, loaded, path, lambda: code_digest(module))
    else:
        source = plugin_digest(path)
        plugins = _plugins_in(kind, loaded, path, lambda: source)
    return plugins if kind.is_shared else _require(kind, plugins)


def _announced(kind: Kind[T], point: importlib.metadata.EntryPoint) -> list[Plugin[T]]:
    loaded = point.load()
    path = Path(str(sys.modules[point.module].__file__))
    topmost = sys.modules[point.module.partition(".")[0]]
    root = Path(topmost.__path__[0]) if hasattr(topmost, "__path__") else path
    source = digest([plugin_digest(path, root), point.dist.version if point.dist else None])
    if isinstance(loaded, ModuleType):
        return _require(kind, _plugins_in(kind, loaded, path, lambda: source))
    described = kind.described(loaded)
    return _require(kind, [] if described is None else [Plugin(kind, *described, path, lambda: source)])


def _from_file(kind: Kind[T], path: Path) -> list[Plugin[T]]:
    if read := kind.by_suffix.get(path.suffix):
        described, files = read(path)
        source = digest({os.path.relpath(file, path.parent): file_digest(file) for file in files})
        return [Plugin(kind, *described, path, lambda: source)]
    try:
        source = plugin_digest(path)
    except SyntaxError:
        source = file_digest(path)  # loading it says what is wrong, and where
    return _load_file(kind, path, source)


@cache
def _load_file(kind: Kind[T], path: Path, source: str) -> list[Plugin[T]]:
    if path.suffix != ".py":
        raise InvalidInput(f"it is no Python file; expected {kind.expected}")
    place = digest([str(path.parent), source])  # another folder's file of the same text has other neighbours
    module = load_beside(path, f"{PRIVATE}{place[:16]}")
    return _require(kind, _plugins_in(kind, module, path, lambda: source))


def _plugins_in(kind: Kind[T], module: ModuleType, path: Path, source: Callable[[], str]) -> list[Plugin[T]]:
    own = {id(value): value for value in vars(module).values() if _is_own(value, module)}
    return [
        Plugin(kind, *described, path, source)
        for value in own.values()
        if (described := kind.described(value)) is not None
    ]


def _is_own(value: Any, module: ModuleType) -> bool:
    """Classes that a plugin merely imports are not its own; objects are taken as they stand."""
    return not inspect.isclass(value) or value.__module__ == module.__name__


def _require(kind: Kind[T], plugins: list[Plugin[T]]) -> list[Plugin[T]]:
    if not plugins:
        raise InvalidInput(f"there is no {kind.singular} in it; expected {kind.expected}")
    return plugins


def _clash(rivals: list[Plugin[T]]) -> str:
    kind = rivals[0].kind
    return f"two {kind.name} are called '{rivals[0].name}': {rivals[-2].path} and {rivals[-1].path}"


def _reason(error: BaseException) -> str:
    """One line: what went wrong, and on which line of the plugin."""
    from pydantic import ValidationError  # a tenth of a second, which only errors need

    text = " ".join(str(error).split())
    if isinstance(error, ValidationError):  # of a report, whose own lines are not to blame
        return "; ".join(map(_fault, error.errors(include_url=False)))
    if isinstance(error, InvalidInput | SyntaxError):
        return text if isinstance(error, InvalidInput) else f"SyntaxError: {text}"
    frames = [f for f in traceback.extract_tb(error.__traceback__) if f.filename not in _IMPORTING]
    where = f" (line {frames[-1].lineno} of {Path(frames[-1].filename).name})" if frames else ""
    return f"{type(error).__name__}: {text}{where}"


def _fault(fault: Mapping[str, Any]) -> str:
    """One of pydantic's faults in a line: the field, and what is wrong with it."""
    field = ".".join(map(str, fault["loc"]))
    text = " ".join(str(fault["msg"]).removeprefix("Value error, ").split())
    return f"{field}: {text}" if field else text
