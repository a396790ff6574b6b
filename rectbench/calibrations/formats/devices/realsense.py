"""What `rs-enumerate-devices -c` prints of a RealSense, T265 and D400 alike: intrinsics and extrinsics.

A block `Intrinsic of "Fisheye 1" / 848x800 / {Y8}` has PPX, PPY, Fx, Fy and five coefficients of a
distortion; `Extrinsic from "Fisheye 1" To "Fisheye 2"` takes points of the first to the second, X_2 = R X_1
+ t, metres, printed by rows (librealsense, rs-enumerate-devices.cpp; rs2_project_point_to_pixel in
rsutil.h). Pixel (0, 0) is the centre of a pixel.

| distortion | here |
|---|---|
| None, or any of Brown and Conrady's without coefficients | pinhole |
| Brown Conrady; Modified Brown Conrady without tangential terms | pinhole k1 k2 p1 p2 k3 |
| Kannala Brandt4 | kannala-brandt |
| Ftheta | field-of-view |

Inverse Brown Conrady with coefficients, which leads from the image to the ideal plane, is refused, as are
the tangential terms of the modified one. Left and right are Fisheye 1 and 2, or Infrared 1 and 2, or the
streams asked for by their names. A stream of several sizes wants the one given beside the file.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import Pair, assembled, inverse, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, errors_at, finite_number, shown
from rectbench.calibrations.formats.devices.realsense_lens import realsense_camera, stereo_pairs
from rectbench.calibrations.formats.named_cameras import pair_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray

INTRINSIC = re.compile(r'^ ?Intrinsic of "([^"\n]{1,60})" */ *(\d{1,5})x(\d{1,5})', re.MULTILINE)
EXTRINSIC = re.compile(
    r'^ ?Extrinsic from "([^"\n]{1,60})"\s{1,40}To\s{1,40}"([^"\n]{1,60})" *:', re.MULTILINE
)
BLOCK = re.compile(
    r"^ ?(?:Motion )?(?:Intrinsic of|Extrinsic from|\w+ Extrinsic|Extrinsic Parameters)", re.MULTILINE
)
MARK = b'Intrinsic of "'
FIELDS = ("Fx", "Fy", "PPX", "PPY", "Distortion", "Coeffs")
SIZE = ("Width", "Height")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    streams = _streams(source)

    def rig_of(names: Pair) -> Rig:
        left, right = (_camera(streams[name], name, given) for name in names)
        where = f'{source.path}: Extrinsic from "{names[0]}" to "{names[1]}"'
        return assembled(left, right, _pose(source, *names), given, where, source.name, unit="m")

    return rig_of(pair_of(list(streams), stereo_pairs(streams), given, source.path, rig_of))


def _streams(source: Source) -> dict[str, list[Section]]:
    """The blocks of intrinsics by the names of their streams; equal ones, of other formats, once."""
    streams: dict[str, list[Section]] = {}
    for found in INTRINSIC.finditer(source.text):
        name = found[1]
        key = f'Intrinsic of "{name}" / {found[2]}x{found[3]}: '
        section = Section(source.path, key, _fields(_block(source.text, found.end())))
        if not section.values:
            continue  # Intrinsic NOT available
        known = streams.setdefault(name, [])
        if all(section.values != other.values for other in known):
            known.append(section)
    return streams


def _block(text: str, start: int) -> str:
    """The text from there to the next block."""
    following = BLOCK.search(text, start)
    return text[start : following.start() if following else len(text)]


def _fields(block: str) -> dict[str, str | list[str]]:
    values: dict[str, str | list[str]] = {}
    for line in block.splitlines():
        key, colon, words = line.strip().partition(":")
        if colon and key in (*SIZE, *FIELDS):
            values[key] = words.split() if key == "Coeffs" else " ".join(words.split())
    return values


def _camera(blocks: list[Section], name: str, given: Given) -> Camera:
    fitting = [block for block in blocks if given.size in (None, _size(block))]
    if len(fitting) != 1:
        sizes = ", ".join("{}x{}".format(*_size(block)) for block in blocks)
        file = blocks[0].file
        raise InvalidInput(
            f'{file}: "{name}" has {len(fitting)} intrinsics'
            f"{' of that size' if given.size else ''}; expected `{argument('size')}` one of {sizes}"
        )
    section = fitting[0]
    return realsense_camera(section, FIELDS, _size(section))


def _size(section: Section) -> tuple[int, int]:
    return section.sides(*SIZE, None)


def _pose(source: Source, left: str, right: str) -> FloatArray:
    """T_right_left [4, 4], metres."""
    for found in EXTRINSIC.finditer(source.text):
        if {found[1], found[2]} == {left, right} and left != right:
            T = _transformation(source, found)
            return T if found[1] == left else inverse(T)
    raise InvalidInput(f'{source.path}: has no Extrinsic from "{left}" to "{right}"; expected one')


def _transformation(source: Source, found: re.Match[str]) -> FloatArray:
    where = f'{source.path}: Extrinsic from "{found[1]}" to "{found[2]}"'
    rotation, colon, translation = _block(source.text, found.end()).partition("Translation Vector:")
    words = [*rotation.replace("Rotation Matrix:", "").split(), *translation.split()[:3]]
    numbers = [number for word in words if (number := finite_number(word)) is not None]
    if not colon or len(words) != 12 or len(numbers) != 12:
        raise InvalidInput(f"{where} is {shown(' '.join(words))}; expected a 3x3 rotation and a translation")
    with errors_at(where):
        R = checked_rotation(np.reshape(numbers[:9], (3, 3)), "its rotation")
    return rigid(R, numbers[9:])


FORMAT = RigFormat(
    "realsense",
    "Intel RealSense, as rs-enumerate-devices -c prints it",
    lambda source: MARK in source.content,
    _read,
    has_many=True,
)
