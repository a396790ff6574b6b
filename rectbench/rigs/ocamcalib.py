"""OCamCalib's `calib_results.txt`: one camera, the pose is not in it.

The file's own comments say what it holds: the polynomial of cam2world (its length first), that of
world2cam, the centre as row and column "starting from 0 (C convention)", the affine parameters c, d
and e, and the image's height and width. Rows come first in OCamCalib; its camera looks along -z.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.documents import blaming, checked_size, finite_number, shown
from rectbench.rigs.formats import CameraFormat, Given, View
from rectbench.rigs.sources import Source

BLOCKS = (
    "the polynomial of cam2world: its length and coefficients",
    "the polynomial of world2cam: its length and coefficients",
    "the centre: row and column",
    "the affine parameters c, d, e",
    "the image size: height and width",
)
MAX_COEFFICIENTS = 50


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
    with blaming(where):
        return {
            "cx": centre[0],
            "cy": centre[1],
            "e": b / a,
            "d": c / a,
            "c": d / a,
            "poly": [coefficient * a ** (1 - power) for power, coefficient in enumerate(poly)],
            "inverse_poly": [coefficient * a for coefficient in inverse_poly],
        }


def read_view(source: Source, given: Given) -> View:
    """The camera in the file; it does not tell its pose."""
    poly, inverse_poly, centre, affine, sides = _blocks(source)
    row, column = centre
    c, d, e = affine
    height, width = sides
    with blaming(f"{source.path}: {BLOCKS[4]}"):
        size = checked_size((width, height))
    if given.size not in (None, size):
        raise InvalidInput(f"{source.path}: size is {size}; expected {given.size} as given beside the file")
    # The direct polynomial is the calibrated one; the other is a fit to it.
    params = {"cx": column, "cy": row, "c": c, "d": d, "e": e, "poly": poly, "inverse_poly": inverse_poly}
    with blaming(source.path):
        return View(source.path, Camera("ocam", size, params))


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
    return bool(re.search(r"polynomial coefficients|ocam_model|inverse mapping function", source.head))


FORMAT = CameraFormat(
    "ocamcalib", "OCamCalib calib_results.txt (two files and a pose)", _recognises, read_view
)
