"""A user's Mitsuba .xml scene as a world for a rig to stand in."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.errors import InvalidInput
from rectbench.rendering import sensor
from rectbench.rendering.checks import pose_fault
from rectbench.types import FloatArray


@dataclass(frozen=True, eq=False)
class XmlWorld:
    """A loaded .xml scene and where the left camera stands in it; made by `xml_world`."""

    path: Path
    scene: Any = field(repr=False)
    """The `mi.Scene`."""
    world_from_left: FloatArray
    """[4, 4] pose of the left camera (x right, y down, z forward)."""
    exposure: float = 1.0
    """Factor from the scene's radiance to display, 1.0 being white."""


def xml_world(
    path: str | Path, world_from_left: ArrayLike | None = None, *, exposure: float = 1.0
) -> XmlWorld:
    """Read a Mitsuba .xml scene. Without `world_from_left`, its first sensor's pose is the left camera's.

    The scene's own sensors, film and integrator are not rendered with; its shapes and lights are.
    Raises InvalidInput for a file that Mitsuba cannot read, or a scene with no pose to stand at.
    """
    path = Path(path)
    if not path.is_file():
        raise InvalidInput(f"{path}: no such scene file")
    if not exposure > 0 or not np.isfinite(exposure):
        raise InvalidInput(f"exposure is {exposure}; expected a number above 0")
    mi = sensor.register()
    try:
        scene = mi.load_file(str(path), optimize=False)
    except Exception as error:  # Mitsuba's parsers and plugins raise whatever they like
        raise InvalidInput(f"{path}: not a Mitsuba scene: {' '.join(str(error).split())}") from None
    if not isinstance(scene, mi.Scene):
        raise InvalidInput(f"{path}: holds a {type(scene).__name__}; expected a <scene>")
    pose = (
        _sensor_pose(scene, path) if world_from_left is None else np.array(world_from_left, dtype=np.float64)
    )
    return XmlWorld(path, scene, _checked_pose(pose, path), float(exposure))


def _sensor_pose(scene: Any, path: Path) -> FloatArray:
    """The pose of the scene's first sensor, in our axes and without the scale that a look-at may hold."""
    if not scene.sensors():
        raise InvalidInput(f"{path}: the scene has no sensor; expected one, or world_from_left")
    matrix = np.array(scene.sensors()[0].world_transform().matrix, dtype=np.float64).reshape(4, 4)
    matrix[:3, :3] /= np.linalg.norm(matrix[:3, :3], axis=0)
    return matrix @ sensor.CV_FROM_MITSUBA


def _checked_pose(pose: FloatArray, path: Path) -> FloatArray:
    """The pose with its rotation made exactly orthonormal."""
    fault = pose_fault(pose)
    if fault is not None:
        raise InvalidInput(f"{path}: the left camera's pose {fault}; expected a rigid motion [4, 4]")
    u, _, vt = np.linalg.svd(pose[:3, :3])
    rigid = pose.copy()
    rigid[:3, :3] = u @ vt
    return rigid
