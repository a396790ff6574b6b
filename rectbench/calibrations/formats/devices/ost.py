"""The INI of ROS' camera_calibration, `ost.txt` or `.ini`, of one camera, or of a pair one after the other.

Labels stand alone in a line, such as `camera matrix`, above their numbers. Of a pair the first camera is the
left one. What the numbers mean, and where the pose is, `formats.devices.ros` says; the distortion is
plumb_bob, or rational_polynomial where there are eight coefficients.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rectbench.calibrations.assembling import rig_of_posed, single
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.devices.ros import posed_of
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

LABELS = {
    "width": "image_width",
    "height": "image_height",
    "camera matrix": "camera_matrix",
    "distortion": "distortion_coefficients",
    "rectification": "rectification_matrix",
    "projection": "projection_matrix",
}
"""The labels, and what the YAML of ROS calls the same."""

MAX_LINES = 500


def _read_posed(source: Source, given: Given) -> PosedCamera:
    return _posed(source, given)[0]


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    posed = _posed(source, given)
    if len(posed) != 2:
        raise InvalidInput(f"{source.path}: holds {len(posed)} cameras; expected two, left and right")
    return rig_of_posed(posed, given, source.name)


def _posed(source: Source, given: Given) -> list[PosedCamera]:
    """The cameras of the file in its order; one ends where a label comes that it has already."""
    cameras: list[dict[str, list[str]]] = [{}]
    numbers: list[str] = []
    lines = source.text.splitlines()
    if len(lines) > MAX_LINES:
        raise InvalidInput(f"{source.path}: has {len(lines)} lines; expected the INI of camera_calibration")
    for line in lines:
        label = LABELS.get(line.strip())
        if label is None:
            words = [] if line.lstrip().startswith(("#", "[")) else line.split()
            numbers += words
            continue
        if label in cameras[-1]:
            cameras.append({})
        numbers = cameras[-1][label] = []
    return [posed_of(_camera(source, place, values), given) for place, values in enumerate(cameras)]


def _camera(source: Source, place: int, values: dict[str, list[str]]) -> Section:
    sides = {key: words[0] for key, words in values.items() if key.startswith("image_") and len(words) == 1}
    model = {"distortion_model": "plumb_bob"}
    return source.section(values | sides | model, f"camera {place + 1}: " if place else "")


def _count(source: Source) -> int:
    """How many cameras the head of the file has; the YAML of ROS has no such labels."""
    return len(re.findall(r"(?m)^projection[ \t\r]*$", source.head)) if "camera matrix" in source.head else 0


CAMERA_FORMAT = CameraFormat(
    "ost",
    "ROS camera_calibration ost.txt or .ini (two files)",
    lambda source: _count(source) == 1,
    _read_posed,
)
FORMAT = RigFormat(
    "ost-pair",
    "ROS camera_calibration ost.txt or .ini of a stereo pair",
    lambda source: _count(source) > 1,
    _read,
)
