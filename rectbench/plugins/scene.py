"""A scene: a named world without cameras, built from a seed."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass

from rectbench.errors import InvalidInput, InvalidResult
from rectbench.rendering.world import World


@dataclass(frozen=True)
class Scene:
    """A named, seeded builder of worlds."""

    name: str
    summary: str
    """The first line of the builder's docstring."""
    builder: Callable[[int], World]

    def build(self, seed: int = 0) -> World:
        """The world of this seed. Raises InvalidResult where the builder returns something else."""
        world = self.builder(seed)
        if not isinstance(world, World):
            raise InvalidResult(f"scene {self.name} returned {type(world).__name__}; expected a World")
        return world


def scene(name: str) -> Callable[[Callable[[int], World]], Scene]:
    """Decorate a function of a seed, with a docstring, that builds a `World`; it becomes a `Scene`."""

    def decorate(builder: Callable[[int], World]) -> Scene:
        if not name or name != name.strip():
            raise InvalidInput(f"scene name is {name!r}; expected a name")
        lines = (inspect.getdoc(builder) or "").splitlines()
        if not lines:
            raise InvalidInput(f"scene {name} has no docstring; expected one line that says what it shows")
        return Scene(name=name, summary=lines[0], builder=builder)

    return decorate
