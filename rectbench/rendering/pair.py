"""Renders a rig in a world: the two images and the truth about them."""

from __future__ import annotations

from typing import Any, Literal, get_args, overload

import numpy as np

from rectbench.errors import InvalidInput, UnknownName
from rectbench.rendering import mitsuba_scene
from rectbench.rendering.images import StereoPair, radiance, srgb8
from rectbench.rendering.integrator import fast_integrator
from rectbench.rendering.sensor import load_sensor
from rectbench.rendering.tracing import posed_cameras, trace_truth
from rectbench.rendering.truth import Truth
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import World
from rectbench.rendering.xml_world import XmlWorld
from rectbench.rigs.rig import Rig

Quality = Literal["path", "fast"]
QUALITIES: tuple[str, ...] = get_args(Quality)

PATH_DEPTH = 5
"""Vertices of a light path: four bounces light the inside of a room to within a few percent."""

MOST_SAMPLES = 1 << 16

BRIGHTEST = 8.0
"""Ceiling of one sample, in units of display white: rare bright paths stay below visible sparkle."""


@overload
def render_pair(
    world: World | XmlWorld,
    rig: Rig,
    *,
    seed: int = ...,
    spp: int = ...,
    quality: str = ...,
    images: Literal[True] = ...,
    truth: Literal[True] = ...,
) -> tuple[StereoPair, Truth]: ...
@overload
def render_pair(
    world: World | XmlWorld,
    rig: Rig,
    *,
    seed: int = ...,
    spp: int = ...,
    quality: str = ...,
    images: bool = ...,
    truth: bool = ...,
) -> tuple[StereoPair | None, Truth | None]: ...
def render_pair(
    world: World | XmlWorld,
    rig: Rig,
    *,
    seed: int = 0,
    spp: int = 64,
    quality: str = "path",
    images: bool = True,
    truth: bool = True,
) -> tuple[StereoPair | None, Truth | None]:
    """The images a rig takes in a world, and the truth about them.

    Parameters
    ----------
    world : where the left camera stands at `world_from_left`, the right one as the rig says.
    seed : of the noise in the images; left and right get different noise.
    spp : samples a pixel, a power of two (the sum over a pixel is then the same on any machine).
    quality : `path` traces light paths; `fast` shades with one shadow ray and one for the
        surroundings, at a tenth of the cost.
    images, truth : what to compute; what is not asked for is None.

    Raises InvalidInput for an argument that cannot be used, Unavailable where nothing can render.
    """
    _check(world, rig, seed, spp, quality)
    scene, integrator, exposure = _staged(world, quality)
    pair = None
    if images:
        left, right = (
            srgb8(
                radiance(
                    scene,
                    load_sensor(camera, pose),
                    integrator,
                    spp=spp,
                    seed=_camera_seed(seed, side),
                    brightest=BRIGHTEST / exposure,
                ),
                exposure,
            )
            for side, (camera, pose) in enumerate(posed_cameras(rig, world.world_from_left))
        )
        pair = StereoPair(left, right)
    return pair, trace_truth(scene, rig, world.world_from_left) if truth else None


def _staged(world: World | XmlWorld, quality: str) -> tuple[Any, Any, float]:
    """The Mitsuba scene, its integrator, and the exposure of its radiance."""
    mi = mitsuba()
    if isinstance(world, World) and quality == "fast":
        return mitsuba_scene.fast_scene(world), fast_integrator(world), world.fast_exposure
    path = {"type": "path", "max_depth": PATH_DEPTH}
    # A user's own scene has lights of any kind: its fast picture is Mitsuba's direct light.
    integrator = mi.load_dict(path if quality == "path" else {"type": "direct"})
    if isinstance(world, World):
        return mitsuba_scene.path_scene(world), integrator, world.exposure
    return world.scene, integrator, world.exposure


def _camera_seed(seed: int, side: int) -> int:
    return int(np.random.SeedSequence([seed, side]).generate_state(1)[0])


def _check(world: object, rig: object, seed: object, spp: object, quality: str) -> None:
    if not isinstance(world, World | XmlWorld):
        raise InvalidInput(
            f"world is {type(world).__name__}; expected a World, or a scene read with xml_world"
        )
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig")
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InvalidInput(f"seed is {seed!r}; expected a whole number from 0")
    if isinstance(spp, bool) or not isinstance(spp, int) or not 1 <= spp <= MOST_SAMPLES or spp & (spp - 1):
        raise InvalidInput(f"spp is {spp!r}; expected a power of two from 1 to {MOST_SAMPLES}")
    if quality not in QUALITIES:
        raise UnknownName("quality", str(quality), QUALITIES)
