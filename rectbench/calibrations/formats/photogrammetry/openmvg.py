"""OpenMVG's `sfm_data.json`: `views`, `intrinsics` and `extrinsics`, as cereal writes them.

A pose has the rotation R from world to camera, by rows, and the camera's `center` C: X_camera = R (X - C).
A view names its image, intrinsics and pose. What is polymorphic has its name where the class comes first,
later the number alone. Pixel (0, 0) is the centre of a pixel, as the images are undistorted
(Camera_undistort_image.hpp). The scale is arbitrary, which is told.

| intrinsics | here |
|---|---|
| pinhole, pinhole_radial_k1, pinhole_radial_k3, pinhole_brown_t2 (k1 k2 k3 t1 t2) | pinhole |
| fisheye | kannala-brandt |

Spherical images are refused. The cameras are the views that have poses, and go by their images' names.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rectbench.calibrations.assembling import camera_of, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.documents.entries import take
from rectbench.calibrations.formats.named_cameras import by_name, rig_of_named, told_scale
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

MODELS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "pinhole": ("pinhole", "", ()),
    "pinhole_radial_k1": ("pinhole", "disto_k1", ("k1",)),
    "pinhole_radial_k3": ("pinhole", "disto_k3", ("k1", "k2", "k3")),
    "pinhole_brown_t2": ("pinhole", "disto_t2", ("k1", "k2", "k3", "p1", "p2")),
    "fisheye": ("kannala-brandt", "fisheye", ("k1", "k2", "k3", "k4")),
}
"""Projection model, and the key and names of the coefficients, of each class of intrinsics."""

LENS = ("width", "height", "focal_length", "principal_point")
FIRST = 1 << 31
"""Added to the number of a class where its name stands beside it."""

BASE = "value"
"""What cereal calls the parts that a class has from its bases: value0, value1, ..."""


@dataclass(frozen=True)
class _View:
    """An image of the file: its intrinsics and its pose, each by its number."""

    where: str
    intrinsic: float
    pose: float


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    names = _class_names(file)
    poses, intrinsics = _by_key(file, "extrinsics"), _by_key(file, "intrinsics")
    views = by_name((name, view) for name, view in _views(file) if view.pose in poses)

    def read(view: _View) -> PosedCamera:
        pose = poses[view.pose].section("value", "rotation and center")
        R = pose.rotation("rotation", "the rotation from world to camera")
        C = pose.numbers("center", "three metres", 3)
        if view.intrinsic not in intrinsics:
            raise InvalidInput(f"{view.where} has no intrinsics in the file; expected id_intrinsic of some")
        return PosedCamera(view.where, _camera(intrinsics[view.intrinsic], names, given), rigid(R.T, C))

    return rig_of_named(source, views, read, given, told_scale(source.path, given))


def _views(file: Section) -> list[tuple[str, _View]]:
    found = []
    for entry in _by_key(file, "views").values():
        data = _data(entry)
        name = data.text("filename", "the image's name")
        intrinsic, pose = (data.number(f"id_{what}", "a number") for what in ("intrinsic", "pose"))
        found.append((name, _View(data.where, intrinsic, pose)))
    return found


def _by_key(file: Section, what: str) -> dict[float, Section]:
    """The entries {key, value} of a map, by their keys."""
    entries = file.section_of_list(what)
    sections = [entries.section(place, "a key and a value") for place in entries.values]
    return {section.number("key", "a number"): section for section in sections}


def _class_names(file: Section) -> dict[float, str]:
    """The names of the classes of intrinsics by their numbers."""
    names: dict[float, str] = {}
    for entry in _by_key(file, "intrinsics").values():
        value = entry.section("value", "intrinsics")
        if "polymorphic_name" in value:
            number = value.number("polymorphic_id", "a number")
            names[number] = names[number - FIRST] = value.text("polymorphic_name", ", ".join(MODELS))
    return names


def _data(entry: Section) -> Section:
    """The object of an entry, with the keys of its bases among its own."""
    wrapper = entry.section("value", "an object").section("ptr_wrapper", "a pointer")
    data = wrapper.section("data", "an object")
    take(data.values)  # as all of its keys are looked at
    return Section(data.file, data.key, _flat(data.values))


def _flat(values: Any) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        is_base = key.startswith(BASE) and key[len(BASE) :].isdigit() and isinstance(value, dict)
        flat |= _flat(values[key]) if is_base else {key: value}
    return flat


def _camera(entry: Section, names: dict[float, str], given: Given) -> Camera:
    value = entry.section("value", "intrinsics")
    kind = names.get(value.number("polymorphic_id", "a number"), "")
    if kind not in MODELS:
        raise value.fault("polymorphic_name", ", ".join(MODELS))
    model, key, coefficients = MODELS[kind]
    data = _data(entry)
    data.only((*LENS, *((key,) if key else ())))
    focal = data.number("focal_length", "pixels")
    cx, cy = data.numbers("principal_point", "two pixels", 2)
    params = {"fx": focal, "fy": focal, "cx": cx, "cy": cy}
    if key:
        params |= data.named(key, coefficients)
    return camera_of(data.where, model, data.sides("width", "height", given.size), params)


FORMAT = RigFormat(
    "openmvg",
    "OpenMVG sfm_data (JSON)",
    lambda source: "sfm_data_version" in source.keys,
    _read,
    has_many=True,
)
