"""What a scene file builds: a world without cameras, as plain NumPy data.

World axes: x east, y north, z up; metres. Colours are linear RGB reflectances in [0, 1], or
radiances. Nothing here needs Mitsuba, so that a scene can be built and tested without it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rectbench.types import FloatArray

Colour = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Material:
    """A surface: `reflectance` is one colour, or texels [H, W, 3] float32 that repeat over uv."""

    reflectance: Colour | NDArray[np.float32]
    glossy: bool = False
    """A thin clear coat over the colour, as on glass and varnish."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one material."""

    name: str
    vertices: FloatArray
    """[V, 3] metres."""
    faces: NDArray[np.int64]
    """[F, 3] vertex indices; both sides are lit."""
    uv: FloatArray
    """[V, 2]; one unit is one repeat of the texture."""
    material: Material


@dataclass(frozen=True, eq=False)
class Instances:
    """Meshes repeated at many places without being copied.

    Few places of large meshes: the renderer compiles code for each placement, seconds for hundreds.
    """

    name: str
    meshes: tuple[Mesh, ...]
    placements: FloatArray
    """[K, 4, 4] world from mesh."""


@dataclass(frozen=True)
class Sun:
    """A clear sky with the sun in it."""

    direction: tuple[float, float, float] = (-0.5, -0.6, 0.65)
    """Towards the sun, any length."""
    turbidity: float = 3.5


@dataclass(frozen=True)
class Lamp:
    """A rectangular lamp that shines down from `centre`."""

    centre: tuple[float, float, float]
    size_m: tuple[float, float]
    """Extent along x and along y, metres."""
    radiance: Colour


@dataclass(frozen=True, eq=False)
class World:
    """Everything there is to see, the light on it, and where a rig stands in it."""

    meshes: tuple[Mesh, ...]
    world_from_left: FloatArray
    """[4, 4] pose of the left camera (x right, y down, z forward) for this seed."""
    instances: tuple[Instances, ...] = ()
    sun: Sun | None = None
    lamps: tuple[Lamp, ...] = ()
    ambient: Colour = (0.0, 0.0, 0.0)
    """Radiance of a uniform surround where there is no sun: what shows, and shines, through windows."""
    exposure: float = 1.0
    """Factor from path-traced radiance to display, 1.0 being white."""
    fast_exposure: float = 1.0
    """The same for the fast integrator."""
    tags: dict[str, str] = field(default_factory=dict)
