"""Two calibrated cameras and their pose; the calibration files people have; motions and pose noise."""

from rectbench.rigs.covariance import RigCovariance
from rectbench.rigs.covariance_files import load_covariance
from rectbench.rigs.loading import (
    calibration_formats,
    holds_many,
    is_calibration,
    load_rig,
    load_rig_of_images,
    rig_names,
)
from rectbench.rigs.motions import MOTIONS, Motion
from rectbench.rigs.poses import POSES, PoseNoise, perturb
from rectbench.rigs.rig import Rig
from rectbench.rigs.saving import save_rig, written_formats

__all__ = [
    "MOTIONS",
    "POSES",
    "Motion",
    "PoseNoise",
    "Rig",
    "RigCovariance",
    "calibration_formats",
    "holds_many",
    "is_calibration",
    "load_covariance",
    "load_rig",
    "load_rig_of_images",
    "perturb",
    "rig_names",
    "save_rig",
    "written_formats",
]
