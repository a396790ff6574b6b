"""A pair: a rig, what it saw, and all that is known of both."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from rectbench.errors import InvalidInput, PoseNotFound
from rectbench.images.stereo_pair import StereoPair
from rectbench.margin import MARGIN_DEG
from rectbench.matching import BoardMatches, PoseEstimate, board_matches
from rectbench.metrics.row_error import SCORED_MATCHES
from rectbench.metrics.timing import warm_seconds
from rectbench.pairs.estimating import estimate_inputs, estimate_pose, load_estimate, save_estimate
from rectbench.pairs.spec import ESTIMATED, PairSpec
from rectbench.plugins.matches import true_noise_px
from rectbench.rendering.truth import Truth
from rectbench.rigs import Rig
from rectbench.rigs.poses import POSES, perturb
from rectbench.scored import ScoredView, SeenView
from rectbench.store.keys import Inputs, derived_seed
from rectbench.store.store import Store
from rectbench.types import Matches

POSES_KIND = "poses"
NUMBERS, REASON = "pose.npz", "reason.json"


@dataclass(frozen=True, eq=False)
class Pair(ABC):
    """A rig with two images of it, rendered or photographed, or with none.

    It is asked and answers: everything is found when it is first asked for, from the store where it is
    known, and kept for as long as the pair is.
    """

    spec: PairSpec
    store: Store
    knows_truth: ClassVar[bool]
    """Whether anybody knows the truth about the pair."""

    @cached_property
    @abstractmethod
    def rig(self) -> Rig:
        """The true rig; of photographs the calibrated one."""

    @property
    def margin_deg(self) -> float:
        """How near to its epipoles the view is trimmed, degrees."""
        return MARGIN_DEG if self.spec.margin_deg is None else self.spec.margin_deg

    @cached_property
    def scored_view(self) -> ScoredView:
        """The source pixels that rectifications are scored on, the same for all methods."""
        return ScoredView.of(self.rig, margin_deg=self.margin_deg)

    @cached_property
    def seen_view(self) -> SeenView:
        """What its lenses see, of which coverage is a share."""
        return SeenView.of(self.rig)

    @property
    @abstractmethod
    def inputs(self) -> Inputs:
        """All that shapes what is known of the pair beside its images: its truth, or its calibration."""

    @property
    @abstractmethod
    def image_inputs(self) -> Inputs:
        """All that shapes the images."""

    @property
    def is_made(self) -> bool:
        """Whether all that is asked of the pair is there, its files unchecked."""
        return True

    @cached_property
    @abstractmethod
    def images(self) -> StereoPair:
        """The two images. Raises InvalidInput for files that are no images of this rig."""

    @cached_property
    def truth(self) -> Truth:
        """Depth, visibility and correspondences. Raises InvalidInput for photographs."""
        raise InvalidInput(f"nobody knows the truth about the photographs of {self.spec.scene}")

    @abstractmethod
    def shown_matches(self) -> Matches:
        """Correspondences that pictures choose from, the most certain ones that are known."""

    @abstractmethod
    def features(self, *, by_estimate: bool) -> Matches:
        """SIFT matches of the images, freed of wrong ones by the true pose, or by the estimated one.

        Raises PoseNotFound where photographs tell no pose.
        """

    def given_matches(self, level: str, count: int) -> Matches:
        """What a method that works from matches is given at a level of them, see `match_level`.

        Of the images those that their pose was found from, however many these are.
        Raises PoseNotFound where the images tell no pose; InvalidInput for what the pair has not.
        """
        noise_px = true_noise_px(level)
        return self.estimate.inliers if noise_px is None else self.noisy_matches(count, noise_px)

    @abstractmethod
    def noisy_matches(self, count: int, noise_px: float) -> Matches:
        """True correspondences, up to `count`, with Gaussian noise of `noise_px` pixels on each coordinate.

        Raises InvalidInput for photographs.
        """

    @abstractmethod
    def require(self) -> None:
        """Raise InvalidInput where what every cell on the pair stands on is not there."""

    @abstractmethod
    def forget(self) -> None:
        """Drop from the store what would be made again."""

    @cached_property
    def true_matches(self) -> Matches:
        """10,000 exact correspondences, unoccluded in both images. Raises InvalidInput for photographs."""
        return Matches(*self.truth.matches(SCORED_MATCHES))

    @cached_property
    def board(self) -> BoardMatches | None:
        """The corners of a calibration board that both images show; None where they show none."""
        return board_matches(self.images.left, self.images.right)

    @cached_property
    def estimate(self) -> PoseEstimate:
        """The relative pose as the images tell it; all methods share it.

        Raises PoseNotFound, with the reason, where they tell none.
        """
        inputs = estimate_inputs(self.image_inputs)
        with self.store.making(POSES_KIND, inputs):
            folder = self.store.read(POSES_KIND, inputs)
            if folder is None:
                try:
                    estimate = self._estimated_anew()
                except PoseNotFound as failure:
                    self.store.write_text(POSES_KIND, inputs, REASON, json.dumps({"reason": str(failure)}))
                    raise
                self.store.write(POSES_KIND, inputs, lambda place: save_estimate(estimate, place / NUMBERS))
                return estimate
        if (folder / REASON).is_file():
            raise PoseNotFound(json.loads((folder / REASON).read_text(encoding="utf-8"))["reason"])
        return load_estimate(folder / NUMBERS)

    def pose_seconds(self) -> float:
        """Seconds from the two images, in memory, to their pose, warm."""
        return self._pose_seconds

    @cached_property
    def _pose_seconds(self) -> float:
        _ = self.images
        return warm_seconds(self._estimated_anew)

    def believed_rig(self, pose: str) -> Rig:
        """What a rectifier is told under a level of `pose`: the rig, perturbed, or in the estimated pose.

        Images do not tell how long a baseline is: the known length stands in an estimated rig, too.
        """
        if pose == ESTIMATED:
            return self.estimate.rig(self.rig)
        # Not named after the method: all methods of a pair are misled in the same way.
        return perturb(self.rig, POSES[pose], self.seed_of("pose", pose))

    def seed_of(self, purpose: str, *beside: str) -> int:
        """The seed of what is random about the pair for a purpose."""
        spec = self.spec
        return derived_seed(purpose, spec.scene, spec.rig, spec.motion, *beside, spec.seed)

    def _estimated_anew(self) -> PoseEstimate:
        return estimate_pose(self.rig, self.images, self.seed_of("consensus"))
