"""Rendering a pair: the rig placed in its scene, what shapes images and truth, and making them."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING

from rectbench.calibrations import load_rig
from rectbench.errors import UnknownName
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.pairs.spec import LensSpec, RenderedSpec
from rectbench.plugins.scene import SCENES
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.rigs.motions import MOTIONS
from rectbench.store.keys import Inputs, code_digest, derived_seed, versions
from rectbench.store.store import Store

if TYPE_CHECKING:
    from rectbench.rendering.pair import Stage

TRUTH, IMAGES, TRUTH_FILE = "truth", "images", "truth.npz"
"""Kinds of the store, as `RenderedSpec.demands` calls them, and the file of the one."""
RENDERING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless", "mitsuba", "drjit")


def calibrated_rig(spec: RenderedSpec | LensSpec) -> Rig:
    """The rig that is meant, as its file states it but for an image circle that is stated beside it."""
    rig = load_rig(spec.rig_source)
    return rig if spec.max_angle_deg is None else rig.within(spec.max_angle_deg)


def placed(rig: Rig, scene: str, motion: str, seed: int, image_width: int | None) -> Rig:
    """A rig scaled to `image_width` pixels, its right camera moved as the motion says.

    Raises UnknownName for a motion that does not exist.
    """
    if motion not in MOTIONS:
        raise UnknownName("motion", motion, MOTIONS)
    if image_width is not None:
        rig = rig.scaled(image_width / rig.left.width)
    return MOTIONS[motion].apply(rig, derived_seed("motion", scene, rig.name, motion, seed))


def render_seed(scene: str, rig: str, motion: str, seed: int) -> int:
    """The seed of the noise in the images of a pair."""
    return derived_seed("render", scene, rig, motion, seed)


def truth_inputs(spec: RenderedSpec) -> Inputs:
    """All that shapes the truth of a pair."""
    return {
        "scene": spec.scene,
        "scene_source": registry(SCENES).get(spec.scene_source).digest,
        "rig": rig_numbers(calibrated_rig(spec)),
        "image_width": spec.image_width,
        "motion": spec.motion,
        "seed": spec.seed,
        "code": code_digest(__name__),
        "versions": dict(versions(*RENDERING_PACKAGES)),
    }


class Studio:
    """Where pairs are rendered. It keeps the last scene set up, since its rigs come one after another."""

    def __init__(self) -> None:
        self._scene: tuple[str, int, str] | None = None
        self._stage: Stage | None = None

    def stage(self, scene_source: str, seed: int, quality: str) -> Stage:
        """The scene of this name or file, set up in the renderer."""
        from rectbench.rendering.pair import Stage  # needs Mitsuba; a stored pair does not

        if self._stage is None or self._scene != (scene_source, seed, quality):
            self._stage = None  # two scenes at once are gigabytes
            world = registry(SCENES).get(scene_source).value.build(seed)
            self._scene, self._stage = (scene_source, seed, quality), Stage.of(world, quality)
        return self._stage

    def render(self, spec: RenderedSpec, rig: Rig, store: Store, wanted: Mapping[str, Inputs]) -> None:
        """Render the wanted kinds, truth or images, of the placed `rig` into the store under their inputs."""
        stage = self.stage(spec.scene_source, spec.seed, spec.quality)
        if TRUTH in wanted:
            exact = stage.survey(rig)
            store.write(TRUTH, wanted[TRUTH], lambda folder: exact.save(folder / TRUTH_FILE, derived=False))
        if IMAGES in wanted:
            noise = render_seed(spec.scene, spec.rig, spec.motion, spec.seed)
            store.write(IMAGES, wanted[IMAGES], stage.photograph(rig, seed=noise, spp=spec.spp).save)
        give_memory_back()


def give_memory_back() -> None:
    """Return to the system what was freed: two workers that each keep their peak hold gigabytes idle."""
    if drjit := sys.modules.get("drjit"):
        drjit.flush_malloc_cache()
    if sys.platform == "linux":
        with suppress(AttributeError):  # a C library without it
            ctypes.CDLL(None).malloc_trim(0)
