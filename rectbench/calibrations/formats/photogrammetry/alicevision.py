"""Meshroom and AliceVision SfMData (cameras.sfm, sfm.json): `views`, `intrinsics`, `poses`, `rigs`.

A pose has the rotation R from world to camera, by columns, and the camera's `center` C: X_camera = R (X -
C). A view of a rig stands, by its `subPoseId`, at the rig's pose and then at the sub-pose. Pixel (0, 0) is
the centre of a pixel, as images are undistorted. The scale is arbitrary, which is told. As jsonIO.cpp reads
the versions:

| version | focal length | principal point |
|---|---|---|
| below 1.2 | `pxFocalLength`, pixels | pixels |
| 1.2.0, 1.2.1 | `pxFocalLength`, two of them | pixels; from 1.2.1 on, from the image's centre |
| from 1.2.2 | `focalLength`, mm, on `sensorWidth`; `pixelRatio` is fx/fy | from the image's centre |
| from 1.2.5 | the same; `pixelRatio` is fy/fx | from the image's centre |

| type or distortionType | here |
|---|---|
| pinhole, radial1 or radialk1, radial3 or radialk3, brown (k1 k2 k3 t1 t2) | pinhole |
| radialk3pt, divided by 1 + k1 + k2 + k3 | pinhole of so much shorter focal length |
| fisheye or fisheye4, fisheye1 | kannala-brandt, field-of-view |

Equidistant cameras, whose radius AliceVision's versions take differently, panoramas and 3DEqualizer's
undistortions are refused. The cameras are the views with poses, and go by their images' names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rectbench.calibrations.assembling import camera_of, inverse, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, errors_at
from rectbench.calibrations.formats.named_cameras import (
    by_name,
    rig_of_named,
    tell_missing,
    told_scale,
)
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

RADIAL = ("k1", "k2", "k3")
DISTORTIONS: dict[str, tuple[str, tuple[str, ...]]] = {
    "none": ("pinhole", ()),
    "radialk1": ("pinhole", RADIAL[:1]),
    "radialk3": ("pinhole", RADIAL),
    "radialk3pt": ("pinhole", RADIAL),
    "brown": ("pinhole", (*RADIAL, "p1", "p2")),
    "fisheye4": ("kannala-brandt", ("k1", "k2", "k3", "k4")),
    "fisheye1": ("field-of-view", ("omega",)),
}
TYPES = {
    "pinhole": "none",
    "radial1": "radialk1",
    "radial3": "radialk3",
    "brown": "brown",
    "fisheye": "fisheye4",
    "fisheye4": "fisheye4",
    "fisheye1": "fisheye1",
}
"""The distortion of each type, where `distortionType` does not say it."""

OF_THE_SEARCH = ("initial*", "pxInitial*", "*Locked", "locked", "distortionInitializationMode")
"""Keys of how a lens was sought, and not of what was found."""


Version = tuple[float, ...]


@dataclass(frozen=True)
class _View:
    """An image of the file: what it is called in errors, its intrinsics' number, and T_camera_world."""

    where: str
    intrinsic: str
    T_camera_world: FloatArray


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    version = tuple(file.array("version", "three numbers", (3,)).tolist())
    intrinsics = _by_number(file, "intrinsics", "intrinsicId")
    views = by_name(_views(file))

    def read(view: _View) -> PosedCamera:
        if view.intrinsic not in intrinsics:
            raise InvalidInput(f"{view.where} has no intrinsics in the file; expected intrinsicId of some")
        camera = _camera(intrinsics[view.intrinsic], version, given)
        return PosedCamera(view.where, camera, inverse(view.T_camera_world))

    return rig_of_named(source, views, read, given, told_scale(source.path, given))


def _by_number(file: Section, what: str, key: str) -> dict[str, Section]:
    entries = file.section_of_list(what)
    sections = [entries.section(place, "an entry") for place in entries.values]
    return {_number(section, key): section for section in sections}


def _number(section: Section, key: str) -> str:
    """A number that only tells entries apart, and may have more digits than a float."""
    value = section.values.get(key, "")
    return f"{value:.0f}" if isinstance(value, float) else str(value)


def _views(file: Section) -> list[tuple[str, _View]]:
    """The views that have a pose, by their images."""
    poses, rigs = _by_number(file, "poses", "poseId"), _by_number(file, "rigs", "rigId")
    found = []
    for number, view in _by_number(file, "views", "viewId").items():
        pose = poses.get(_number(view, "poseId"))
        if pose is None:
            continue
        T = _transform(pose.section("pose", "a pose").section("transform", "rotation and center"))
        is_of_rig = "rigId" in view and str(view.values.get("isPoseIndependant", "true")).lower() in "false0"
        if "rigId" in view:
            tell_missing(view, ["isPoseIndependant"], "true, so that the view's pose is its own")
        if is_of_rig:
            T = _sub_pose(view, rigs) @ T
        elif "subPoseId" in view and "rigId" not in view:
            raise view.fault("rigId", "the rig of its subPoseId")
        path = str(view.values.get("path") or number)
        found.append((path, _View(view.where, _number(view, "intrinsicId"), T)))
    return found


def _sub_pose(view: Section, rigs: dict[str, Section]) -> FloatArray:
    rig = rigs.get(_number(view, "rigId"))
    if rig is None:
        raise view.fault("rigId", "a rig of the file")
    place = int(view.number("subPoseId", "a place in the rig"))
    return _transform(rig.item("subPoses", place, "a pose").section("pose", "rotation and center"))


def _transform(section: Section) -> FloatArray:
    """T_camera_world [4, 4] of a rotation by columns and a centre."""
    columns = section.array("rotation", "a 3x3 rotation", (9,)).reshape(3, 3)
    with errors_at(section.at("rotation")):
        R = checked_rotation(columns.T, "it")
    return rigid(R, -R @ section.array("center", "three metres", (3,)))


def _camera(section: Section, version: Version, given: Given) -> Camera:
    section.knows(*OF_THE_SEARCH)
    kind = section.choice("type", TYPES)
    distortion = section.choice("distortionType", DISTORTIONS) if "distortionType" in section else TYPES[kind]
    if distortion != TYPES[kind] and kind != "pinhole":
        raise section.fault("distortionType", f"{TYPES[kind]}, as the type {kind} has it")
    if section.values.get("undistortionType", "none") != "none" or section.values.get("undistortionParams"):
        raise section.fault("undistortionParams", "none, as rectbench has no such lens")
    size = section.sides("width", "height", given.size)
    focal = np.array(_focal(section, version, size))
    centre = section.array("principalPoint", "two pixels", (2,))
    if version >= (1, 2, 1):
        centre = centre + np.array(size) / 2
    model, names = DISTORTIONS[distortion]
    params = _coefficients(section, names)
    if distortion == "radialk3pt":
        with errors_at(section.at("distortionParams")):
            focal = focal / (1 + sum(params.values()))
    params |= dict(zip(("fx", "fy", "cx", "cy"), (*focal.tolist(), *centre.tolist()), strict=True))
    return camera_of(section.where, model, size, params)


def _coefficients(section: Section, names: tuple[str, ...]) -> dict[str, float]:
    stated = section.values.get("distortionParams")
    if not names and not stated:
        return {}
    expected = f"{len(names)} coefficients ({' '.join(names)})"
    numbers = section.array("distortionParams", expected, (len(names),))
    return dict(zip(names, numbers.tolist(), strict=True))


def _focal(section: Section, version: Version, size: tuple[int, int]) -> tuple[float, float]:
    """fx and fy, pixels."""
    if version < (1, 2, 2):
        both = section.array("pxFocalLength", "one or two numbers of pixels", (1, 2)).tolist()
        return both[0], both[-1]
    tell_missing(section, ["sensorWidth"], "36 mm")
    tell_missing(section, ["pixelRatio"], "1")
    sensor = section.number("sensorWidth", "mm") if "sensorWidth" in section else 36.0
    if not sensor > 0:
        raise section.fault("sensorWidth", "mm above 0")
    fx = section.number("focalLength", "mm") / sensor * size[0]
    ratio = section.number("pixelRatio", "a number above 0") if "pixelRatio" in section else 1.0
    if not ratio > 0:
        raise section.fault("pixelRatio", "a number above 0")
    return fx, fx * ratio if version >= (1, 2, 5) else fx / ratio


FORMAT = RigFormat(
    "alicevision",
    "Meshroom and AliceVision SfMData (JSON)",
    lambda source: {"version", "views", "intrinsics"} <= source.keys,
    _read,
    has_many=True,
)
