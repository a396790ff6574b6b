"""The rig JSON of Facebook's Surround 360 and facebook360_dep: `cameras`, each with its axes in the rig.

A camera looks along `forward`, with `right` and `up` beside it, from `origin`. A pixel is `principal` +
`focal` · (the sensor's x right, y up), focal's second number being negative; the image reaches from 0 to
`resolution`, so (0.5, 0.5) is the centre of the top-left pixel. The radius r of FTHETA is θ, of RECTILINEAR
tan θ, of EQUISOLID 2 sin(θ/2), of ORTHOGRAPHIC sin θ; `distortion` makes it r + d0 r³ + d1 r⁵ + d2 r⁷, and
`fov` is the angle from the axis where the image circle ends, radians (facebook360_dep, Camera.h).

| type | here |
|---|---|
| FTHETA, RECTILINEAR | kannala-brandt, pinhole |
| EQUISOLID, ORTHOGRAPHIC without distortion | equisolid, orthographic |

Origins are metres in facebook360_dep and centimetres in Surround 360, which a file does not tell: a
baseline beyond a metre is taken to be in centimetres, and told.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from rectbench.calibrations.assembling import camera_of, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, errors_at
from rectbench.calibrations.formats.named_cameras import by_name, rig_of_named, told_unit
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

TYPES = {
    "FTHETA": ("kannala-brandt", ("k1", "k2", "k3")),
    "RECTILINEAR": ("pinhole", ("k1", "k2", "k3")),
    "EQUISOLID": ("equisolid", ()),
    "ORTHOGRAPHIC": ("orthographic", ()),
}
KEYS = (
    *("version", "type", "id", "group", "origin", "right", "up", "forward"),
    *("principal", "focal", "resolution", "distortion", "fov"),
)
MARKS = {"type", "origin", "right", "up", "forward", "focal"}
LONGEST_BASELINE_M = 1.0
"""Between two cameras of such a rig; what is longer is rather centimetres."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    entries = source.document.section_of_list("cameras")
    sections = [entries.section(place, "a camera") for place in entries.values]
    cameras = by_name((section.text("id", "the camera's name"), section) for section in sections)
    unit = _unit(source, list(cameras.values()), given)
    return rig_of_named(source, cameras, lambda section: _read_posed(section, given), given, unit)


def _unit(source: Source, cameras: list[Section], given: Given) -> str:
    """By the longest of the distances between the file's cameras and the first of them."""
    origins = np.array([camera.numbers("origin", "three metres", 3) for camera in cameras])
    with np.errstate(over="ignore", invalid="ignore"):
        distance = float(np.linalg.norm(origins - origins[:1], axis=-1).max(initial=0.0))
    return told_unit(f"{source.path}: origin", distance, LONGEST_BASELINE_M, "cm", given)


def _read_posed(section: Section, given: Given) -> PosedCamera:
    section.only(KEYS)
    model, names = TYPES[section.choice("type", TYPES)]
    size = section.size("resolution", given.size)
    fx, fy = section.numbers("focal", "two focal lengths, pixels", 2)
    if not fy < 0:
        raise section.fault("focal", "[fx, -fy], as y is up on the sensor")
    cx, cy = section.numbers("principal", "two pixels", 2) if "principal" in section else np.array(size) / 2
    params = {"fx": fx, "fy": -fy, "cx": cx - 0.5, "cy": cy - 0.5} | _distortion(section, names)
    angle = math.degrees(section.number("fov", "radians")) if "fov" in section else None
    camera = camera_of(section.where, model, size, params, angle)
    R_camera_rig = _rotation(section)
    origin = section.numbers("origin", "three metres", 3)
    return PosedCamera(section.where, camera, rigid(R_camera_rig.T, origin))


def _distortion(section: Section, names: Sequence[str]) -> dict[str, Any]:
    if "distortion" not in section:
        return {}
    numbers = section.array("distortion", "up to three coefficients", (0, 1, 2, 3)).tolist()
    if any(numbers[len(names) :]):
        raise InvalidInput(f"{section.at('distortion')} is on a lens that rectbench has without; expected 0")
    return dict(zip(names, numbers, strict=False))


def _rotation(section: Section) -> FloatArray:
    """R_camera_rig [3, 3], of a camera with x right, y down, z forward."""
    right, up, forward = (section.numbers(key, "a unit vector", 3) for key in ("right", "up", "forward"))
    with errors_at(f"{section.at('right')}, up, forward"):
        return checked_rotation(np.array([right, [-number for number in up], forward]), "it")


def _recognises(source: Source) -> bool:
    cameras = source.document.values.get("cameras") if "cameras" in source.keys else None
    return isinstance(cameras, list) and any(
        isinstance(camera, dict) and camera.keys() >= MARKS for camera in cameras
    )


FORMAT = RigFormat(
    "facebook360", "Facebook Surround 360 and facebook360_dep rig (JSON)", _recognises, _read, has_many=True
)
