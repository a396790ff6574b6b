"""OCamCalib's `calib_results.txt`: one camera, the pose is not in it.

The file's own comments say what it holds: the polynomial of cam2world (its length first), that of
world2cam, the centre as row and column "starting from 0 (C convention)", the affine parameters c, d
and e, and the image's height and width. Rows come first in OCamCalib; its camera looks along -z.
Written are a file a camera and a third for the pose; the polynomial of world2cam is fitted where the
camera has none.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from rectbench.calibrations.assembling import camera_of
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Source, agreed_size, errors_at, finite_number, shown
from rectbench.calibrations.layouts import layout_of
from rectbench.calibrations.pose_file import pose_text
from rectbench.cameras import Camera
from rectbench.cameras.lens import lens_named
from rectbench.errors import InvalidInput
from rectbench.rigs.file_formats import CannotHold, Writing, lost_angles
from rectbench.rigs.rig import Rig

BLOCKS = (
    "the polynomial of cam2world: its length and coefficients",
    "the polynomial of world2cam: its length and coefficients",
    "the centre: row and column",
    "the affine parameters c, d, e",
    "the image size: height and width",
)
MARK = re.compile(r"(?m)^\s*#.*(polynomial coefficients|ocam_model|inverse mapping function)")
"""A comment of the file."""

MAX_COEFFICIENTS = 50

LAYOUTS = {"ocam": ("ocam", ("cx", "cy", "c", "d", "e", "poly", "inverse_poly"))}
SAMPLES = 400
LARGEST_ERROR_PX = 0.01
"""Of a fitted polynomial of world2cam, as in OCamCalib's findinvpoly, which takes the least degree."""

MAX_DEGREE = 14


def stretched(
    stretch: Sequence[Sequence[float]],
    centre: tuple[float, float],
    poly: Sequence[float],
    inverse_poly: Sequence[float],
    where: str,
) -> dict[str, Any]:
    """Parameters of `ocam` for u - centre = A x', A a 2x2 matrix whose last entry is 1.

    CamOdoCal and MATLAB stretch u, where rectbench's model, as OCamCalib's, stretches v. The two
    differ by a scale on the sensor, which the polynomials take up.
    """
    (a, b), (c, d) = stretch
    if not (a > 0 and abs(d - 1) < 1e-6):
        raise InvalidInput(f"{where} stretches by {a:g} and {d:g}; expected a number above 0 and 1")
    with errors_at(where):
        return {
            "cx": centre[0],
            "cy": centre[1],
            "e": b / a,
            "d": c / a,
            "c": d / a,
            "poly": [coefficient * a ** (1 - power) for power, coefficient in enumerate(poly)],
            "inverse_poly": [coefficient * a for coefficient in inverse_poly],
        }


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file; it does not tell its pose."""
    poly, inverse_poly, centre, affine, sides = _blocks(source)
    row, column = centre
    c, d, e = affine
    size = agreed_size(f"{source.path}: {BLOCKS[4]}", sides[::-1], given.size)
    # The direct polynomial is the calibrated one; the other is a fit to it.
    params = {"cx": column, "cy": row, "c": c, "d": d, "e": e, "poly": poly, "inverse_poly": inverse_poly}
    return PosedCamera(source.path, camera_of(source.path, "ocam", size, params))


def _blocks(source: Source) -> list[list[float]]:
    lines = [line.split() for line in source.text.splitlines()]
    lines = [words for words in lines if words and not words[0].startswith(("#", "%"))]
    if len(lines) != len(BLOCKS):
        raise InvalidInput(f"{source.path}: has {len(lines)} lines of numbers; expected {len(BLOCKS)}")
    blocks = [_numbers(source, words, what) for words, what in zip(lines, BLOCKS, strict=True)]
    for place in (0, 1):
        length, *coefficients = blocks[place]
        if length != len(coefficients) or not coefficients:
            raise InvalidInput(
                f"{source.path}: {BLOCKS[place]}: {len(coefficients)} follow; expected {length:g}"
            )
        blocks[place] = coefficients
    for place, count in ((2, 2), (3, 3), (4, 2)):
        if len(blocks[place]) != count:
            raise InvalidInput(f"{source.path}: {BLOCKS[place]} is {shown(blocks[place])}; expected {count}")
    return blocks


def _numbers(source: Source, words: list[str], what: str) -> list[float]:
    numbers = [finite_number(word) for word in words]
    if None in numbers or len(words) > MAX_COEFFICIENTS + 1:
        raise InvalidInput(f"{source.path}: {what} is {shown(words)}; expected finite numbers")
    return [number for number in numbers if number is not None]


def _recognises(source: Source) -> bool:
    return bool(MARK.search(source.head))


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """A file a camera, and one with the pose."""
    cameras = {"left": rig.left, "right": rig.right}
    return {f"{side}.txt": _text(camera, side) for side, camera in cameras.items()} | {
        "pose.yaml": pose_text(rig)
    }


def _text(camera: Camera, side: str) -> str:
    _, camera = layout_of(camera, LAYOUTS, "ocamcalib", side)
    p = camera.params
    if not p["poly"]:
        raise CannotHold(f"ocamcalib has no place for the {side} camera, ocam with inverse_poly and no poly")
    sign = -math.copysign(1.0, p["poly"][0])  # OCamCalib looks along -z
    inverse_poly, _ = _inverse_of(camera)
    blocks = (
        ("polynomial coefficients for the DIRECT mapping function, used by cam2world", p["poly"], sign),
        ("polynomial coefficients for the inverse mapping function, used by world2cam", inverse_poly, 1.0),
    )
    lines = [
        f"#{what}\n\n{len(numbers)} {_joined(factor * number for number in numbers)}\n"
        for what, numbers, factor in blocks
    ]
    return "\n".join(
        (
            *lines,
            f'#center: "row" and "column", starting from 0 (C convention)\n\n{_joined((p["cy"], p["cx"]))}\n',
            f'#affine parameters "c", "d", "e"\n\n{_joined((p["c"], p["d"], p["e"]))}\n',
            f'#image size: "height" and "width"\n\n{camera.height} {camera.width}\n',
        )
    )


def _joined(numbers: Iterable[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def _inverse_of(camera: Camera) -> tuple[list[float], float]:
    """The polynomial of world2cam, and how far it is off the direct one on the image, pixels.

    It is the camera's own, or else the one of the least degree that is as near as OCamCalib asks of its
    own, or the nearest where none is.
    """
    c = SimpleNamespace(**camera.constants)
    corners = camera.pixel_grid()[[0, 0, -1, -1], [0, -1, 0, -1]]
    farthest = max(float(np.hypot(*lens_named("ocam").from_pixel(c, u, v))) for u, v in corners)
    radius = np.linspace(0.0, min(farthest, c.max_radius), SAMPLES)
    t = np.arctan2(radius, Polynomial(c.depth)(radius)) - 0.5 * math.pi

    def error_px(polynomial: Polynomial) -> float:
        return float(np.abs(polynomial(t) - radius).max())

    if c.inverse_poly:
        return list(c.inverse_poly), error_px(Polynomial(c.inverse_poly))
    fits = [Polynomial.fit(t, radius, degree).convert() for degree in range(3, MAX_DEGREE + 1)]
    near = (fit for fit in fits if error_px(fit) < LARGEST_ERROR_PX)
    fit = next(near, None) or min(fits, key=error_px)
    return fit.coef.tolist(), error_px(fit)


def _losses(rig: Rig) -> list[str]:
    fitted = [
        f"fits world2cam to the {side} camera's cam2world, {_inverse_of(camera)[1]:.2g} px off at most"
        for side, camera in (("left", rig.left), ("right", rig.right))
        if not camera.params["inverse_poly"]
    ]
    return [*lost_angles(rig), *fitted]


FORMAT = CameraFormat(
    "ocamcalib",
    "OCamCalib calib_results.txt (two files and a pose)",
    _recognises,
    read_posed,
    write=Writing(_texts, in_folder=True, losses=_losses),
)
