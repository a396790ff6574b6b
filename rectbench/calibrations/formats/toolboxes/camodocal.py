"""A camera as CamOdoCal writes it, the camera files of VINS-Mono, VINS-Fusion and KITTI-360 (YAML).

| model_type | numbers | here |
|---|---|---|
| PINHOLE | `projection_parameters` fx fy cx cy, `distortion_parameters` k1 k2 p1 p2 | pinhole |
| PINHOLE_FULL | the same, with k3 to k6 | pinhole |
| MEI | `mirror_parameters` xi, gamma1 gamma2 u0 v0, k1 k2 p1 p2 | unified |
| KANNALA_BRANDT | mu mv u0 v0, k2 k3 k4 k5 of r = theta + k2 theta^3 + ... | kannala-brandt |
| SCARAMUZZA | `poly_parameters`, `inv_poly_parameters`, `affine_parameters` ac ad ae cx cy | ocam |

Pixel (0, 0) is the centre of a pixel. Where the camera stands VINS-Mono's configuration says, which holds a
camera of its own: `extrinsicRotation` and `extrinsicTranslation`, or `body_T_cam0`, take its points to the
body (IMU), in metres. A file that is a camera alone does not say it. All but SCARAMUZZA are written, with a
third file for the pose.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2

from rectbench.calibrations.assembling import camera_of, rigid
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.ocamcalib import stretched
from rectbench.calibrations.layouts import layout_of
from rectbench.calibrations.pose_file import pose_text
from rectbench.cameras import Camera
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

RADTAN = {name: name for name in ("k1", "k2", "p1", "p2")}
PINHOLE = {name: name for name in ("fx", "fy", "cx", "cy")}
RATIONAL = RADTAN | {name: name for name in ("k3", "k4", "k5", "k6")}
AFFINE = {name: name for name in ("ac", "ad", "ae", "cx", "cy")}
MEI = {"gamma1": "fx", "gamma2": "fy", "u0": "cx", "v0": "cy"}
KANNALA_BRANDT = {"mu": "fx", "mv": "fy", "u0": "cx", "v0": "cy"}
KANNALA_BRANDT_RADIAL = {"k2": "k1", "k3": "k2", "k4": "k3", "k5": "k4"}
BODY = "body_T_cam0"
EXTRINSIC = ("extrinsicRotation", "extrinsicTranslation")

DISTORTION, PROJECTION, MIRROR = "distortion_parameters", "projection_parameters", "mirror_parameters"
WRITTEN: dict[str, tuple[str, dict[str, dict[str, str]]]] = {
    "PINHOLE": ("pinhole", {DISTORTION: RADTAN, PROJECTION: PINHOLE}),
    "PINHOLE_FULL": ("pinhole", {DISTORTION: RATIONAL, PROJECTION: PINHOLE}),
    "MEI": ("unified", {MIRROR: {"xi": "xi"}, DISTORTION: RADTAN, PROJECTION: MEI}),
    "KANNALA_BRANDT": ("kannala-brandt", {PROJECTION: KANNALA_BRANDT_RADIAL | KANNALA_BRANDT}),
}
"""The models that are written, and the sections of their numbers by CamOdoCal's and our names."""

MODELS = (*WRITTEN, "SCARAMUZZA")

MAX_POLYNOMIAL = 20
"""Coefficients of an inverse polynomial that CamOdoCal writes."""


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file; it does not tell its pose."""
    file = source.document
    file.knows("fisheye*", "estimate_extrinsic")  # VINS' mask, and whether it refines the pose
    kind = file.text("model_type", ", ".join(MODELS)).upper()
    if kind not in MODELS:
        raise file.fault("model_type", ", ".join(MODELS))
    size = file.sides("image_width", "image_height", given.size)
    model = "ocam" if kind == "SCARAMUZZA" else WRITTEN[kind][0]
    params = _scaramuzza(file) if kind == "SCARAMUZZA" else _parameters(file, kind)
    return PosedCamera(source.path, camera_of(source.path, model, size, params), _pose(file))


def _pose(file: Section) -> FloatArray | None:
    """T_body_camera [4, 4], or None where the file does not tell."""
    if BODY in file:
        return file.rigid(BODY, "the pose from camera to body, metres")
    if not all(key in file for key in EXTRINSIC):
        return None
    R_key, t_key = EXTRINSIC
    R = file.rotation(R_key, "a 3x3 rotation from camera to body")
    return rigid(R, file.array(t_key, "three metres", (3,)))


def _parameters(file: Section, kind: str) -> dict[str, Any]:
    sections = WRITTEN[kind][1]
    if kind == "KANNALA_BRANDT" and DISTORTION in file:
        # CamOdoCal puts all eight under projection_parameters; converters from Kalibr split them.
        sections = {PROJECTION: KANNALA_BRANDT, DISTORTION: KANNALA_BRANDT_RADIAL}
    return {name: n for key, names in sections.items() for name, n in _numbers(file, key, names).items()}


def _scaramuzza(file: Section) -> dict[str, Any]:
    affine = _numbers(file, "affine_parameters", AFFINE)
    return stretched(
        ((affine["ac"], affine["ad"]), (affine["ae"], 1.0)),
        (affine["cx"], affine["cy"]),
        _polynomial(file, "poly_parameters"),
        _polynomial(file, "inv_poly_parameters") if "inv_poly_parameters" in file else (),
        file.at("affine_parameters"),
    )


def _numbers(file: Section, key: str, names: Mapping[str, str]) -> dict[str, Any]:
    section = file.section(key, f"the numbers {' '.join(names)}")
    return {ours: section.number(theirs, "a number") for theirs, ours in names.items()}


def _polynomial(file: Section, key: str) -> tuple[float, ...]:
    section = file.section(key, "the coefficients p0, p1, ...")
    count = max((place + 1 for place in range(MAX_POLYNOMIAL) if f"p{place}" in section), default=1)
    return tuple(section.number(f"p{place}", "a coefficient") for place in range(count))


def camera_text(camera: Camera, side: str, format: str) -> str:
    """The file of a camera as `cv2.FileStorage` writes it; `format` is what a refusal calls it."""
    layouts = {
        kind: (model, [ours for names in sections.values() for ours in names.values()])
        for kind, (model, sections) in WRITTEN.items()
    }
    kind, equal = layout_of(camera, layouts, format, side)
    storage = cv2.FileStorage(".yml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("model_type", kind)
    storage.write("camera_name", side)
    storage.write("image_width", equal.width)
    storage.write("image_height", equal.height)
    for section, names in WRITTEN[kind][1].items():
        storage.startWriteStruct(section, cv2.FileNode_MAP)
        for theirs, ours in names.items():
            storage.write(theirs, equal.params[ours])
        storage.endWriteStruct()
    return storage.releaseAndGetString()


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """A file a camera, and one with the pose."""
    cameras = {"left": rig.left, "right": rig.right}
    files = {f"{side}.yaml": camera_text(camera, side, "camodocal") for side, camera in cameras.items()}
    return files | {"pose.yaml": pose_text(rig)}


FORMAT = CameraFormat(
    "camodocal",
    "CamOdoCal camera, as VINS and KITTI-360 use it (YAML; two files and a pose)",
    lambda source: "model_type" in source.keys and "cam0_calib" not in source.keys,
    read_posed,
    write=Writing(_texts, in_folder=True),
)
