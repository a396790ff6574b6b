"""The calibration files people have: one file a format, read and written."""

from rectbench.calibrations.covariance_files import load_covariance
from rectbench.calibrations.reading import (
    calibration_formats,
    holds_many,
    is_calibration,
    load_rig,
    load_rig_of_images,
    rig_names,
)
from rectbench.calibrations.writing import save_rig, written_formats

__all__ = [
    "calibration_formats",
    "holds_many",
    "is_calibration",
    "load_covariance",
    "load_rig",
    "load_rig_of_images",
    "rig_names",
    "save_rig",
    "written_formats",
]
