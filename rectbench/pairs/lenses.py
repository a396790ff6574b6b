"""A pair of lenses: a rig and how its cameras stand, without a scene, for what needs no image."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NoReturn

import numpy as np

from rectbench.errors import InvalidInput
from rectbench.images.stereo_pair import StereoPair
from rectbench.pairs.pair import Pair
from rectbench.pairs.rendering import calibrated_rig, placed
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.pairs.spec import LensSpec
from rectbench.plugins.rectifier import matches_from_pose
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.store.keys import Inputs, code_digest, versions
from rectbench.types import Matches

ONE_POSE = 0
"""The seed of every motion: a rig and a motion are one pair, whatever its seed draws beside."""


@dataclass(frozen=True, eq=False)
class LensPair(Pair):
    """Two lenses that look at nothing: their poses are known exactly, and nobody renders them.

    The seed draws what a method is told wrongly, its pose and its matches, and no motion.
    """

    spec: LensSpec
    knows_truth = True

    @cached_property
    def rig(self) -> Rig:
        spec = self.spec
        return placed(calibrated_rig(spec), spec.scene, spec.motion, ONE_POSE, spec.image_width)

    @cached_property
    def inputs(self) -> Inputs:
        return {
            "lenses": rig_numbers(self.rig),
            "motion": self.spec.motion,
            "seed": self.spec.seed,
            "code": code_digest(__name__),
            "versions": dict(versions("numpy", "scipy")),
        }

    @property
    def image_inputs(self) -> Inputs:
        """Those of the rig: there are no images."""
        return self.inputs

    @cached_property
    def images(self) -> StereoPair:
        """Raises InvalidInput."""
        self._refuse("images")

    @cached_property
    def truth(self) -> Truth:
        """Raises InvalidInput."""
        self._refuse("truth")

    def features(self, *, by_estimate: bool) -> Matches:
        """Raises InvalidInput."""
        self._refuse("images")

    def shown_matches(self) -> Matches:
        """Raises InvalidInput."""
        self._refuse("images")

    def noisy_matches(self, count: int, noise_px: float) -> Matches:
        """Of points at 5 to 200 baselines all over the view, for want of a scene."""
        rng = np.random.default_rng(self.seed_of("matches"))
        exact = matches_from_pose(self.rig, count)
        return Matches(*(pixels + rng.normal(0.0, noise_px, pixels.shape) for pixels in exact))

    def require(self) -> None:
        """Nothing: there is nothing beside the rig."""

    def forget(self) -> None:
        """Nothing is kept."""

    def _refuse(self, what: str) -> NoReturn:
        pair = f"{self.spec.rig}, {self.spec.motion}"
        raise InvalidInput(f"the lenses {pair} have no {what}: nothing is rendered; expected a scene")
