"""A rectification as a YAML file that anyone can read, and that is read back to the same maps.

    rectbench_rectification: 1      # this format; marks the file as one
    size: [820, 501]                # width and height of both rectified images, pixels
    baseline_m: 0.064               # x of the right camera in the rectified left frame
    rig: ...                        # the source cameras and their pose, see `calibrations.formats.native`
    left:
      R_rect_cam: ...               # 3x3, from the camera's frame to the rectified one
      target: ...                   # from rays to rectified pixels: perspective, or epipolar
    right: ...
    notes: ...                      # what the method tells of itself

What the targets mean stands in the file, as comments (`HEADER`).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rectbench.calibrations.contract import Given
from rectbench.calibrations.documents import Section, Source, errors_at, one_line, parse_document
from rectbench.calibrations.formats.native import read_fields, rig_fields
from rectbench.errors import InvalidInput, UnknownName
from rectbench.warps.fitted_profiles import Composed, PolynomialInverse
from rectbench.warps.frame import signed_baseline_m
from rectbench.warps.monotone_spline import MonotoneSpline
from rectbench.warps.planar_polar import PlanarPolar
from rectbench.warps.profiles import Cubic, FramedProfile, Profile, Radial
from rectbench.warps.rectification import Rectification
from rectbench.warps.scan_lines import ScanLines, SplineSurface
from rectbench.warps.targets import Epipolar, Framed, Perspective, Target, Wrapped
from rectbench.warps.warp import Warp
from rectbench.warps.wide.longitudes import Planospheric, Upright
from rectbench.warps.wide.prism import Prism
from rectbench.warps.wide.stereographic import EpipolarCircles, Stereographic
from rectbench.writing import write_atomically
from rectbench.yaml_text import yaml_text

MARK = "rectbench_rectification"
VERSION = "1"

HEADER = """\
# A rectified stereo pair: for each image, how a source pixel becomes a rectified one.
#
# 1. The camera's projection model, below `rig`, turns the pixel into a ray (x right, y down, z forward).
#    Pixel (0, 0) is the centre of the top-left pixel.
# 2. R_rect_cam turns the ray into the rectified frame, whose x axis is the baseline: (x, y, z).
# 3. The target maps it to the rectified pixel (u, v):
#      perspective   (u, v, 1) ~ matrix (x, y, z), where the third coordinate is above 0
#      planar-polar  matrix (x, y, z) ~ (a, b, 1) is a pixel of a plane, matrix (1, 0, 0) its epipole, and r
#                    the distance of the pixel from the epipole; with rho that of the reference pixel,
#                    u = start_px -+ (r - rho) (along: length) or start_px -+ rho log(r / rho) (logarithm),
#                    - where the third coordinate of matrix (1, 0, 0) is above 0; v of beta as below
#      epipolar      u of gamma = atan2(x, hypot(y, z)), the angle along the epipolar line, and
#                    v of beta = atan2(y, z), the angle across the lines, both in radians:
#        cubic       c0 + c1 a + c2 a^2 + c3 a^3, rising from a = low to a = high
#        radial      centre_px + focal_px r(a), r(a) = a (equidistant), 2 tan(a/2) (stereographic),
#                    2 sin(a/2) (equisolid), sin a (orthographic), tan a (cylindrical),
#                    artanh(sin a) (mercator)
#        composed    the outer profile of the inner one's value in the place of a
#        polynomial-inverse   a = q0 + q1 x + q2 x^2 + ... (the coefficients), where x goes from -1 at
#                    value_low to 1 at value_high
#        monotone-spline   value_low + the integral, from the first of the knots, of the quadratic spline
#                    with these knots and control values (slopes); the outer knots are repeated thrice
#      upright       u of the longitude atan2(x, z) and v of the latitude atan2(y, hypot(x, z)), as above
#      planospheric  u of the longitude atan2(x, z), and v of beta, where z is above 0
#      stereographic   (cx, cy) + 2 focal_px (x, y) / (1 + z) of the unit ray (x, y, z)
#      epipolar-circles   the same, where corresponding pixels lie on one circle through the images of the
#                    baseline's two directions, not on a row
#      prism         with k the whole number nearest to (beta - first_rad) / piece_rad, from 0 to pieces - 1,
#                    and d = beta - first_rad - k piece_rad: u = cx + focal_px tan(gamma) / cos(d),
#                    v = cy + focal_px (2 k tan(piece_rad / 2) + tan(d))
#      scan-lines    v of beta as above, and u of both angles, rising in gamma: the sum of
#                    coefficients[i][j] B_i(beta) N_j(gamma), cubic B-splines over as many even intervals
#                    of either range as make that many; the outer knots are repeated four times
#      wrapped       its target, whose rows go all around the baseline: beyond row start + turn, and before
#                    row start, they begin again
#
# Rows of the two images correspond: v is the same in both. Disparity is u_left - u_right. With gamma_left
# and gamma_right of two matched pixels, beta of their row and baseline_m = b (below 0 where the right
# camera stands on the left), the point lies in the left camera's rectified frame at
#   r = b / (tan gamma_left - tan gamma_right), (r tan gamma_left, r sin beta, r cos beta)
"""


def save_rectification(rect: Rectification, path: str | os.PathLike[str], **facts: Any) -> None:
    """Write a rectification's description; `facts` are plain data put first, such as the method's name.

    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> import rectbench as rb
    >>> rect = rb.rectify(rb.load_rig("t265"), method="abraham")
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder, "rectified.yaml")
    ...     rb.save_rectification(rect, file, method="abraham")
    ...     again = rb.load_rectification(file)
    >>> bool((again.maps("left")[0] == rect.maps("left")[0]).all())
    True
    """
    write_atomically(Path(path), rectification_text(rect, **facts))


def rectification_text(rect: Rectification, **facts: Any) -> str:
    """The text of that file."""
    content: dict[str, Any] = {MARK: int(VERSION), **facts, "size": list(rect.size)}
    content["baseline_m"] = signed_baseline_m(rect.rig)
    for side, warp in (("left", rect.left), ("right", rect.right)):
        content[side] = {"R_rect_cam": warp.R_rect_cam.tolist(), "target": TARGET.write(warp.target)}
    content["notes"] = {name: float(n) if isinstance(n, float) else n for name, n in rect.notes.items()}
    content["rig"] = rig_fields(rect.rig)
    return HEADER + yaml_text(content)


def load_rectification(path: str | os.PathLike[str]) -> Rectification:
    """The rectification of a file that `save_rectification` wrote, to the last bit.

    Raises InvalidInput in one line that names file, key and what was expected.

    >>> import rectbench as rb
    >>> rb.save_rectification(rb.rectify(rb.load_rig("mynteye"), "abraham"), "rectified.yaml")
    >>> rb.load_rectification("rectified.yaml").rig.name
    'mynteye'
    """
    source = Source.read(path)
    document = parse_document(source.text, source.path)
    if document.values.get(MARK) != VERSION:
        raise document.fault(MARK, f"the format's version, {VERSION}")
    size = document.size("size", None)
    rig = read_fields(document.section("rig", "the rig's cameras and pose"), Given())
    warps = []
    for side, camera in (("left", rig.left), ("right", rig.right)):
        section = document.section(side, "R_rect_cam and target")
        R_rect_cam = section.matrix("R_rect_cam", "a 3x3 rotation", 3, 3)
        target = TARGET.read(section, "target")
        with errors_at(section.at("R_rect_cam")):
            warps.append(Warp(camera, R_rect_cam, target))
    notes = document.values.get("notes", {})
    with errors_at(document.at("notes")):
        return Rectification(rig, warps[0], warps[1], size, _read_notes(notes))


def _read_notes(notes: Any) -> Mapping[str, float | str]:
    """Numbers where they read as such: YAML's scalars arrive as text."""
    if not isinstance(notes, dict):
        return {}
    return {name: _number_or_text(value) for name, value in notes.items()}


def _number_or_text(value: Any) -> float | str:
    try:
        return float(value)
    except (TypeError, ValueError):
        return str(value)


@dataclass(frozen=True)
class Field:
    """How one attribute stands in the file."""

    write: Callable[[Any], Any]
    read: Callable[[Section, str], Any]


NUMBER = Field(float, lambda section, key: section.number(key, "a number"))
TEXT = Field(str, lambda section, key: section.text(key, "a word"))
MATRIX = Field(lambda matrix: matrix.tolist(), lambda section, key: section.matrix(key, "a 3x3 matrix", 3, 3))
NUMBERS = Field(
    lambda numbers: [float(n) for n in numbers], lambda section, key: tuple(section.numbers(key, "numbers"))
)
ROWS = Field(
    lambda rows: [list(map(float, row)) for row in rows],
    lambda section, key: tuple(map(tuple, section.rows(key, "rows of numbers").tolist())),
)
TARGET = Field(
    lambda target: _fields(target, TARGETS),
    lambda section, key: _read(section.section(key, "a target"), "target", TARGETS),
)
PROFILE = Field(
    lambda profile: _fields(profile, PROFILES),
    lambda section, key: _read(section.section(key, "a profile"), "profile", PROFILES),
)
SURFACE = Field(
    lambda surface: _fields(surface, SURFACES),
    lambda section, key: _read(section.section(key, "a surface"), "surface", SURFACES),
)

Kinds = Mapping[str, tuple[type, Mapping[str, Field]]]
"""By name: the class, and its attributes in the order in which it takes them."""

TARGETS: Kinds = {
    "perspective": (Perspective, {"matrix": MATRIX}),
    "epipolar": (Epipolar, {"u": PROFILE, "v": PROFILE}),
    "scan-lines": (ScanLines, {"u": SURFACE, "v": PROFILE}),
    "planar-polar": (
        PlanarPolar,
        {"matrix": MATRIX, "reference": NUMBERS, "v": PROFILE, "along": TEXT, "start_px": NUMBER},
    ),
    "upright": (Upright, {"u": PROFILE, "v": PROFILE}),
    "planospheric": (Planospheric, {"u": PROFILE, "v": PROFILE}),
    "stereographic": (Stereographic, dict.fromkeys(("focal_px", "cx", "cy"), NUMBER)),
    "epipolar-circles": (
        EpipolarCircles,
        dict.fromkeys(("focal_px", "cx", "cy"), NUMBER) | {"baseline": NUMBERS},
    ),
    "prism": (
        Prism,
        dict.fromkeys(("focal_px", "cx", "cy", "first_rad", "piece_rad", "pieces"), NUMBER),
    ),
    "wrapped": (Wrapped, {"target": TARGET} | dict.fromkeys(("start", "turn"), NUMBER)),
    "framed": (Framed, {"target": TARGET} | dict.fromkeys(("left", "top", "across", "down"), NUMBER)),
}
PROFILES: Kinds = {
    "cubic": (Cubic, dict.fromkeys(("c0", "c1", "c2", "c3", "low", "high"), NUMBER)),
    "radial": (Radial, {"law": TEXT, "focal_px": NUMBER, "centre_px": NUMBER}),
    "composed": (Composed, {"outer": PROFILE, "inner": PROFILE, "low": NUMBER, "high": NUMBER}),
    "polynomial-inverse": (
        PolynomialInverse,
        {"coefficients": NUMBERS, "value_low": NUMBER, "value_high": NUMBER},
    ),
    "monotone-spline": (MonotoneSpline, {"knots": NUMBERS, "slopes": NUMBERS, "value_low": NUMBER}),
    "framed": (FramedProfile, {"profile": PROFILE, "start": NUMBER, "scale": NUMBER}),
}

SURFACES: Kinds = {
    "spline": (SplineSurface, {"beta": NUMBERS, "gamma": NUMBERS, "coefficients": ROWS}),
}


def _fields(item: Target | Profile | SplineSurface, kinds: Kinds) -> dict[str, Any]:
    """What a target or profile is as plain data; of somebody else's class no more than its name."""
    for kind, (made, fields) in kinds.items():
        if type(item) is made:
            return {"kind": kind} | {name: field.write(getattr(item, name)) for name, field in fields.items()}
    return {"kind": type(item).__name__}


def _read(section: Section, what: str, kinds: Kinds) -> Any:
    kind = section.text("kind", f"a kind of {what}")
    if kind not in kinds:
        raise InvalidInput(f"{section.at('kind')}: {UnknownName(what, one_line(kind), kinds)}")
    made, fields = kinds[kind]
    values = [field.read(section, name) for name, field in fields.items()]
    with errors_at(section.where):
        return made(*values)
