"""Two calibrated cameras, how they stand, how surely, and how they are saved. Imports cameras and below."""

from rectbench.rigs.covariance import RigCovariance
from rectbench.rigs.motions import MOTIONS, Motion
from rectbench.rigs.poses import POSES, PoseNoise, perturb
from rectbench.rigs.rig import Rig
from rectbench.rigs.saving import written_formats

__all__ = [
    "MOTIONS",
    "POSES",
    "Motion",
    "PoseNoise",
    "Rig",
    "RigCovariance",
    "perturb",
    "written_formats",
]
