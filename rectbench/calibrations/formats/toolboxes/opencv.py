"""OpenCV's stereo calibrations, YAML, XML, JSON or .npz, as `cv2.FileStorage`, samples and Python write them.

| what | keys, for camera 1 (left) and 2 (right) |
|---|---|
| matrix | `M1`, `K1`, `cameraMatrix1`, `camera_matrix_1` ...; without the number in a file of one camera |
| distortion | `D1`, `distCoeffs1`, `distortion_coefficients_1` ... |
| Mei's ξ | `xi1`, `xi_1`; makes the camera omnidirectional |
| pose | `R` (3x3 or a rotation vector) and `T`, or `rvec`, `om` and `tvec`, or six `extrinsic_parameters` |
| image | `image_width` and `image_height`, or `imageSize`, `image_size`, `cameraResolution` |
| lens | `model` (or `camera_model`): pinhole, fisheye or omnidir; or `fisheye_model: 1` |

Instead of 1 and 2 a file may have the pairs of `opencv_keys`, such as `K_left` and `K_right`, or a section
for each camera, such as `left_camera` and `right_camera`, with the pose beside them or in a section
`stereo`. Where there is a matrix 0, cameras 0 and 1 are left and right.

X_right = R X_left + T, as `stereoCalibrate` gives it, in the unit of the board's squares: metres unless
the caller says otherwise. Several files complete each other; a file for each camera is read in the
order given, left first. Four distortion coefficients, or four and zeros, of which no file says whether they
are a pinhole's or a fisheye's are taken for a pinhole's, which the log tells, or refused where they can
hardly be. A word on the lens may stand under other keys too, such as `distortion_model` or `lens`. Where the
cameras differ in lens or size, `model_1`, `imageSize_1` and the like tell them apart.
Pixel (0, 0) is the centre of a pixel; K's skew counts for a fisheye (K[0, 1] = alpha fx) and an
omnidirectional camera, as in OpenCV's functions, and `projectPoints` has none for a pinhole.

Written are K1 D1 K2 D2 R T, model_1 model_2, imageSize_1 imageSize_2 and, of an omnidirectional camera,
xi_1 xi_2.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from rectbench.calibrations.assembling import assembled, camera_of, rigid
from rectbench.calibrations.checks.consistency import compare_lengths, compare_rotations, rotation_in
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, agreed_size, shown, tell
from rectbench.calibrations.documents.numbers import flat_numbers
from rectbench.calibrations.formats.toolboxes.opencv_keys import (
    DISTORTION,
    FLAGS,
    FROM_ONE,
    FROM_ZERO,
    MARKS,
    MATRIX,
    MODEL,
    OTHER_MODEL,
    PAIRS,
    ROTATION,
    SIDES,
    SIX,
    SIZE,
    TRANSLATION,
    XI,
    Files,
    named,
    parts_of,
)
from rectbench.calibrations.layouts import layout_of
from rectbench.calibrations.rectified_pair import matrix_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

YES_OR_NO = {"0": False, "0.0": False, "false": False, "1": True, "1.0": True, "true": True}

FOCAL = ("fx", "fy", "cx", "cy")
CAMERA_MODELS = {"pinhole": "pinhole", "fisheye": "kannala-brandt", "omnidir": "unified"}
TILT = ("tau_x", "tau_y")
"""The last two of a pinhole's 14 coefficients, which turn its sensor."""

PINHOLE_ORDER = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
ORDERS = {"pinhole": PINHOLE_ORDER, "fisheye": ("k1", "k2", "k3", "k4"), "omnidir": ("k1", "k2", "p1", "p2")}
LAYOUTS = {
    lens: (model, (*FOCAL, *ORDERS[lens], *(() if lens == "pinhole" else ("skew", "xi"))))
    for lens, model in CAMERA_MODELS.items()
} | {"tilted": ("tilted-pinhole", (*FOCAL, *PINHOLE_ORDER, *TILT))}
"""What OpenCV's three modules have places for."""

SUFFIXES = (".yml", ".yaml", ".xml", ".json")
PINHOLE_COUNTS = (4, 5, 8, 12, 14)
"""Lengths of OpenCV's distortion vector."""

COUNTS = {"pinhole": PINHOLE_COUNTS, "fisheye": (4,), "omnidir": (4,)}

LARGEST_TANGENTIAL = 0.02
"""Of p1 and p2 of a pinhole; what is larger, third or fourth of four, is rather a fisheye's k3 or k4."""

WORDS = {
    "pinhole": (
        *("pinhole", "perspective", "radtan", "plumb_bob", "rational_polynomial", "opencv", "brown_conrady"),
        *("radial-tangential", "radial_tangential", "radtan8", "standard", "rational"),
    ),
    "fisheye": (
        *(
            "fisheye",
            "equidistant",
            "kannala-brandt",
            "kannala_brandt",
            "opencv_fisheye",
            "equi",
            "kb4",
            "kb8",
        ),
        *("kannalabrandt8", "kannala_brandt4", "kannalabrandt4", "kannalabrandt"),
    ),
    "omnidir": ("omnidir", "omni", "mei"),
}
"""What files call the lenses."""

LENS_REMEDY = "`model: fisheye` or `model: pinhole`, in the file or in another one beside it"

LENSES = {word: lens for lens, words in WORDS.items() for word in words}


def camera_matrix(file: Section, key: str, lens: str) -> dict[str, float]:
    """The parameters in the 3x3 camera matrix under `key`; only a pinhole camera has no skew."""
    fx, skew, cx, zero, fy, cy, *last = file.array(key, "a 3x3 camera matrix", (9,)).tolist()
    if [zero, *last] != [0, 0, 0, 1] or (skew != 0 and lens == "pinhole"):
        raise InvalidInput(
            f"{file.at(key)} has skew or no last row 0 0 1; expected [fx 0 cx; 0 fy cy; 0 0 1]"
        )
    params = {"fx": fx, "fy": fy, "cx": cx, "cy": cy}
    return params | ({"skew": skew} if skew else {})


def lens_parameters(file: Section, key: str, lens: str, counts: Collection[int]) -> dict[str, float]:
    """The distortion under `key` of a pinhole, fisheye or omnidirectional camera, `counts` long."""
    lengths = [str(count) for count in counts if count]
    expected = " or ".join(filter(None, (", ".join(lengths[:-1]), lengths[-1])))
    values = file.values.get(key)
    if 0 in counts and values in ([], None):
        if key not in file:
            tell(f"{file.at(key)} is missing; taken to be none")
        return {}
    expected = f"{expected} distortion coefficients ({lens})"
    # ROS drivers, and depthai, fill the vector of a fisheye up with zeros to that of a pinhole.
    filled = PINHOLE_COUNTS if lens == "fisheye" else ()
    distortion = file.array(key, expected, {*counts, *filled}).tolist()
    order = ORDERS[lens]
    beyond = distortion[len(order) :]
    if any(beyond) and lens == "fisheye":
        raise file.fault(key, expected)
    return dict(zip((*order, *TILT) if any(beyond) else order, distortion, strict=False))


def opencv_camera(
    file: Section,
    matrix: str,
    distortion: str,
    lens: str,
    size: tuple[int, int],
    where: str | None = None,
    counts: Collection[int] | None = None,
) -> Camera:
    """The camera of OpenCV's matrix and distortion under these keys; `counts` are the latter's lengths."""
    params = camera_matrix(file, matrix, lens)
    params |= lens_parameters(file, distortion, lens, counts or COUNTS[lens])
    return camera_of(where or file.at(matrix), model_of(lens, params), size, params)


def model_of(lens: str, params: Collection[str]) -> str:
    """The projection model of OpenCV's lens with these parameters."""
    return "tilted-pinhole" if set(TILT) & set(params) else CAMERA_MODELS[lens]


def _read(sources: Sequence[Source], given: Given) -> Rig:
    files = Files([part for source in sources for part in parts_of(source.document)])
    left, right = (_read_camera(files, number, given.size) for number in (1, 2))
    where, T = _read_pose(files)
    _compare_rectification(files, T)
    return assembled(left, right, T, given, f"{files}: {where}", sources[0].name)


def _compare_rectification(files: Files, T: FloatArray) -> None:
    """R1 and R2 of `stereoRectify` hold the rotation too, and P2 the length of the translation."""
    for document in files.documents:
        document.knows("P1", "Q", SIX)  # six numbers a view are the board's poses
        R1, R2 = (rotation_in(document, key) for key in ("R1", "R2"))
        if R1 is not None and R2 is not None:
            compare_rotations(document.at("R1"), R2.T @ R1, T[:3, :3], "R")
        P2 = flat_numbers(document.values.get("P2"))
        if P2 is not None and len(P2) == 12 and P2[0] > 0 and P2[3] != 0:
            compare_lengths(f"{document.at('P2')}[0, 3] / P2[0, 0]", abs(P2[3] / P2[0]), T[:3, 3], "T")


def _read_pose(files: Files) -> tuple[str, FloatArray]:
    """Under which keys the pose is, and T_right_left."""
    for document, key in files.holders((SIX,)):
        if files.of_pair(document) and not any(files.holders(ROTATION)):
            six = document.array(key, "six numbers, rotation vector and translation", (6,))
            return key, rigid(cv2.Rodrigues(six[:3])[0], six[3:])
    rotation_key, R = files.pose(ROTATION, "a 3x3 rotation or a rotation vector", (9, 3))
    R = R.reshape(3, 3) if R.size == 9 else cv2.Rodrigues(R)[0]
    translation_key, t = files.pose(TRANSLATION, "three metres", (3,))
    return f"{rotation_key}, {translation_key}", rigid(R, t)


def _read_camera(files: Files, number: int, size: tuple[int, int] | None) -> Camera:
    document, key = files.first(MATRIX, number, "a 3x3 camera matrix")
    xi = next(files.of_camera(XI, number), None)
    stated = _read_lens(files, number)
    lens = stated or ("pinhole" if xi is None else "omnidir")
    params = camera_matrix(document, key, lens)
    counts = COUNTS[lens]
    source, name = files.first(DISTORTION, number, f"{counts[0]} distortion coefficients ({lens})")
    coefficients = lens_parameters(source, name, lens, counts)
    if stated is None and lens == "pinhole":
        check_pinhole(source.at(name), coefficients, LENS_REMEDY)
    params |= coefficients
    if lens == "omnidir":
        holder, xi_key = xi or files.first(XI, number, "Mei's xi, a number")
        params["xi"] = float(holder.array(xi_key, "Mei's xi, a number", (1,))[0])
    image = _read_size(files, number, size)
    return camera_of(f"{document.at(key)}, {name}", model_of(lens, params), image, params)


def check_pinhole(where: str, coefficients: Mapping[str, float], remedy: str, is_usual: bool = False) -> None:
    """Tell that four coefficients, or four and zeros, are taken for a pinhole's, since no file says whose.

    Refused are those that can hardly be. Where the format's are usually a pinhole's, all else is not told.
    """
    numbers = list(coefficients.values())
    if not any(numbers) or any(numbers[4:]):
        return
    if max(map(abs, numbers[2:4])) > LARGEST_TANGENTIAL:
        found = shown(numbers)
        raise InvalidInput(f"{where} is {found}, more of a fisheye's than a pinhole's; expected {remedy}")
    if not is_usual:
        tell(f"{where}: taken for a pinhole's k1 k2 p1 p2; to say so or otherwise: {remedy}")


def _read_lens(files: Files, number: int) -> str | None:
    """The lens that the files state."""
    for document, key in (*files.of_camera(FLAGS, number), *files.holders(FLAGS)):
        word = str(document.values[key]).lower()
        if word not in YES_OR_NO:
            raise document.fault(key, "0 or 1")
        if YES_OR_NO[word]:
            return "fisheye"
    for document, key in (*files.of_camera(MODEL, number), *files.holders(MODEL)):
        word = str(document.values[key]).lower()
        if word not in LENSES:
            raise InvalidInput(f"{document.at(key)} is {shown(word)}; expected pinhole, fisheye or omnidir")
        return LENSES[word]
    for document, key in (*files.of_camera(OTHER_MODEL, number), *files.holders(OTHER_MODEL)):
        word = str(dict(document.values.items())[key]).lower()  # is not read where it is another word
        if word in LENSES:
            document.knows(key)
            return LENSES[word]
    return None


def _read_size(files: Files, number: int, given: tuple[int, int] | None) -> tuple[int, int]:
    """The image size of that camera, or else of any; `given` where no file has one."""
    for document, key in (*files.of_camera(SIZE, number), *files.holders(SIZE)):
        return agreed_size(document.at(key), document.array(key, "[width, height]", (2,)), given)
    for document, key in (*files.of_camera(SIDES, number), *files.holders(SIDES)):
        return document.sides(key.replace(*SIDES[::-1]), key.replace(*SIDES), given)
    if given is None:
        raise InvalidInput(
            f"{files}: image_width is missing; expected it and image_height, or `{argument('size')}` beside "
            "the file"
        )
    return given


def _recognises(source: Source) -> bool:
    patterns = [pattern for pair in (("{}",), *FROM_ONE, *FROM_ZERO, *PAIRS) for pattern in pair]
    numbered = set(named(MATRIX, patterns))
    has_matrix = "opencv-matrix" in source.head or "<opencv_storage" in source.head
    if source.keys & (numbered | MARKS) or (has_matrix and source.keys):
        return True
    return bool(source.keys) and any(part.values.keys() & set(MATRIX) for part in parts_of(source.document))


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """The rig as `cv2.FileStorage` writes it in the language that the name's suffix calls for."""
    suffix = Path(name).suffix.lower()
    if suffix not in SUFFIXES:
        raise InvalidInput(f"{name}: has no suffix of OpenCV's; expected {', '.join(SUFFIXES)}")
    storage = cv2.FileStorage(suffix, cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    for number, side, camera in ((1, "left", rig.left), (2, "right", rig.right)):
        lens, equal = layout_of(camera, LAYOUTS, "opencv", side)
        _write_camera(storage, number, lens, equal)
    storage.write("R", rig.R_right_left)
    storage.write("T", rig.t_right_left.reshape(3, 1))
    return {name: storage.releaseAndGetString()}


def _write_camera(storage: Any, number: int, lens: str, camera: Camera) -> None:
    storage.write(f"model_{number}", "pinhole" if lens == "tilted" else lens)
    storage.write(f"imageSize_{number}", np.array([camera.size]))
    storage.write(f"K{number}", matrix_of(camera))
    storage.write(f"D{number}", np.array([distortion_of(camera, lens)]))
    if lens == "omnidir":
        storage.write(f"xi_{number}", camera.params["xi"])


def distortion_of(camera: Camera, lens: str) -> list[float]:
    """The coefficients in OpenCV's order, of a pinhole as many of 5, 8 or 12 as it takes."""
    if lens == "tilted":
        return [camera.params[name] for name in (*PINHOLE_ORDER, *TILT)]
    coefficients = [camera.params[name] for name in ORDERS[lens]]
    return coefficients[: next(n for n in (5, 8, 12) if not any(coefficients[n:]))]


FORMAT = RigFormat(
    "opencv",
    "OpenCV stereo, fisheye and omnidir calibration (YAML, XML, JSON, .npz)",
    _recognises,
    _read,
    shares_keys=True,
    write=Writing(_texts),
)
