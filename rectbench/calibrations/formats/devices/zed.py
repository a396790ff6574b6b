"""Stereolabs' factory calibration of a ZED, `SN<serial>.conf`: a section a camera and resolution.

`[LEFT_CAM_HD]` has fx fy cx cy and OpenCV's k1 k2 p1 p2 k3; `[STEREO]` has `Baseline`, `TY_HD`, `TZ_HD` in
millimetres and the rotation vector `RX_HD CV_HD RZ_HD`. As Stereolabs' own zed_opencv_native.py reads it,
X_right = R X_left + (-Baseline, TY, TZ). The file holds several resolutions; the size given beside it
chooses, and is needed unless there is one alone. Pixel (0, 0) is the centre of a pixel.

Stereolabs' calibration tool for pairs of ZED X One cameras, zed-opencv-calibration, puts the coefficients,
one lens at all resolutions, into sections `[LEFT_DISTO]` and `[RIGHT_DISTO]`: k1 k2 k3 k4 of OpenCV's
fisheye, or k1 k2 p1 p2 k3 k4 k5 k6 of its pinhole, which go before those of a resolution. One resolution it
spells `4k`. Beside it writes `zed_calibration_<serial>.yml`: `Size`, `K_LEFT`, `D_LEFT` or of a fisheye
`D_LEFT_FE`, the rotation vector `R` and `T`, millimetres.
"""

from __future__ import annotations

import configparser
import re
from collections.abc import Sequence

import cv2
import numpy as np

from rectbench.calibrations.assembling import assembled, camera_of, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, one_line
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.calibrations.pose_file import read_rotation
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig

SIZES = {
    "VGA": (672, 376),
    "SVGA": (960, 600),
    "HD": (1280, 720),
    "FHD": (1920, 1080),
    "FHD1200": (1920, 1200),
    "2K": (2208, 1242),
    "QHDPLUS": (3200, 1800),
    "4K": (3840, 2160),
}
"""Width and height, in pixels, of an image of one camera at each resolution."""

FOCAL = ("fx", "fy", "cx", "cy")
DISTORTION = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
FISHEYE = ("k1", "k2", "k3", "k4")
MAX_CHARACTERS = 1 << 16
SIDES = ("LEFT", "RIGHT")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = _parsed(source)
    resolution = _resolution(file, given)
    left, right = (_read_camera(file, side, resolution) for side in SIDES)
    stereo = file.section("STEREO", "Baseline and the rotation")
    shift = [-stereo.number("baseline", "millimetres")]
    shift += [_number(stereo, axis, resolution) for axis in ("ty", "tz")]
    turn = np.array([_number(stereo, axis, resolution) for axis in ("rx", "cv", "rz")])
    T = rigid(cv2.Rodrigues(turn)[0], shift)
    return assembled(left, right, T, given, stereo.at("baseline"), source.name, unit="mm")


def _parsed(source: Source) -> Section:
    """Sections by name, in capitals, each with its keys in lower case."""
    if len(source.text) > MAX_CHARACTERS:
        raise InvalidInput(
            f"{source.path}: is larger than {MAX_CHARACTERS >> 10} KiB; expected a ZED's .conf"
        )
    parser = configparser.ConfigParser(interpolation=None, delimiters=("=",))
    try:
        parser.read_string(source.text)
    except configparser.Error as error:
        raise InvalidInput(f"{source.path}: {one_line(error)[:200]}; expected a ZED's .conf") from None
    sections = {name.upper(): dict(parser[name]) for name in parser.sections()}
    if len(sections) < len(parser.sections()):
        raise InvalidInput(f"{source.path}: has a section twice, in capitals and not; expected each once")
    return source.section(sections)


def _resolution(file: Section, given: Given) -> str:
    known = [name for name in SIZES if all(f"{side}_CAM_{name}" in file for side in SIDES)]
    fitting = [name for name in known if given.size in (None, SIZES[name])]
    if len(fitting) != 1:
        sizes = " or ".join("{}x{}".format(*SIZES[name]) for name in known)
        found = f"holds no cameras of {given.size}" if given.size else f"holds {len(known)} resolutions"
        expected = f"`{argument('size')}` {sizes or 'of one'} beside the file"
        raise InvalidInput(f"{file.file}: {found}; expected {expected}")
    return fitting[0]


def _read_camera(file: Section, side: str, resolution: str) -> Camera:
    section = file.section(f"{side}_CAM_{resolution}", "a camera")
    params = {name: section.number(name, "a number") for name in FOCAL}
    if f"{side}_DISTO" in file:
        model, coefficients = _disto(file.section(f"{side}_DISTO", "the coefficients of the lens"))
        section.knows(*DISTORTION)
    else:
        model, coefficients = "pinhole", _coefficients(section, DISTORTION)
    return camera_of(section.where, model, SIZES[resolution], params | coefficients)


def _disto(section: Section) -> tuple[str, dict[str, float]]:
    """The model of a lens at all resolutions, which only its coefficients tell, and these."""
    if {"p1", "p2"} <= section.values.keys():
        return "pinhole", _coefficients(section, DISTORTION)
    if section.values.keys() != set(FISHEYE):
        expected = "k1 k2 k3 k4 of a fisheye, or k1 k2 p1 p2 k3 k4 k5 k6"
        found = one_line(" ".join(section.values))[:60]
        raise InvalidInput(f"{section.where} has {found}; expected {expected}")
    return "kannala-brandt", _coefficients(section, FISHEYE)


def _coefficients(section: Section, names: Sequence[str]) -> dict[str, float]:
    return {name: section.number(name, "a number") for name in names if name in section}


def _number(stereo: Section, key: str, resolution: str) -> float:
    """The key's value at this resolution, or at all; what is left out is 0."""
    keys = [name for name in (f"{key}_{resolution.lower()}", key) if name in stereo]
    return stereo.number(keys[0], "a number") if keys else 0.0


FORMAT = RigFormat(
    "zed",
    "Stereolabs ZED factory calibration (.conf)",
    lambda source: bool(re.search(r"(?m)^\s*\[LEFT_CAM_", source.head)),
    _read,
)


def _read_opencv(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    size = file.size("Size", given.size)
    left, right = (_opencv_camera(file, side, size) for side in SIDES)
    T = rigid(read_rotation(file, "R"), file.array("T", "three millimetres", (3,)))
    return assembled(left, right, T, given, file.at("T"), sources[0].name, unit="mm")


def _opencv_camera(file: Section, side: str, size: tuple[int, int]) -> Camera:
    if f"D_{side}_FE" in file:
        return opencv_camera(file, f"K_{side}", f"D_{side}_FE", "fisheye", size)
    return opencv_camera(file, f"K_{side}", f"D_{side}", "pinhole", size)


OPENCV_FORMAT = RigFormat(
    "zed-opencv",
    "Stereolabs zed-opencv-calibration's zed_calibration_<serial>.yml",
    lambda source: {"Size", "K_LEFT", "K_RIGHT"} <= source.keys,
    _read_opencv,
)
