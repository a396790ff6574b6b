"""A RealSense's intrinsics and extrinsics as JSON, by the names that librealsense gives their parts.

The tools of librealsense write none; people dump what pyrealsense2 gives: for each stream a mapping with
`width`, `height`, `fx`, `fy`, `ppx`, `ppy`, `model` (or `distortion`, `distortion_model`) and `coeffs`, at
the top or in a section such as `intrinsics`, and mappings with a `rotation` and a `translation`, metres.
The rotation is that of rs2_extrinsics: nine numbers by columns, or a matrix of three rows. One that is
called `a_to_b`, or has `from` and `to`, takes points of a to b; any other one is taken to lead from the
first stream to the second, which is told. Fisheye 1 and 2, or Infrared 1 and 2, are left and right, unless
others are asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rectbench.calibrations.assembling import Pair, assembled, inverse, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, errors_at, one_line, tell
from rectbench.calibrations.formats.devices.realsense_lens import realsense_camera, stereo_pairs
from rectbench.calibrations.formats.named_cameras import by_name, pair_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

FOCAL = ("fx", "fy", "ppx", "ppy")
KIND = ("model", "distortion_model", "distortion")
COEFFICIENTS = ("coeffs", "coefficients", "distortion_coeffs")
SIZE = ("width", "height")
POSE = {"rotation", "translation"}
MOST_DEPTH = 4
"""Mappings inside each other in which streams are looked for."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    found = list(_mappings(source.document, "", MOST_DEPTH))
    streams = by_name((name, section) for name, section in found if _is_stream(section))
    poses = [(name, section) for name, section in found if section.values.keys() >= POSE]

    def rig_of(names: Pair) -> Rig:
        left, right = (_camera(streams[name], given) for name in names)
        order = [name for name in streams if name in names]
        where, T = _pose(source, poses, *order)
        T = T if order == list(names) else inverse(T)
        return assembled(left, right, T, given, where, source.name, unit="m")

    return rig_of(pair_of(list(streams), stereo_pairs(streams), given, source.path, rig_of))


def _mappings(section: Section, name: str, depth: int) -> Iterator[tuple[str, Section]]:
    """The mapping and those in it, by their keys; a stream's `intrinsics` go by the stream's key."""
    yield name, section
    for key, value in section.values.items() if depth else ():
        if isinstance(value, dict):
            inner = name if key == "intrinsics" and name else key
            yield from _mappings(section.section(key, "a mapping"), inner, depth - 1)


def _is_stream(section: Section) -> bool:
    return section.values.keys() >= set(FOCAL)


def _camera(section: Section, given: Given) -> Camera:
    kind = next((key for key in KIND if key in section), KIND[0])
    coefficients = next((key for key in COEFFICIENTS if key in section), COEFFICIENTS[0])
    return realsense_camera(section, (*FOCAL, kind, coefficients), section.sides(*SIZE, given.size))


def _pose(
    source: Source, poses: list[tuple[str, Section]], first: str, second: str
) -> tuple[str, FloatArray]:
    """Where the pose is, and the transformation [4, 4] from the first stream to the second."""
    for name, section in poses:
        ends = _ends(name, section)
        if ends in ((first, second), (second, first)):
            T = _transformation(section)
            return section.where, T if ends == (first, second) else inverse(T)
    if len(poses) != 1 or _ends(*poses[0]) is not None:
        raise InvalidInput(
            f"{source.path}: has no extrinsics of {first} and {second}; expected rotation and translation"
        )
    section = poses[0][1]
    tell(f"{section.where}: taken to lead from {one_line(first)} to {one_line(second)}")
    return section.where, _transformation(section)


def _ends(name: str, section: Section) -> tuple[str, str] | None:
    """The streams from which and to which extrinsics lead; None where they do not say."""
    if "from" in section and "to" in section:
        return section.text("from", "a stream"), section.text("to", "a stream")
    start, link, end = name.partition("_to_")
    return (start, end) if link else None


def _transformation(section: Section) -> FloatArray:
    numbers = section.array("rotation", "nine numbers by columns, or three rows", (9,)).reshape(3, 3)
    by_rows = any(isinstance(row, list) for row in section.values["rotation"])
    with errors_at(section.at("rotation")):
        R = checked_rotation(numbers if by_rows else np.ascontiguousarray(numbers.T), "it")
    return rigid(R, section.array("translation", "three metres", (3,)))


def _recognises(source: Source) -> bool:
    if not source.keys:
        return False
    return sum(_is_stream(section) for _, section in _mappings(source.document, "", MOST_DEPTH)) > 1


FORMAT = RigFormat(
    "realsense-json",
    "Intel RealSense intrinsics and extrinsics, as pyrealsense2 gives them (JSON)",
    _recognises,
    _read,
    has_many=True,
)
