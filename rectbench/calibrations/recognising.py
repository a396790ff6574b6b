"""Which format a file is of, by its content."""

from __future__ import annotations

import os

from rectbench.calibrations import pose_file
from rectbench.calibrations.contract import CameraFormat, RigFormat
from rectbench.calibrations.documents import Source
from rectbench.errors import InvalidInput
from rectbench.registry import registry
from rectbench.rigs.file_formats import FORMATS


def formats() -> list[RigFormat | CameraFormat]:
    """Every format, in the order in which files are tried on them; those of one rank by name."""
    found = [plugin.value for plugin in registry(FORMATS).plugins()]
    return sorted((one for one in found if isinstance(one, RigFormat | CameraFormat)), key=_rank)


def _rank(format: RigFormat | CameraFormat) -> int:
    """Whole rigs, then single cameras, then what has no mark of its own."""
    if isinstance(format, CameraFormat):
        return 1
    return 2 if format.shares_keys else 0


def calibration_formats() -> dict[str, str]:
    """The calibration formats that are read: name and what it is."""
    return {format.name: format.title for format in formats()}


def camera_format(source: Source) -> CameraFormat | None:
    """The format of a file of one camera; None for any other file."""
    cameras = (format for format in formats() if isinstance(format, CameraFormat))
    return next((format for format in cameras if format.recognises(source)), None)


def is_known(source: Source) -> bool:
    """Whether a file holds a calibration, or the pose beside the files of two cameras."""
    return any(format.recognises(source) for format in formats()) or pose_file.recognises(source)


def is_calibration(path: str | os.PathLike[str]) -> bool:
    """Whether a file holds a calibration, or a part of one, by its content; False for what cannot be read."""
    try:
        return is_known(Source.read(path))
    except InvalidInput:
        return False


def holds_many(path: str | os.PathLike[str]) -> bool:
    """Whether a file is of a format that may hold more than two cameras, which `cameras=` chooses from."""
    try:
        source = Source.read(path)
    except InvalidInput:
        return False
    many = (format for format in formats() if isinstance(format, RigFormat) and format.has_many)
    return any(format.recognises(source) for format in many)
