"""Motions: the poses of the right camera in which a rig is tried."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

SIDEWAYS_ROTATION_DEG = 2.0
"""Most that the right camera of a `sideways` rig turns about each axis."""
SIDEWAYS_SHIFT = 0.03
"""Most that it stands off the x axis in y and z, as a share of the baseline. Turn and shift together
move an epipole by less than 4 degrees."""
JITTER_DEG = 0.5
"""Most that the seed turns the right camera of the other motions about each axis."""
WIDE_FACTOR = 3.0
WIDE_LIMIT_M = 1.5
TOE_IN_DEG = 6.0
ROLL_DEG = 10.0
APART_DEG = (30, 60, 90)
"""Turns of the right camera away from the left one, about the axis that points down."""

Placing = Callable[[float, np.random.Generator], tuple[Rotation, FloatArray]]
"""From the rig's baseline in metres to the right camera's axes and centre [3], both in left coordinates."""


@dataclass(frozen=True)
class Motion:
    """A pose of the right camera relative to the left one; the two cameras stay what they are."""

    name: str
    description: str
    placing: Placing | None = field(default=None, repr=False)

    def apply(self, rig: Rig, seed: int = 0) -> Rig:
        """`rig` with its right camera so placed; the seed draws the small irregularities.

        The same seed gives any two rigs the same angles and proportions.
        """
        if self.placing is None:
            return rig
        R_left_right, centre = self.placing(rig.baseline_m, seeded(self.name, seed))
        R_right_left = R_left_right.inv().as_matrix()
        return replace(rig, R_right_left=R_right_left, t_right_left=-R_right_left @ centre)


def seeded(purpose: str, seed: int) -> np.random.Generator:
    """A random generator that depends on `purpose` and `seed` alone, the same on every machine."""
    digest = hashlib.blake2b(f"{purpose}:{seed}".encode(), digest_size=16).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))


def _sideways(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
    turned = rng.uniform(-SIDEWAYS_ROTATION_DEG, SIDEWAYS_ROTATION_DEG, 3)
    direction = np.array([1.0, *rng.uniform(-SIDEWAYS_SHIFT, SIDEWAYS_SHIFT, 2)])
    centre: FloatArray = baseline_m * direction / np.linalg.norm(direction)
    return Rotation.from_rotvec(turned, degrees=True), centre


def _wide(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
    return _sideways(max(baseline_m, min(WIDE_FACTOR * baseline_m, WIDE_LIMIT_M)), rng)


def _toed_in(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
    return Rotation.from_euler("y", -TOE_IN_DEG, degrees=True) * _jitter(rng), _along_x(baseline_m)


def _rolled(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
    return Rotation.from_euler("z", ROLL_DEG, degrees=True) * _jitter(rng), _along_x(baseline_m)


def _towards(*direction: float) -> Placing:
    """The right camera stands in that direction from the left one, and looks where that looks."""
    unit = np.array(direction) / np.linalg.norm(direction)

    def placing(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
        return _jitter(rng), baseline_m * unit

    return placing


def _apart(angle_deg: float) -> Placing:
    def placing(baseline_m: float, rng: np.random.Generator) -> tuple[Rotation, FloatArray]:
        return Rotation.from_euler("y", angle_deg, degrees=True) * _jitter(rng), _along_x(baseline_m)

    return placing


def _jitter(rng: np.random.Generator) -> Rotation:
    return Rotation.from_rotvec(rng.uniform(-JITTER_DEG, JITTER_DEG, 3), degrees=True)


def _along_x(baseline_m: float) -> FloatArray:
    return np.array([baseline_m, 0.0, 0.0])


MOTIONS = {
    motion.name: motion
    for motion in (
        Motion("as-calibrated", "the rig's own pose"),
        Motion(
            "sideways",
            f"along x nearly, turned by up to {SIDEWAYS_ROTATION_DEG:g} degrees about each axis and shifted "
            f"off it by up to {SIDEWAYS_SHIFT:.0%} of the baseline, as in the paper",
            _sideways,
        ),
        Motion(
            "wide",
            f"like sideways with {WIDE_FACTOR:g} times the baseline, {WIDE_LIMIT_M:g} m at most",
            _wide,
        ),
        Motion("toed-in", f"the right camera turned in by {TOE_IN_DEG:g} degrees", _toed_in),
        Motion("rolled", f"the right camera rolled clockwise by {ROLL_DEG:g} degrees", _rolled),
        Motion("forward", "the right camera ahead of the left one", _towards(0.0, 0.0, 1.0)),
        Motion("backward", "the right camera behind the left one", _towards(0.0, 0.0, -1.0)),
        Motion("diagonal", "the right camera to the right and ahead, as far", _towards(1.0, 0.0, 1.0)),
        Motion("vertical", "the right camera below the left one", _towards(0.0, 1.0, 0.0)),
        *(
            Motion(f"apart-{angle}", f"the right camera turned out by {angle} degrees", _apart(angle))
            for angle in APART_DEG
        ),
    )
}
"""The motions by name."""
