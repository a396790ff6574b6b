"""The calibration of a Luxonis OAK camera, the JSON that depthai's `eepromToJsonFile` writes.

`cameraData` is a list of [socket, camera]. A camera's `extrinsics` take its points to the camera of
`toCameraSocket`, with a translation in centimetres; chains of them end at a camera with -1. Left and right
are those of `stereoRectificationData`, or the sockets asked for, such as CAM_B and CAM_C. `distortionCoeff`
is OpenCV's vector of 14, or of a fisheye its four; pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import Pair, chosen, rig_of_posed, rigid, single
from rectbench.calibrations.checks.consistency import compare_rotations, rotation_in
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, finite_number, tell
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

LENSES = {0: "pinhole", 1: "fisheye"}
"""`cameraType`; 2 is a panorama, 3 a radial division."""

STEREO = "stereoRectificationData"


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    source.document.knows("stereoEnableDistortionCorrection", "stereoUseSpecTranslation")  # of the device
    cameras = _cameras(source.document)
    pair = _rectified_pair(source.document)

    def rig_of(names: Pair) -> Rig:
        placed = [_to_last(cameras, name) for name in names]
        if placed[0][0] != placed[1][0]:
            first, second = (cameras[name].at("extrinsics") for name in names)
            raise InvalidInput(f"{first} and {second} end at different cameras; expected one chain of both")
        posed = [_read_posed(cameras[name], T, given) for name, (_, T) in zip(names, placed, strict=True)]
        return rig_of_posed(posed, given, source.name, unit="cm")

    if given.cameras is None and len(pair) == 2 and set(pair) <= cameras.keys():
        names = (pair[0], pair[1])
    else:
        names = chosen(list(cameras), given, source.path, rig_of)
    rig = rig_of(names)
    if list(names) == pair:
        _compare_rectification(source.document.section(STEREO, "the sockets of left and right"), rig)
    return rig


def _compare_rectification(stereo: Section, rig: Rig) -> None:
    """The rotations to the rectified frame, of the pair that the file itself rectifies, hold the pose too."""
    R1, R2 = (rotation_in(stereo, f"rectifiedRotation{side}") for side in ("Left", "Right"))
    if R1 is not None and R2 is not None:
        where = stereo.at("rectifiedRotationLeft")
        compare_rotations(where, R2.T @ R1, rig.R_right_left, "the cameras' extrinsics")


def _cameras(file: Section) -> dict[str, Section]:
    """The cameras by the names of their sockets."""
    cameras: dict[str, Section] = {}
    entries = file.section_of_list("cameraData")
    for place in entries.values:
        entry = entries.section_of_list(place)
        name = _socket(entry.number("0", "a socket's number"))
        if name in cameras:
            raise InvalidInput(f"{entry.at('0')} is {name} a second time; expected different sockets")
        cameras[name] = entry.section("1", "a camera")
    return cameras


def _socket(number: float) -> str:
    """CAM_A, the one that depthai once called RGB, is socket 0."""
    known = 0 <= number < 26 and number.is_integer()
    return f"CAM_{chr(ord('A') + int(number))}" if known else f"{number:g}"


def _rectified_pair(file: Section) -> list[str]:
    """The sockets of the left and the right camera, as far as the file names them."""
    if STEREO not in file:
        return []
    stereo = file.section(STEREO, "the sockets of left and right")
    pair = [finite_number(stereo.values.get(f"{side}CameraSocket")) for side in ("left", "right")]
    return [_socket(number) for number in pair if number is not None]


def _to_last(cameras: dict[str, Section], name: str) -> tuple[str, FloatArray]:
    """The camera at which a camera's chain ends, and the pose from it to that."""
    T = np.eye(4)
    for _ in cameras:
        extrinsics = cameras[name].section("extrinsics", "the pose to another camera")
        next_name = _socket(extrinsics.number("toCameraSocket", "a socket, or -1"))
        if next_name not in cameras:
            return name, T
        R = extrinsics.rotation("rotationMatrix")
        shift = extrinsics.section("translation", "x, y and z, centimetres")
        t = [shift.number(axis, "centimetres") for axis in "xyz"]
        T = rigid(R, t) @ T
        name = next_name
    raise InvalidInput(f"{cameras[name].at('extrinsics')} leads back to its own camera; expected an end, -1")


def _read_posed(section: Section, T: FloatArray, given: Given) -> PosedCamera:
    if "cameraType" not in section:
        tell(f"{section.at('cameraType')} is missing; taken to be 0, perspective")
    kind = section.number("cameraType", "0 or 1") if "cameraType" in section else 0
    if kind not in LENSES:
        raise section.fault("cameraType", "0 (perspective) or 1 (fisheye)")
    lens = LENSES[int(kind)]
    size = section.sides("width", "height", given.size)
    section.knows("specHfovDeg", "specTranslation", "lensPosition")  # of the data sheet, and of the focus
    camera = opencv_camera(section, "intrinsicMatrix", "distortionCoeff", lens, size, section.where)
    return PosedCamera(section.where, camera, T)


FORMAT = RigFormat(
    "depthai",
    "Luxonis OAK (depthai) calibration (JSON)",
    lambda source: "cameraData" in source.keys,
    _read,
    has_many=True,
)
