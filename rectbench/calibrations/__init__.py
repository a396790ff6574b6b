"""The calibration files people have: read, recognised, assembled to rigs. Imports rigs and what is below."""

from rectbench.calibrations.built_in_rigs import rig_names
from rectbench.calibrations.covariance_files import load_covariance
from rectbench.calibrations.reading import load_rig, load_rig_of_images
from rectbench.calibrations.recognising import calibration_formats, holds_many, is_calibration

__all__ = [
    "calibration_formats",
    "holds_many",
    "is_calibration",
    "load_covariance",
    "load_rig",
    "load_rig_of_images",
    "rig_names",
]
