"""The pair under a cell: the rig placed in its scene, rendered once and kept in the store; or photographs."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from rectbench.calibrations import load_rig
from rectbench.errors import Unavailable, UnknownName
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.photo_pairs import calibrated_rig, calibration_inputs, photo_inputs, read_photographs
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.pairs.spec import PairSpec, PhotographedSpec, RenderedSpec
from rectbench.plugins.scene import SCENES
from rectbench.registry import registry
from rectbench.rendering.truth import Truth
from rectbench.rendering.world import World
from rectbench.rendering.xml_world import XmlWorld
from rectbench.rigs import Rig
from rectbench.rigs.motions import MOTIONS
from rectbench.store.keys import Inputs, code_digest, derived_seed, versions
from rectbench.store.store import Store

if TYPE_CHECKING:
    from rectbench.rendering.pair import Stage

TRUTH, IMAGES = "truth", "images"
RENDERING_PACKAGES = ("numpy", "scipy", "opencv-contrib-python-headless", "mitsuba", "drjit")


def placed_rig(pair: PairSpec) -> Rig:
    """The true rig of a pair; of photographs the calibrated one."""
    if isinstance(pair, PhotographedSpec):
        return calibrated_rig(pair)
    return placed(load_rig(pair.rig_source), pair.scene, pair.motion, pair.seed, pair.image_width)


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


def truth_inputs(pair: PairSpec) -> Inputs:
    """All that shapes the truth of a pair; of photographs the calibration, which stands in its place."""
    if isinstance(pair, PhotographedSpec):
        return calibration_inputs(pair)
    return {
        "scene": pair.scene,
        "scene_source": registry(SCENES).get(pair.scene_source).digest,
        "rig": rig_numbers(load_rig(pair.rig_source)),
        "image_width": pair.image_width,
        "motion": pair.motion,
        "seed": pair.seed,
        "code": code_digest(__name__),
        "versions": dict(versions(*RENDERING_PACKAGES)),
    }


def image_inputs(pair: PairSpec) -> Inputs:
    """All that shapes the images of a pair."""
    if isinstance(pair, PhotographedSpec):
        return photo_inputs(pair)
    return {**truth_inputs(pair), "quality": pair.quality, "spp": pair.spp}


def is_made(pair: PairSpec, store: Store) -> bool:
    """Whether the store has all that is asked of the pair, its files unchecked."""
    if isinstance(pair, PhotographedSpec):
        return True
    return (not pair.truth or store.has(TRUTH, truth_inputs(pair))) and (
        not pair.images or store.has(IMAGES, image_inputs(pair))
    )


def make_pair(pair: RenderedSpec, store: Store) -> None:
    """Render what is asked of the pair and the store lacks; one process at a time makes one pair."""
    with store.making(TRUTH, truth_inputs(pair)):
        truth = pair.truth and store.read(TRUTH, truth_inputs(pair)) is None
        images = pair.images and store.read(IMAGES, image_inputs(pair)) is None
        if truth or images:
            _render(pair, store, truth=truth, images=images)
            give_memory_back()


def load_truth(pair: RenderedSpec, store: Store) -> Truth:
    """The truth of a pair, made first where the store lacks it."""
    return Truth.load(_folder(TRUTH, pair, store) / "truth.npz")


def load_images(pair: PairSpec, store: Store) -> StereoPair:
    """The images of a pair, made first where the store lacks them; photographs are read from their files."""
    if isinstance(pair, PhotographedSpec):
        return read_photographs(pair)
    return StereoPair.load(_folder(IMAGES, pair, store))


def _folder(kind: str, pair: RenderedSpec, store: Store) -> Path:
    inputs = truth_inputs(pair) if kind == TRUTH else image_inputs(pair)
    folder = store.read(kind, inputs)
    if folder is None:
        make_pair(pair, store)
        folder = store.read(kind, inputs)
    if folder is None:
        raise Unavailable(f"the store at {store.root} does not keep what is written to it")
    return folder


def _render(pair: RenderedSpec, store: Store, *, truth: bool, images: bool) -> None:
    stage, rig = set_stage(pair.scene_source, pair.seed, pair.quality), placed_rig(pair)
    if truth:
        exact = stage.survey(rig)
        store.write(TRUTH, truth_inputs(pair), lambda folder: exact.save(folder / "truth.npz", derived=False))
    if images:
        noise = render_seed(pair.scene, pair.rig, pair.motion, pair.seed)
        rendered = stage.photograph(rig, seed=noise, spp=pair.spp)
        store.write(IMAGES, image_inputs(pair), rendered.save)


def give_memory_back() -> None:
    """Return to the system what was freed: two workers that each keep their peak hold gigabytes idle."""
    if drjit := sys.modules.get("drjit"):
        drjit.flush_malloc_cache()
    if sys.platform == "linux":
        with suppress(AttributeError):  # a C library without it
            ctypes.CDLL(None).malloc_trim(0)


@lru_cache(maxsize=1)
def set_stage(scene_source: str, seed: int, quality: str) -> Stage:
    """A scene set up in the renderer; kept, since the rigs of one scene are rendered one after another."""
    from rectbench.rendering.pair import Stage  # needs Mitsuba; a stored pair does not

    return Stage.of(build_world(scene_source, seed), quality)


def build_world(scene_source: str, seed: int) -> World | XmlWorld:
    """The world of a scene. Raises InvalidResult where the scene returns something else."""
    return registry(SCENES).get(scene_source).value.build(seed)
