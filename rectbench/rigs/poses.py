"""Pose noise: how far the pose that a rectifier is told is off the true one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.errors import InvalidInput
from rectbench.rigs.motions import seeded
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray


@dataclass(frozen=True)
class PoseNoise:
    """An error of the pose, by its size; where it points is drawn.

    Parameters
    ----------
    rotation_deg : angle between the true and the believed right camera's axes.
    direction_deg : angle between the true and the believed baseline, in left coordinates; its length
        is believed to be what it is, for images do not tell it.

    Raises InvalidInput for an angle outside [0, 180).
    """

    rotation_deg: float
    direction_deg: float

    def __post_init__(self) -> None:
        for name in ("rotation_deg", "direction_deg"):
            angle = getattr(self, name)
            if not (math.isfinite(angle) and 0 <= angle < 180):
                raise InvalidInput(f"pose noise {name} is {angle}; expected degrees in [0, 180)")


POSES = {"exact": PoseNoise(0.0, 0.0), "perturbed": PoseNoise(rotation_deg=0.05, direction_deg=0.3)}
"""The named levels of pose noise."""


def perturb(rig: Rig, noise: PoseNoise, seed: int = 0) -> Rig:
    """`rig` as it is believed to stand: its pose off by exactly `noise`, in directions the seed draws."""
    if noise == POSES["exact"]:
        return rig
    rng = seeded("pose", seed)
    turn = Rotation.from_rotvec(noise.rotation_deg * _unit(rng.normal(size=3)), degrees=True)
    centre = rig.centre_right_in_left
    across = _unit(np.cross(centre, rng.normal(size=3)))
    believed_centre = Rotation.from_rotvec(noise.direction_deg * across, degrees=True).apply(centre)
    R_right_left = turn.as_matrix() @ rig.R_right_left
    return replace(rig, R_right_left=R_right_left, t_right_left=-R_right_left @ believed_centre)


def _unit(vector: FloatArray) -> FloatArray:
    return vector / np.linalg.norm(vector)
