"""A pair of photographs: read from their own files, with the calibration as it is."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from rectbench.calibrations import told_already
from rectbench.errors import PoseNotFound
from rectbench.images.reading import read_images, rgb8
from rectbench.images.stereo_pair import StereoPair
from rectbench.matching import agreeing_matches
from rectbench.pairs.estimating import ESTIMATING_PACKAGES
from rectbench.pairs.finding.calibrations import Calibration
from rectbench.pairs.pair import Pair
from rectbench.pairs.rig_numbers import rig_numbers
from rectbench.pairs.spec import CALIBRATED, PhotographedSpec
from rectbench.rigs import Rig
from rectbench.store.keys import Inputs, code_digest, file_digest, versions
from rectbench.types import Images, Matches


@dataclass(frozen=True, eq=False)
class PhotographedPair(Pair):
    """Two image files of a calibrated rig, about which nobody knows the truth."""

    spec: PhotographedSpec
    knows_truth = False

    @cached_property
    def rig(self) -> Rig:
        spec, files = self.spec, tuple(map(Path, self.spec.calibration))
        how = spec.model_dump(include={"size", "unit", "max_angle_deg", "cameras"})
        with told_already():  # when the photographs were found
            return Calibration(spec.rig, files, files[0].parent, **how).rig()

    @cached_property
    def inputs(self) -> Inputs:
        return {
            "photographs_of": self.spec.scene,
            "rig": rig_numbers(self.rig),
            "seed": self.spec.seed,
            "code": code_digest(__name__),
            "versions": dict(versions(*ESTIMATING_PACKAGES)),
        }

    @cached_property
    def image_inputs(self) -> Inputs:
        """The bytes of the files are among them: an edited image is another one."""
        return {**self.inputs, "images": [_digest(self.spec.left), _digest(self.spec.right)]}

    @cached_property
    def images(self) -> StereoPair:
        images = read_images(self.spec.left, self.spec.right)
        photographs = StereoPair(rgb8(images.left, "left"), rgb8(images.right, "right"))
        photographs.check(self.rig)
        return photographs

    def shown_matches(self) -> Matches:
        """The matches that agree on a pose, and the corners of a board, as far as there are any."""
        found = [Matches(np.empty((0, 2)), np.empty((0, 2)))]
        if self.board is not None:
            found.append(self.board.matches)
        with suppress(PoseNotFound):
            found.append(self._agreeing)
        return Matches(*map(np.concatenate, zip(*found, strict=True)))

    def features(self, *, by_estimate: bool) -> Matches:
        """Those that agree on the pose in the images, whatever the calibration says: it may be wrong."""
        return self._agreeing

    @cached_property
    def _agreeing(self) -> Matches:
        images = Images(self.images.left, self.images.right)
        return agreeing_matches(self.estimate, self.rig.left, self.rig.right, images)

    def believed_rig(self, pose: str) -> Rig:
        """The calibrated rig as it is, or in the pose that the images tell."""
        return self.rig if pose == CALIBRATED else super().believed_rig(pose)

    def noisy_matches(self, count: int, noise_px: float) -> Matches:
        """Raises InvalidInput, as `truth` does."""
        return Matches(*self.truth.matches(count, noise_px=noise_px))

    def require(self) -> None:
        """The images must be those of the calibration."""
        _ = self.images

    def forget(self) -> None:
        """Photographs are not made."""


def _digest(image: str) -> str | None:
    """Of the file's bytes; None where it is gone, which a cell of its own then says."""
    try:
        return file_digest(Path(image))
    except OSError:
        return None
