"""Middlebury's `calib.txt` of a rectified pair: `cam0=[f 0 cx; 0 f cy; 0 0 1]`, `baseline`, size.

The cameras differ in cx alone (`doffs`) and stand side by side, `baseline` millimetres apart, as the
dataset's description has it. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, side_by_side, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Source
from rectbench.calibrations.formats.toolboxes.opencv import camera_matrix
from rectbench.rigs.rig import Rig


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.table("=")
    size = file.sides("width", "height", given.size)
    left, right = (
        camera_of(file.at(key), "pinhole", size, camera_matrix(file, key, "pinhole"))
        for key in ("cam0", "cam1")
    )
    baseline = file.number("baseline", "millimetres")
    return side_by_side(left, right, baseline, given, file.at("baseline"), source.name, unit="mm")


def _recognises(source: Source) -> bool:
    return bool(re.search(r"(?m)^cam0=\[", source.head))


FORMAT = RigFormat("middlebury", "Middlebury calib.txt of a rectified pair", _recognises, _read)
