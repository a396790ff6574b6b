"""Renders a rig in a world: the two images and the truth about them."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import Any, Literal, get_args, overload

import numpy as np

from rectbench.errors import InvalidInput, UnknownName, argument
from rectbench.images.stereo_pair import Image, StereoPair
from rectbench.rendering.images import radiance, srgb8
from rectbench.rendering.integrator import fast_integrator
from rectbench.rendering.mitsuba_scene import fast_scene, path_scene
from rectbench.rendering.rectified_truth import RectifiedTruth
from rectbench.rendering.sensor import load_sensor
from rectbench.rendering.tracing import posed_cameras, trace_rectified, trace_truth
from rectbench.rendering.truth import Truth
from rectbench.rendering.variant import mitsuba
from rectbench.rendering.world import World
from rectbench.rendering.xml_world import XmlWorld
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification

Quality = Literal["path", "fast"]
QUALITIES: tuple[str, ...] = get_args(Quality)

PATH_DEPTH = 5
"""Vertices of a light path: four bounces light the inside of a room to within a few percent."""

MOST_SAMPLES = 1 << 16

BRIGHTEST = 8.0
"""Ceiling of one sample, in units of display white: rare bright paths leave no visible specks."""


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
    _check(rig, seed, spp)
    stage = Stage.of(world, quality)
    pair = stage.photograph(rig, seed=seed, spp=spp) if images else None
    return pair, stage.survey(rig) if truth else None


@dataclass(frozen=True, eq=False)
class Stage:
    """A world set up in the renderer, for as many rigs as are to be rendered in it."""

    scene: Any
    """The `mi.Scene`."""
    integrator: Any
    """The `mi.SamplingIntegrator`."""
    exposure: float
    world_from_left: FloatArray

    @classmethod
    def of(cls, world: World | XmlWorld, quality: str = "path") -> Stage:
        """Set a world up. Raises InvalidInput for what is no world or quality, Unavailable without LLVM."""
        if quality not in QUALITIES:
            raise UnknownName("quality", str(quality), QUALITIES)
        if isinstance(world, World) and quality == "fast":
            scene, integrator, exposure = fast_scene(world), fast_integrator(world), world.fast_exposure
        elif isinstance(world, World):
            scene, integrator, exposure = path_scene(world), _path_integrator(), world.exposure
        elif isinstance(world, XmlWorld):
            # Such a scene has lights of any kind: its fast picture is Mitsuba's direct light.
            integrator = _path_integrator() if quality == "path" else mitsuba().load_dict({"type": "direct"})
            scene, exposure = world.scene, world.exposure
        else:
            raise InvalidInput(f"world is {type(world).__name__}; expected a World, or one of xml_world")
        return cls(scene, integrator, exposure, world.world_from_left)

    def photograph(self, rig: Rig, *, seed: int = 0, spp: int = 64) -> StereoPair:
        """The images of a rig, see `render_pair`."""
        _check(rig, seed, spp)
        left, right = (
            self._image(load_sensor(camera, pose), _camera_seed(seed, side), spp)
            for side, (camera, pose) in enumerate(posed_cameras(rig, self.world_from_left))
        )
        return StereoPair(left, right)

    def survey(self, rig: Rig) -> Truth:
        """The truth about a rig; the same at every quality."""
        return trace_truth(self.scene, rig, self.world_from_left)

    def survey_rectified(self, rect: Rectification) -> RectifiedTruth:
        """The truth about the rectified left image, for a rectification of the true rig."""
        return trace_rectified(self.scene, rect, self.world_from_left)

    def _image(self, sensor: Any, seed: int, spp: int) -> Image:
        brightest = BRIGHTEST / self.exposure
        linear = radiance(self.scene, sensor, self.integrator, spp=spp, seed=seed, brightest=brightest)
        return srgb8(linear, self.exposure)


def _path_integrator() -> Any:
    return mitsuba().load_dict({"type": "path", "max_depth": PATH_DEPTH})


def _camera_seed(seed: int, side: int) -> int:
    return int(np.random.SeedSequence([seed, side]).generate_state(1)[0])


def _check(rig: object, seed: object, spp: object) -> None:
    if not isinstance(rig, Rig):
        raise InvalidInput(f"rig is {type(rig).__name__}; expected a Rig")
    if isinstance(seed, bool) or not isinstance(seed, Integral) or seed < 0:
        raise InvalidInput(f"{argument('seed')} is {seed!r}; expected a whole number from 0")
    whole = isinstance(spp, Integral) and not isinstance(spp, bool)
    if not whole or not 1 <= spp <= MOST_SAMPLES or spp & (spp - 1):  # type: ignore[operator]
        raise InvalidInput(f"{argument('spp')} is {spp!r}; expected a power of two from 1 to {MOST_SAMPLES}")
