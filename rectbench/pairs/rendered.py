"""A rendered pair: made once, kept in the store, its truth known."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from rectbench.errors import Unavailable
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import match_features
from rectbench.matching.pose.consistent import SCORING_PIXELS
from rectbench.pairs.pair import Pair
from rectbench.pairs.rendering import IMAGES, TRUTH, TRUTH_FILE, Studio, calibrated_rig, placed, truth_inputs
from rectbench.pairs.spec import RenderedSpec
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.store.keys import Inputs
from rectbench.types import Matches
from rectbench.warps import centre_resolution_px

SHOWN_MATCHES = 2000
"""True correspondences that pictures choose from."""
FARTHEST_PX = 3.0
"""A feature match farther from its epipolar plane is a wrong match, not an imprecise one."""


@dataclass(frozen=True, eq=False)
class RenderedPair(Pair):
    """A rig placed in a scene; `studio` renders what the store lacks."""

    spec: RenderedSpec
    studio: Studio = field(default_factory=Studio)
    knows_truth = True

    @cached_property
    def rig(self) -> Rig:
        spec = self.spec
        return placed(calibrated_rig(spec), spec.scene, spec.motion, spec.seed, spec.image_width)

    @cached_property
    def inputs(self) -> Inputs:
        return truth_inputs(self.spec)

    @property
    def image_inputs(self) -> Inputs:
        return {**self.inputs, "quality": self.spec.quality, "spp": self.spec.spp}

    @property
    def is_made(self) -> bool:
        return all(self.store.has(kind, self._inputs_of[kind]) for kind in self.spec.demands)

    def make(self) -> None:
        """Render what is asked of the pair and the store lacks; one process at a time makes one pair."""
        self._make(self.spec.demands)

    @cached_property
    def images(self) -> StereoPair:
        return StereoPair.load(self._folder(IMAGES))

    @cached_property
    def truth(self) -> Truth:
        return Truth.load(self._folder(TRUTH) / TRUTH_FILE)

    def shown_matches(self) -> Matches:
        return Matches(*self.truth.matches(SHOWN_MATCHES, seed=0))

    def features(self, *, by_estimate: bool) -> Matches:
        return self._features_by_estimate if by_estimate else self._features_by_truth

    @cached_property
    def _features_by_truth(self) -> Matches:
        return scored_features(self.images, self.rig)

    @cached_property
    def _features_by_estimate(self) -> Matches:
        return scored_features(self.images, self.estimate.rig(self.rig))

    def noisy_matches(self, count: int, noise_px: float) -> Matches:
        return Matches(*self.truth.matches(count, seed=self.seed_of("matches"), noise_px=noise_px))

    def require(self) -> None:
        """Nothing: what the store lacks is rendered."""

    def forget(self) -> None:
        for kind, inputs in self._inputs_of.items():
            self.store.drop(self.store.place(kind, inputs))

    @property
    def _inputs_of(self) -> dict[str, Inputs]:
        """What shapes each kind of object that the store keeps of the pair."""
        return {TRUTH: self.inputs, IMAGES: self.image_inputs}

    def _folder(self, kind: str) -> Path:
        inputs = self._inputs_of[kind]
        folder = self.store.read(kind, inputs)
        if folder is None:
            self._make([kind])
            folder = self.store.read(kind, inputs)
        if folder is None:
            raise Unavailable(f"the store at {self.store.root} does not keep what is written to it")
        return folder

    def _make(self, kinds: Collection[str]) -> None:
        with self.store.making(TRUTH, self.inputs):
            lacking = {
                kind: inputs
                for kind, inputs in self._inputs_of.items()
                if kind in kinds and self.store.read(kind, inputs) is None
            }
            if lacking:
                self.studio.render(self.spec, self.rig, self.store, lacking)


def scored_features(images: StereoPair, rig: Rig) -> Matches:
    """SIFT matches [N, 2] each within 3 px of the rig's epipolar planes.

    The distance is the angle between the right ray and the plane of the left one, times the pixels
    per radian at the centre. A rectifier never sees these matches.
    """
    found = match_features(images.left, images.right, working_pixels=SCORING_PIXELS)
    rays_left, ok_left = rig.left.unproject(found.left)
    rays_right, ok_right = rig.right.unproject(found.right)
    normals = rays_left @ rig.essential_matrix.T
    with np.errstate(invalid="ignore", divide="ignore"):
        sines = (rays_right * normals).sum(axis=-1) / np.linalg.norm(normals, axis=-1)
        near = np.abs(np.arcsin(np.clip(sines, -1, 1))) * centre_resolution_px(rig) <= FARTHEST_PX
    kept = ok_left & ok_right & near
    return Matches(found.left[kept], found.right[kept])
