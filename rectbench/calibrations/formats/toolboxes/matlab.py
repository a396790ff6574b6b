"""MATLAB's camera objects as JSON: `jsonencode(stereoParams)`, `jsonencode(toStruct(params))`.

| object | here |
|---|---|
| stereoParameters | a rig: `CameraParameters1` (left), `CameraParameters2`, and the pose |
| two fisheyeParameters or cameraParameters under `left` and `right`, with a pose | a rig |
| fisheyeParameters, fisheyeIntrinsics | a camera: ocam with [a0 a2 a3 a4], stretch matrix [c d; e 1] |
| cameraParameters, cameraIntrinsics | a camera: pinhole with `K`, or `IntrinsicMatrix`, its transpose |

MATLAB's pixel (1, 1) is the centre of the top-left pixel, so centres lose 1 in both coordinates, as
`stereoParametersToOpenCV` does it; `ImageSize` is [rows columns]. `PoseCamera2` (R2022b) holds R and t of
X2 = R X1 + t; `RotationOfCamera2` multiplies rows, X2 = X1 R + t, and is R's transpose. A pose may also be
R and T as in OpenCV. `WorldUnits` says what translations are in, where it names a unit known here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rectbench.calibrations import pose_file as pose
from rectbench.calibrations.assembling import assembled, camera_of, rigid, single
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, agreed_size, tell
from rectbench.calibrations.formats.toolboxes.ocamcalib import stretched
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

PAIRS = (("CameraParameters1", "CameraParameters2"), ("left", "right"), ("camera1", "camera2"))
CAMERA_KEYS = {"MappingCoefficients", "IntrinsicMatrix", "FocalLength", "Intrinsics", "RadialDistortion"}
DISTORTION = (
    ("RadialDistortion", ("k1", "k2", "k3"), (2, 3)),
    ("TangentialDistortion", ("p1", "p2"), (2,)),
)
BESIDE = (
    *("RotationVectors", "TranslationVectors", "RotationMatrices", "PatternExtrinsics", "Estimate*"),
    *("NumRadialDistortionCoefficients", "FocalLength", "PrincipalPoint", "Skew", "IntrinsicMatrix"),
)
"""The board's poses and what was estimated; and what MATLAB derives from K, or K from."""

UNIT_WORDS = {
    "m": ("m", "meters", "metres"),
    "cm": ("cm", "centimeters"),
    "mm": ("mm", "millimeters", "millimetres"),
    "in": ("in", "inches"),
    "ft": ("ft", "feet"),
}
WORLD_UNITS = {word: unit for unit, words in UNIT_WORDS.items() for word in words}
POSE_AGREEMENT = 1e-6
"""How far PoseCamera2 and the older properties, where a file has both, may differ in an entry of R."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    names = next(pair for pair in PAIRS if pair[0] in file)
    file.knows("Rectif*")
    left, right = (_read_camera(file.section(name, "a MATLAB camera"), given) for name in names)
    where, T = _read_pose(file)
    return assembled(left, right, T, given, where, sources[0].name, _unit(file, names[0]))


def _unit(file: Section, camera: str) -> str | None:
    holders = (file.values, file.values.get(camera, {}))
    stated = next((holder["WorldUnits"] for holder in holders if "WorldUnits" in holder), None)
    return WORLD_UNITS.get(str(stated).lower())


def _read_pose(file: Section) -> tuple[str, FloatArray]:
    """Where the pose is, and T_right_left."""
    if "PoseCamera2" in file:
        section = file.section("PoseCamera2", "a rigidtform3d")
        T = _pose(section, "R" if "R" in section else "Rotation", "Translation")
        file.knows("TranslationOfCamera2")
        if "RotationOfCamera2" in file:
            _check_agreement(file, T)
        return section.where, T
    if "RotationOfCamera2" in file:
        T = _pose(file, "RotationOfCamera2", "TranslationOfCamera2")
        T[:3, :3] = T[:3, :3].T
        return file.at("RotationOfCamera2"), T
    for R_key in pose.ROTATION:
        for t_key in pose.TRANSLATION:
            if R_key in file and t_key in file:
                return f"{file.at(R_key)}, {t_key}", _pose(file, R_key, t_key)
    raise file.fault("PoseCamera2", "it, or RotationOfCamera2 and TranslationOfCamera2, or R and T")


def _pose(section: Section, R_key: str, t_key: str) -> FloatArray:
    return rigid(section.rotation(R_key), section.array(t_key, "a translation", (3,)))


def _check_agreement(file: Section, T: FloatArray) -> None:
    R = file.matrix("RotationOfCamera2", "a 3x3 rotation", 3, 3)
    if np.abs(R.T - T[:3, :3]).max() > POSE_AGREEMENT:
        raise InvalidInput(
            f"{file.at('RotationOfCamera2')} is not the transpose of PoseCamera2.R; expected it"
        )


def _read_posed(source: Source, given: Given) -> PosedCamera:
    return PosedCamera(source.path, _read_camera(source.document, given))


def _read_camera(section: Section, given: Given) -> Camera:
    section.knows(*BESIDE)
    has_inner = isinstance(section.values.get("Intrinsics"), dict)
    lens = section.section("Intrinsics", "a camera") if has_inner else section
    is_fisheye = "MappingCoefficients" in lens
    model, params = ("ocam", _fisheye(lens)) if is_fisheye else ("pinhole", _pinhole(lens, section))
    size = _read_size(lens if "ImageSize" in lens else section, given)
    return camera_of(lens.where, model, size, params)


def _read_size(section: Section, given: Given) -> tuple[int, int]:
    if "ImageSize" not in section or section.values["ImageSize"] in ([], None):
        return section.sides("ImageSize", "", given.size)
    rows, columns = section.numbers("ImageSize", "[rows, columns]", 2)
    return agreed_size(section.at("ImageSize"), (columns, rows), given.size)


def _fisheye(lens: Section) -> dict[str, Any]:
    a0, *higher = lens.numbers("MappingCoefficients", "[a0, a2, a3, a4]", 4)
    u, v = lens.numbers("DistortionCenter", "[cx, cy]", 2)
    stretch = lens.matrix("StretchMatrix", "[c d; e 1]", 2, 2) if "StretchMatrix" in lens else np.eye(2)
    return stretched(stretch.tolist(), (u - 1, v - 1), (a0, 0.0, *higher), (), lens.at("StretchMatrix"))


def _pinhole(lens: Section, outer: Section) -> dict[str, float]:
    fx, fy, skew, u, v = _intrinsics(lens)
    if skew != 0:
        raise InvalidInput(
            f"{lens.at('')} has the skew {skew:g}; expected 0, as stereoParametersToOpenCV does"
        )
    holder = lens if "RadialDistortion" in lens else outer
    params = {"fx": fx, "fy": fy, "cx": u - 1, "cy": v - 1}
    for key, names, counts in DISTORTION:
        if key not in holder:
            tell(f"{holder.at(key)} is missing; taken to be none")
        else:
            numbers = holder.array(key, f"{' or '.join(map(str, counts))} coefficients", counts)
            params |= dict(zip(names, numbers.tolist(), strict=False))
    return params


def _intrinsics(lens: Section) -> tuple[float, ...]:
    """fx, fy, skew and the principal point, MATLAB's pixels."""
    if "K" in lens or "IntrinsicMatrix" in lens:
        key = "K" if "K" in lens else "IntrinsicMatrix"
        K = lens.matrix(key, "a 3x3 matrix", 3, 3)
        K = K if key == "K" else K.T
        if [K[1, 0], *K[2]] != [0, 0, 0, 1]:
            shape = "[fx s cx; 0 fy cy; 0 0 1]" if key == "K" else "[fx 0 0; s fy 0; cx cy 1]"
            raise InvalidInput(f"{lens.at(key)} is no camera matrix; expected {shape}")
        return tuple(map(float, (K[0, 0], K[1, 1], K[0, 1], K[0, 2], K[1, 2])))
    fx, fy = lens.numbers("FocalLength", "[fx, fy]", 2)
    u, v = lens.numbers("PrincipalPoint", "[cx, cy]", 2)
    return fx, fy, lens.number("Skew", "0") if "Skew" in lens else 0.0, u, v


def _is_camera(values: Any) -> bool:
    return isinstance(values, dict) and bool(CAMERA_KEYS & values.keys())


def _recognises(source: Source) -> bool:
    if not source.keys:
        return False
    values = source.document.values
    has_pair = any(_is_camera(values.get(first)) and second in values for first, second in PAIRS)
    return has_pair or "CameraParameters1" in values


FORMAT = RigFormat("matlab", "MATLAB stereoParameters, or two cameras and a pose (JSON)", _recognises, _read)

CAMERA_FORMAT = CameraFormat(
    "matlab-camera",
    "MATLAB fisheyeParameters or cameraParameters (JSON; two files and a pose)",
    lambda source: bool(source.keys) and _is_camera(source.document.values),
    _read_posed,
)
