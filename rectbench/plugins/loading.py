"""The one loader of rectifiers, scenes and reports, wherever they come from.

Built-ins are the files of the packages `rectbench_methods`, `rectbench_scenes` and
`rectbench_reports`; installed packages announce theirs as entry points of the groups
`rectbench.methods`, `rectbench.scenes` and `rectbench.reports`; and wherever a name is accepted, so is
the path of a file. All three see the same public names and get the same treatment.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import inspect
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, Literal
from xml.etree import ElementTree

from pydantic import ValidationError

from rectbench.errors import InvalidInput, UnknownName
from rectbench.experiments.spec import Report
from rectbench.plugins.rectifier import Options, Rectifier
from rectbench.plugins.scene import Scene
from rectbench.store.keys import digest, file_digest

Kind = Literal["methods", "scenes", "reports"]
SINGULAR = {"methods": "method", "scenes": "scene", "reports": "report"}
EXPECTED = {
    "methods": "a subclass of rectbench.Rectifier with a name",
    "scenes": "a function decorated with @rectbench.scene(name)",
    "reports": "a rectbench.Report",
}


@dataclass(frozen=True, eq=False)
class Plugin:
    """A loaded rectifier, scene or report."""

    kind: Kind
    name: str
    summary: str
    path: Path
    """The file it comes from."""
    digest: str
    """SHA-256 of what shapes it, for keys."""
    value: Any
    """A Rectifier, Scene or Report, as `kind` says."""


@dataclass
class Registry:
    """The plugins of one kind by name, and the broken ones by place."""

    kind: Kind
    found: dict[str, list[Plugin]] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)
    """Why each could not be loaded, in one line."""

    def names(self) -> list[str]:
        """All names, sorted; two plugins of one name count once."""
        return sorted(self.found)

    def plugins(self) -> list[Plugin]:
        """All sound plugins, by name."""
        return [self.found[name][0] for name in self.names() if len(self.found[name]) == 1]

    def get(self, name_or_path: str | Path) -> Plugin:
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
                raise UnknownName(SINGULAR[self.kind], str(name_or_path), self.found)
            rivals = self.found[str(name_or_path)]
        if len({rival.path for rival in rivals}) > 1:
            raise InvalidInput(_clash(rivals))
        return rivals[-1]

    def add(self, place: str, load: Callable[[], list[Plugin]]) -> None:
        """Register what `load` finds at `place`, or why it finds nothing."""
        try:
            plugins = load()
        except (Exception, SystemExit) as error:  # a plugin may raise anything
            self.broken[place] = _reason(error)
            return
        for plugin in plugins:
            self.found.setdefault(plugin.name, []).append(plugin)
            if len({rival.path for rival in self.found[plugin.name]}) > 1:
                self.broken[place] = _clash(self.found[plugin.name])

    def _in_file(self, path: Path) -> Plugin:
        if not path.is_file():
            raise InvalidInput(f"there is no file {path}; expected {EXPECTED[self.kind]} in it")
        try:
            plugins = _from_file(self.kind, path.resolve())
        except (Exception, SystemExit) as error:  # a plugin may raise anything
            raise InvalidInput(f"{path} cannot be loaded: {_reason(error)}") from error
        if len(plugins) > 1:
            names = ", ".join(plugin.name for plugin in plugins)
            raise InvalidInput(f"{path} holds several {self.kind} ({names}); expected one")
        return plugins[0]

    def _blame_broken(self, name: str) -> None:
        """Say why, where the name looks like that of a file that could not be loaded."""
        for place, reason in self.broken.items():
            if Path(place).stem.replace("_", "-") == name.replace("_", "-"):
                raise InvalidInput(f"{SINGULAR[self.kind]} '{name}' cannot be loaded from {place}: {reason}")


def is_path(name: str | Path) -> bool:
    """Whether a plugin is given by its file rather than by its name."""
    return isinstance(name, Path) or "/" in name or "\\" in name or name.endswith((".py", ".xml"))


@cache
def registry(kind: Kind) -> Registry:
    """All plugins of a kind on this machine; loaded once a process."""
    found = Registry(kind)
    package = f"rectbench_{kind}"
    for path in _builtin_files(package):
        module = f"{package}.{path.stem}"
        found.add(str(path), lambda path=path, module=module: _from_module(kind, path, module))  # type: ignore[misc]
    for point in importlib.metadata.entry_points(group=f"rectbench.{kind}"):
        found.add(f"{point.group}:{point.name} = {point.value}", lambda point=point: _from_point(kind, point))  # type: ignore[misc]
    return found


def _builtin_files(package: str) -> list[Path]:
    spec = importlib.util.find_spec(package)
    folders = [Path(folder) for folder in (spec.submodule_search_locations or [])] if spec else []
    return sorted(path for folder in folders for path in folder.glob("*.py") if not path.stem.startswith("_"))


def _from_module(kind: Kind, path: Path, module: str) -> list[Plugin]:
    return _plugins_in(kind, importlib.import_module(module), path, file_digest(path))


def _from_point(kind: Kind, point: importlib.metadata.EntryPoint) -> list[Plugin]:
    loaded = point.load()
    path = Path(str(sys.modules[point.module].__file__))
    source = digest([file_digest(path), point.dist.version if point.dist else None])
    if isinstance(loaded, ModuleType):
        return _plugins_in(kind, loaded, path, source)
    return _require([_as_plugin(kind, loaded, path, source)], kind)


def _from_file(kind: Kind, path: Path) -> list[Plugin]:
    if path.suffix == ".xml" and kind == "scenes":
        return [_xml_scene(path)]
    return _load_file(kind, path, file_digest(path))


@cache
def _load_file(kind: Kind, path: Path, source_digest: str) -> list[Plugin]:
    name = f"rectbench_file_{source_digest[:12]}_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise InvalidInput(f"it is no Python file; expected {EXPECTED[kind]}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses and pydantic look their module up there
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return _plugins_in(kind, module, path, source_digest)


def _plugins_in(kind: Kind, module: ModuleType, path: Path, source_digest: str) -> list[Plugin]:
    own = {id(value): value for value in vars(module).values() if _is_own(value, module)}
    return _require([_as_plugin(kind, value, path, source_digest) for value in own.values()], kind)


def _is_own(value: Any, module: ModuleType) -> bool:
    """Classes that a plugin merely imports are not its own; objects are taken as they stand."""
    return not inspect.isclass(value) or value.__module__ == module.__name__


def _require(plugins: Iterable[Plugin | None], kind: Kind) -> list[Plugin]:
    sound = [plugin for plugin in plugins if plugin is not None]
    if not sound:
        raise InvalidInput(f"there is no {SINGULAR[kind]} in it; expected {EXPECTED[kind]}")
    return sound


def _as_plugin(kind: Kind, value: Any, path: Path, source_digest: str) -> Plugin | None:
    if kind == "scenes" and isinstance(value, Scene):
        return Plugin(kind, value.name, value.summary, path, source_digest, value)
    if kind == "reports" and isinstance(value, Report):
        return Plugin(kind, value.name, value.title, path, source_digest, value)
    if kind == "methods" and inspect.isclass(value) and issubclass(value, Rectifier):
        if inspect.isabstract(value) and "name" not in vars(value):
            return None  # a base class for the file's own use
        return _method(value(), path, source_digest)
    if kind == "methods" and isinstance(value, Rectifier):
        return _method(value, path, source_digest)
    return None


def _method(rectifier: Rectifier, path: Path, source_digest: str) -> Plugin:
    name = getattr(rectifier, "name", None)
    if not isinstance(name, str) or not name:
        raise InvalidInput(f"{type(rectifier).__name__}.name is {name!r}; expected the method's name")
    if not (inspect.isclass(rectifier.Options) and issubclass(rectifier.Options, Options)):
        raise InvalidInput(
            f"{type(rectifier).__name__}.Options is {rectifier.Options!r}; expected a subclass of Options"
        )
    summary = (inspect.getdoc(type(rectifier)) or "").partition("\n")[0]
    return Plugin("methods", name, summary, path, source_digest, rectifier)


def _xml_scene(path: Path) -> Plugin:
    def build(seed: int) -> Any:
        from rectbench.rendering.xml_world import xml_world  # needs Mitsuba; a stored pair does not

        return xml_world(path)

    scene = Scene(name=path.stem, summary=f"the Mitsuba scene {path.name}", builder=build)
    files = {str(file): file_digest(file) for file in _xml_files(path)}
    return Plugin("scenes", scene.name, scene.summary, path, digest(files), scene)


def _xml_files(path: Path) -> list[Path]:
    """The scene file and every file it names: meshes, textures, included scenes."""
    files, queue = [], [path]
    while queue:
        file = queue.pop()
        files.append(file)
        if file.suffix == ".xml":
            named = [_file_named_by(element) for element in ElementTree.parse(file).iter()]
            queue += [path.parent / name for name in named if name and (path.parent / name).is_file()]
        queue = [file for file in queue if file not in files]
    return sorted(files)


def _file_named_by(element: ElementTree.Element) -> str | None:
    return element.get("value") if element.get("name") == "filename" else element.get("filename")


def _clash(rivals: list[Plugin]) -> str:
    kind = SINGULAR[rivals[0].kind]
    return f"two {kind}s are called '{rivals[0].name}': {rivals[-2].path} and {rivals[-1].path}"


def _reason(error: BaseException) -> str:
    """One line: what went wrong, and on which line of the plugin."""
    text = " ".join(str(error).split())
    if isinstance(error, ValidationError):  # of a report, whose own lines are not to blame
        return "; ".join(map(_fault, error.errors(include_url=False)))
    if isinstance(error, InvalidInput | SyntaxError):
        return text if isinstance(error, InvalidInput) else f"SyntaxError: {text}"
    frames = traceback.extract_tb(error.__traceback__)
    where = f" (line {frames[-1].lineno} of {Path(frames[-1].filename).name})" if frames else ""
    return f"{type(error).__name__}: {text}{where}"


def _fault(fault: Mapping[str, Any]) -> str:
    """One of pydantic's faults in a line: the field, and what is wrong with it."""
    field = ".".join(map(str, fault["loc"]))
    text = " ".join(str(fault["msg"]).removeprefix("Value error, ").split())
    return f"{field}: {text}" if field else text
