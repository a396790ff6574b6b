"""Middlebury's `calib.txt` of a rectified pair: `cam0=[f 0 cx; 0 f cy; 0 0 1]`, `baseline`, size.

The cameras differ in cx alone (`doffs`) and stand side by side, `baseline` millimetres apart, as the
dataset's description has it. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import assembled, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, blaming
from rectbench.calibrations.formats.toolboxes.opencv import camera_matrix
from rectbench.cameras import Camera
from rectbench.rigs.rig import Rig


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    lines = (line.partition("=") for line in source.text.splitlines())
    entries = {key.strip(): re.sub(r"[\[\];,]", " ", value).split() for key, _, value in lines}
    file = Section(
        source.path, "", {key: words[0] if len(words) == 1 else words for key, words in entries.items()}
    )
    size = file.sides("width", "height", given.size)
    cameras = []
    for key in ("cam0", "cam1"):
        params = camera_matrix(file, key, "pinhole")
        with blaming(file.at(key)):
            cameras.append(Camera("pinhole", size, params))
    T = rigid(np.eye(3), [-file.number("baseline", "millimetres"), 0.0, 0.0])
    left, right = cameras
    return assembled(left, right, T, given, file.at("baseline"), source.name, unit="mm")


def _recognises(source: Source) -> bool:
    return bool(re.search(r"(?m)^cam0=\[", source.head))


FORMAT = RigFormat("middlebury", "Middlebury calib.txt of a rectified pair", _recognises, _read)
