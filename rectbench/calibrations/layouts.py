"""Which of a format's camera models holds a camera exactly."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TypeVar

from rectbench.cameras import Camera
from rectbench.cameras.equivalents import equal_cameras
from rectbench.cameras.lens import lens_named
from rectbench.rigs.file_formats import CannotHold

Key = TypeVar("Key")
Layouts = Mapping[Key, tuple[str, Collection[str]]]
"""A format's names of camera models: the projection model of each, and the parameters it has places for."""


def layout_of(camera: Camera, layouts: Layouts[Key], format: str, side: str) -> tuple[Key, Camera]:
    """Which of a format's layouts holds the camera exactly, and the camera by that layout's model.

    The first of the camera's own model that will do is taken, else the first of a model under which it
    is the same camera (see `equal_cameras`). Raises CannotHold, naming the parameters that have no place.
    """
    for equal in equal_cameras(camera):
        for layout, (model, names) in layouts.items():
            if model == equal.model and not _left_out(equal, names):
                return layout, equal
    who = f"{format} has no place for the {side} camera, {camera.model}"
    places = [names for model, names in layouts.values() if model == camera.model]
    if places:
        fewest = min((_left_out(camera, names) for names in places), key=len)
        who += f" with {', '.join(f'{name} = {camera.params[name]:g}' for name in fewest)}"
    raise CannotHold(who)


def _left_out(camera: Camera, names: Collection[str]) -> list[str]:
    """The parameters that are none of these and not at their default."""
    defaults = lens_named(camera.model).defaults
    return [
        name
        for name, value in camera.params.items()
        if name not in names and value not in ((), defaults.get(name, 0.0))
    ]
