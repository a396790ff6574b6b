"""SimpleStereo's `rig.json`, as `StereoRig.save` writes it (github.com/decadenza/SimpleStereo, `_rigs.py`).

`intrinsic1`, `distCoeffs1`, `res1` = [width, height] and the same with 2 are OpenCV's pinholes; `R` and `T`
are those of `stereoCalibrate`, X_2 = R X_1 + T. T is in the unit of the board's squares, which the file does
not tell: metres, or millimetres for a baseline beyond 10, which is told. `F`, `E` and what a rectified rig
adds follow from the rest. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import LONGEST_BASELINE_M, assembled, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.named_cameras import told_unit
from rectbench.calibrations.formats.toolboxes.opencv import COUNTS, opencv_camera
from rectbench.cameras import Camera
from rectbench.rigs.rig import Rig

CAMERA_KEYS = ("res", "intrinsic", "distCoeffs")
DERIVED = ("F", "E", "reprojectionError", "rectHomography1", "rectHomography2")
"""What follows from the rest, or says how good it is."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    file.only((*(f"{key}{number}" for number in (1, 2) for key in CAMERA_KEYS), "R", "T", *DERIVED))
    file.knows(*DERIVED)
    left, right = (_read_camera(file, number, given) for number in (1, 2))
    t = file.array("T", "a translation", (3,))
    where = file.at("T")
    unit = told_unit(where, float(np.linalg.norm(t)), LONGEST_BASELINE_M, "mm", given)
    return assembled(left, right, rigid(file.rotation("R"), t), given, where, source.name, unit)


def _read_camera(file: Section, number: int, given: Given) -> Camera:
    size = file.size(f"res{number}", given.size)
    matrix, distortion = f"intrinsic{number}", f"distCoeffs{number}"
    if distortion not in file:
        raise file.fault(distortion, "OpenCV's coefficients, or null")
    return opencv_camera(file, matrix, distortion, "pinhole", size, counts=(0, *COUNTS["pinhole"]))


FORMAT = RigFormat(
    "simplestereo",
    "SimpleStereo rig (JSON)",
    lambda source: {"intrinsic1", "intrinsic2", "distCoeffs1", "R", "T"} <= source.keys,
    _read,
)
