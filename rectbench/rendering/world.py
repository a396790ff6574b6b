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
    """A surface: `reflectance` is one colour, or texels [H, W, 3] float32 that repeat over uv.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> varnish = rb.Material((0.4, 0.25, 0.1), glossy=True)
    >>> stripes = rb.Material(np.float32([[[0.1, 0.1, 0.1], [0.8, 0.8, 0.8]]]))  # texels [1, 2, 3]
    """

    reflectance: Colour | NDArray[np.float32]
    glossy: bool = False
    """A thin clear coat over the colour, as on glass and varnish."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one material.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> corners = np.array([[-1, 3, 0], [1, 3, 0], [1, 3, 2], [-1, 3, 2]], float)
    >>> faces, uv = np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    >>> wall = rb.Mesh("wall", corners, faces, uv, rb.Material((0.5, 0.5, 0.5)))
    >>> wall.faces.shape
    (2, 3)
    """

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

    >>> import numpy as np
    >>> import rectbench as rb
    >>> post = rb.blocks.meshes([rb.blocks.box(0.1, 0.1, 1.0).of(rb.blocks.concrete(seed=0))])
    >>> places = np.stack([rb.blocks.placement(x, 5.0) for x in (-1.0, 0.0, 1.0)])
    >>> rb.Instances("posts", post, places).placements.shape
    (3, 4, 4)
    """

    name: str
    meshes: tuple[Mesh, ...]
    placements: FloatArray
    """[K, 4, 4] world from mesh."""


@dataclass(frozen=True)
class Sun:
    """A clear sky with the sun in it.

    >>> import rectbench as rb
    >>> rb.Sun(direction=(0.0, -1.0, 1.0)).turbidity  # at 45° in the south
    3.5
    """

    direction: tuple[float, float, float] = (-0.5, -0.6, 0.65)
    """Towards the sun, any length."""
    turbidity: float = 3.5


@dataclass(frozen=True)
class Lamp:
    """A rectangular lamp that shines down from `centre`.

    >>> import rectbench as rb
    >>> rb.Lamp(centre=(0.0, 4.0, 2.7), size_m=(0.6, 1.8), radiance=(13.0, 12.0, 10.0)).size_m
    (0.6, 1.8)
    """

    centre: tuple[float, float, float]
    size_m: tuple[float, float]
    """Extent along x and along y, metres."""
    radiance: Colour


@dataclass(frozen=True, eq=False)
class World:
    """Everything there is to see, the light on it, and where a rig stands in it.

    >>> import rectbench as rb
    >>> floor = rb.blocks.floor((-5, 5), (-5, 20)).of(rb.blocks.paving(seed=0))
    >>> world = rb.World(rb.blocks.meshes([floor]), rb.blocks.stand(0.0, 0.0, z=1.6), sun=rb.Sun())
    >>> world.world_from_left[:3, 2].round(3)  # the camera looks to the north
    array([0., 1., 0.])
    """

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
