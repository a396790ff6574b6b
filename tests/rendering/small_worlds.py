"""Small cameras and worlds whose geometry can be written down."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rectbench.cameras import Camera
from rectbench.rendering.world import Material, Mesh, World
from rectbench.types import FloatArray

LOOK_NORTH = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]], dtype=float)
"""World from camera: at 1.5 m, x east, y down, z north."""


def fisheye(width: int = 96, height: int = 72) -> Camera:
    """A 190 degree lens whose image circle cuts the image's corners."""
    f = 0.28 * width
    params = {"fx": f, "fy": f, "cx": width / 2 + 1.3, "cy": height / 2 - 0.7, "k1": 0.02, "k2": -0.012}
    return Camera("kannala-brandt", (width, height), params, max_angle_deg=95)


def quad(name: str, corners: Sequence[Sequence[float]], material: Material, repeats: float = 1.0) -> Mesh:
    """A flat four-cornered mesh."""
    uv = repeats * np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    return Mesh(name, np.array(corners, dtype=float), np.array([[0, 1, 2], [0, 2, 3]]), uv, material)


def world_of(*meshes: Mesh, pose: FloatArray = LOOK_NORTH, **light: object) -> World:
    return World(meshes=meshes, world_from_left=pose, **light)  # type: ignore[arg-type]


def facing_wall(distance: float, half: float, material: Material, x: float = 0.0, z: float = 1.5) -> Mesh:
    """A square wall north of the camera, facing it."""
    corners = [[x + dx * half, distance, z + dz * half] for dx, dz in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return quad(f"wall-{distance}", corners, material)
