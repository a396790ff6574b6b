"""A scene: a named world without cameras, built from a seed."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from rectbench.errors import InvalidInput, InvalidResult
from rectbench.registry.kind import Described, Kind
from rectbench.rendering.world import World
from rectbench.rendering.xml_world import XmlWorld, xml_world


@dataclass(frozen=True)
class Scene:
    """A named, seeded builder of worlds."""

    name: str
    summary: str
    """The first line of the builder's docstring."""
    builder: Callable[[int], World | XmlWorld]

    def build(self, seed: int = 0) -> World | XmlWorld:
        """The world of this seed. Raises InvalidResult where the builder returns something else."""
        world = self.builder(seed)
        if not isinstance(world, World | XmlWorld):
            raise InvalidResult(f"scene {self.name} returned {type(world).__name__}; expected a World")
        return world


def scene(name: str) -> Callable[[Callable[[int], World]], Scene]:
    """Decorate a function of a seed, with a docstring, that builds a `World`; it becomes a `Scene`.

    >>> import rectbench as rb
    >>> @rb.scene("void")
    ... def build(seed: int) -> rb.World:
    ...     'Nothing at all.'
    >>> build.name, build.summary
    ('void', 'Nothing at all.')
    """

    def decorate(builder: Callable[[int], World]) -> Scene:
        if not name or name != name.strip():
            raise InvalidInput(f"scene name is {name!r}; expected a name")
        lines = (inspect.getdoc(builder) or "").splitlines()
        if not lines:
            raise InvalidInput(f"scene {name} has no docstring; expected one line that says what it shows")
        return Scene(name=name, summary=lines[0], builder=builder)

    return decorate


def _described(value: Any) -> Described[Scene] | None:
    return Described(value.name, value.summary, value) if isinstance(value, Scene) else None


def _xml_scene(path: Path) -> tuple[Described[Scene], list[Path]]:
    """A Mitsuba scene file as a scene; and itself with every file that it names: they shape it."""

    def build(seed: int) -> XmlWorld:
        return xml_world(path)

    scene = Scene(name=path.stem, summary=f"the Mitsuba scene {path.name}", builder=build)
    return Described(scene.name, scene.summary, scene), _xml_files(path)


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


SCENES: Kind[Scene] = Kind(
    name="scenes",
    singular="scene",
    expected="a function decorated with @rectbench.scene(name)",
    package="rectbench_scenes",
    described=_described,
    by_suffix={".xml": _xml_scene},
)
