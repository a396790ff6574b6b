"""Two calibrated cameras and their pose; motions, pose noise, and how sure a calibration is."""

from rectbench.rigs.covariance import RigCovariance
from rectbench.rigs.motions import MOTIONS, Motion
from rectbench.rigs.poses import POSES, PoseNoise, perturb
from rectbench.rigs.rig import Rig

__all__ = [
    "MOTIONS",
    "POSES",
    "Motion",
    "PoseNoise",
    "Rig",
    "RigCovariance",
    "perturb",
]
