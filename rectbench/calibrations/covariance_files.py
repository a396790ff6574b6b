"""Files that state the uncertainty of a calibration.

| file | what is read |
|---|---|
| the project's own YAML | `sigmas:`, by name; or `parameters:`, names, and `covariance:`, a matrix |
| Kalibr's `...-results-cam.txt` | the values after `+-` of projection, distortion and baseline |
| OpenCV's interactive-calibration, one file a camera | `cameraMatrix_std_dev` and `dist_coeffs_std_dev` |
| any dump of `calibrateCameraExtended`, one file a camera | `stdDeviationsIntrinsics` |

Names under `sigmas:` are `rotation_deg`, `direction_deg`, `baseline_m`, `focal_px` and `centre_px` (see
`RigCovariance.from_sigmas`), and single parameters (see `rectbench.rigs.covariance`); those of `parameters:`
are single ones. Kalibr and OpenCV tell no correlations: their parameters count as independent, though
OpenCV's fx and fy move as one where it held their ratio. That overstates what a good calibration leaves
of row error, as errors of principal point and rotation that fit the same images cancel each other.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rectbench.calibrations.documents import Source, errors_at, finite_number, shown
from rectbench.calibrations.formats.odometry.kalibr import LAYOUTS
from rectbench.calibrations.formats.toolboxes.opencv import PINHOLE_ORDER
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.covariance import ROTATION, TRANSLATION, RigCovariance
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

SIZES = ("rotation_deg", "direction_deg", "baseline_m", "focal_px", "centre_px")
OPENCV_KEYS = ("cameraMatrix_std_dev", "stdDeviationsIntrinsics")
MOST_PARAMETERS = 100
AGREEMENT = 1e-3
"""Relative difference up to which the numbers of a results file are those of the rig."""
LEAST_AGREEMENT = 1e-6
"""Likewise, absolute, of distortion and metres; the files are written with eight decimals."""
UNCORRELATED = "standard deviations without correlations"
SIDES = ("left", "right")


def load_covariance(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]], rig: Rig
) -> RigCovariance:
    """The covariance of the rig's calibration from a file, or from one a camera, left first.

    The kind of a file is recognised by its content, see this module. Raises InvalidInput, in one line
    that names file and key, for what cannot be read, is no covariance or belongs to another rig.

    >>> import tempfile
    >>> from pathlib import Path
    >>> import rectbench as rb
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "sure.yaml")
    ...     _ = file.write_text("sigmas: {baseline_m: 0.001, left.fx: 0.5}")
    ...     rb.load_covariance(file, rb.load_rig("t265")).sigma("left.fx")
    0.5
    """
    paths = [files] if isinstance(files, str | os.PathLike) else list(files)
    sources = [Source.read(path) for path in paths]
    if not sources or len(sources) > 2:
        raise InvalidInput(f"{len(sources)} covariance files were given; expected one, or one a camera")
    if len(sources) == 2:
        left, right = map(_read_opencv, sources, SIDES, (rig.left, rig.right))
        return replace(left + right, source=f"{left.source}, {right.source}; {UNCORRELATED}")
    (source,) = sources
    if _is_kalibr(source):
        return _read_kalibr(source, rig)
    if any(key in source.keys for key in OPENCV_KEYS):
        raise InvalidInput(f"{source.path}: is of one camera; expected a file of each camera, left first")
    return _read_own(source, rig)


def _read_own(source: Source, rig: Rig) -> RigCovariance:
    document = source.document
    document.only(("source", "sigmas", "parameters", "covariance"))
    origin = document.text("source", "prose") if "source" in document else source.name
    if "sigmas" in document and "covariance" in document:
        raise InvalidInput(f"{document.at('sigmas')} stands beside covariance; expected one of the two")
    if "sigmas" in document:
        section = document.section("sigmas", "standard deviations by name")
        given = {name: section.number(name, "a standard deviation") for name in section.values}
        sizes = {name: given.pop(name) for name in SIZES if name in given}
        with errors_at(document.at("sigmas")):
            return RigCovariance.from_sigmas(rig, **sizes, parameters=given, source=origin)
    if "parameters" not in document:
        raise document.fault("parameters", "sigmas:, or parameters: and covariance:")
    names = document.values["parameters"]
    if not isinstance(names, list) or not 0 < len(names) <= MOST_PARAMETERS:
        raise document.fault("parameters", f"a list of 1 to {MOST_PARAMETERS} names")
    places = document.section_of_list("parameters")
    parameters = tuple(places.text(str(place), "a name") for place in range(len(names)))
    count = len(parameters)
    expected = f"a {count}x{count} matrix, a row for each of the parameters"
    matrix = document.matrix("covariance", expected, count, count)
    with errors_at(document.at("covariance")):
        covariance = RigCovariance(parameters, matrix, origin)
        covariance.refuse_unknown(rig)
    return covariance


def _read_opencv(source: Source, side: str, camera: Camera) -> RigCovariance:
    """That of one camera, whose file holds its standard deviations."""
    document = source.document
    if not any(key in document for key in OPENCV_KEYS):
        raise document.fault(OPENCV_KEYS[0], "the standard deviations of fx fy cx cy, one file a camera")
    if camera.model != "pinhole":
        raise InvalidInput(
            f"{source.path}: is of OpenCV's pinhole model; expected one of the {side} lens ({camera.model})"
        )
    names = ("fx", "fy", "cx", "cy", *PINHOLE_ORDER)
    if OPENCV_KEYS[0] in document:
        numbers = document.array(OPENCV_KEYS[0], "4 standard deviations (fx fy cx cy)", (4,))
        if "dist_coeffs_std_dev" in document:
            counts = range(4, len(PINHOLE_ORDER) + 1)
            distortion = document.array("dist_coeffs_std_dev", "standard deviations, k1 k2 p1 p2 ...", counts)
            numbers = np.concatenate([numbers, distortion])
    else:
        counts = range(4, len(names) + 3)  # the last two of 18 are of a tilted sensor
        numbers = document.array(OPENCV_KEYS[1], "standard deviations, fx fy cx cy k1 k2 ...", counts)
        if numbers[len(names) :].any():
            raise document.fault(OPENCV_KEYS[1], "a sensor that is not tilted (its last two of 18 being 0)")
    sigmas = numbers[: len(names)]
    with errors_at(source.path):
        matrix = _of_deviations(names[: len(sigmas)], sigmas)
        if sigmas[0] == 0:  # OpenCV held fx / fy, and counts fy alone
            both = np.array([camera.params["fx"] / camera.params["fy"], 1.0])
            matrix[:2, :2] = sigmas[1] ** 2 * np.outer(both, both)
        parameters = tuple(f"{side}.{name}" for name in names[: len(sigmas)])
        return RigCovariance(parameters, matrix, source.name)


def _of_deviations(names: Sequence[str], sigmas: FloatArray) -> FloatArray:
    """The covariance [P, P] of independent parameters."""
    for name, sigma in zip(names, sigmas, strict=True):
        if sigma < 0:
            raise InvalidInput(f"the standard deviation of {name} is {sigma:g}; expected one from 0 on")
    return np.diag(np.square(sigmas))


LIST = r"\s*\[([^\]]{0,600})\]\s*\+-\s*\[([^\]]{0,600})\]"
"""Values and standard deviations; NumPy breaks long ones over two lines."""


def _is_kalibr(source: Source) -> bool:
    return re.search(r"(?m)^\s*cam0\b.*:\s*$", source.head) is not None and "+-" in source.head


def _read_kalibr(source: Source, rig: Rig) -> RigCovariance:
    """Kalibr turns its quaternion from the left: the three numbers are a rotation vector in cam1's frame."""
    total = RigCovariance((), np.zeros((0, 0)))
    for number, (side, camera) in enumerate(zip(SIDES, (rig.left, rig.right), strict=True)):
        key = f"cam{number}"
        text = _paragraph(source, key)
        projection = _stated(source, text, f"{key} projection", "projection")
        distortion = _stated(source, text, f"{key} distortion", "distortion")
        names = _names(source, key, camera, len(projection[0]), len(distortion[0]))
        values, sigmas = np.hstack([projection, distortion])
        own = np.array([camera.params[name] for name in names])
        _refuse_other(
            source, f"{key} projection and distortion", values, own, f"those of the rig's {side} lens"
        )
        with errors_at(f"{source.path}: {key}"):
            parameters = tuple(f"{side}.{name}" for name in names)
            total += RigCovariance(parameters, _of_deviations(names, sigmas))
    key = "baseline T_1_0"
    text = _paragraph(source, key)
    _, turn = _stated(source, text, f"{key} q", "q", 4, 3)
    t, shift = _stated(source, text, f"{key} t", "t", 3, 3)
    _refuse_other(source, f"{key} t", t, rig.t_right_left, "the rig's")
    with errors_at(f"{source.path}: {key}"):
        names = (*ROTATION, *TRANSLATION)
        total += RigCovariance(names, _of_deviations(names, np.concatenate([turn, shift])))
    return replace(total, source=f"{source.name}; {UNCORRELATED}")


def _paragraph(source: Source, key: str) -> str:
    """The text below a heading `key ...:`, as far as the next empty line."""
    found = re.search(rf"(?m)^\s*{key}\b[^\n]*:[ \t]*\n((?:[ \t]*\S[^\n]*(?:\n|\Z))*)", source.text)
    if not found:
        raise InvalidInput(f"{source.path}: {key} is missing; expected Kalibr's results of two cameras")
    return found[1]


def _stated(source: Source, text: str, where: str, key: str, *counts: int) -> tuple[FloatArray, FloatArray]:
    """Values and standard deviations after `key:`, as many of both unless `counts` says."""
    found = re.search(rf"(?m)^\s*{key}:{LIST}", text)
    if not found:
        raise InvalidInput(f"{source.path}: {where} is missing; expected {key}: [values] +- [deviations]")
    values, sigmas = ([finite_number(word) for word in part.split()] for part in found.groups())
    lengths = len(values), len(sigmas)
    if None in values or None in sigmas or lengths != (counts or (lengths[0], lengths[0])):
        raise InvalidInput(
            f"{source.path}: {where} is {shown(found[0])}; expected finite values and their deviations"
        )
    return np.array(values, dtype=float), np.array(sigmas, dtype=float)


def _names(source: Source, key: str, camera: Camera, projection: int, distortion: int) -> tuple[str, ...]:
    """The parameters in Kalibr's lists for the lens."""
    wanted = camera.model, projection, distortion
    for layout in LAYOUTS.values():
        if (layout.model, len(layout.intrinsics), len(layout.distortion)) == wanted:
            return (*layout.intrinsics, *layout.distortion)
    raise InvalidInput(
        f"{source.path}: {key} has {projection} numbers of projection and {distortion} of distortion; "
        f"expected those of a {camera.model} lens"
    )


def _refuse_other(source: Source, where: str, values: FloatArray, own: FloatArray, whose: str) -> None:
    """Raise where a results file is of another calibration than the rig."""
    if values.shape != own.shape or not np.allclose(values, own, AGREEMENT, LEAST_AGREEMENT):
        given, expected = (shown([float(f"{n:.6g}") for n in numbers]) for numbers in (values, own))
        raise InvalidInput(f"{source.path}: {where} are {given}; expected {whose}, {expected}")
