"""nerfstudio's and instant-ngp's `transforms.json`: `frames`, each with a pose and, or the file, a lens.

`transform_matrix` takes points of the camera, x right, y up, z back, to the world. w h fl_x fl_y cx cy
(pixels) and the lens stand at the top or in each frame; without fl_x, `camera_angle_x` is the field of view
of a perspective image. (0.5, 0.5) is the centre of the top-left pixel, as in COLMAP, from which these files
mostly come, and where both programs shoot their rays; nerfstudio takes the half pixel off for OpenCV.
Translations are divided by `applied_scale`; their scale is arbitrary, which is told.

| `camera_model` | here |
|---|---|
| SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, or none: k1 k2 k3 p1 p2 | pinhole |
| OPENCV_FISHEYE, or `is_fisheye`: k1 k2 k3 k4 | kannala-brandt |
| `ftheta_p0` ... `ftheta_p4`, the angle by powers of the pixels | f-theta |

The frames' images are the cameras' names, or the last part of one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, shown, tell
from rectbench.calibrations.formats.named_cameras import (
    Y_UP_Z_BACK,
    by_name,
    rig_of_named,
    tell_missing,
    told_scale,
)
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

PERSPECTIVE = ("SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV")
MODELS = (*PERSPECTIVE, "OPENCV_FISHEYE")
ORDERS = {"pinhole": ("k1", "k2", "k3", "p1", "p2"), "kannala-brandt": ("k1", "k2", "k3", "k4")}
EXPECTED = {
    "SIMPLE_RADIAL": ("k1",),
    "RADIAL": ("k1", "k2"),
    "OPENCV": ("k1", "k2", "p1", "p2"),
    "OPENCV_FISHEYE": ("k1", "k2", "k3", "k4"),
}
UNSTATED = {"pinhole": EXPECTED["OPENCV"], "kannala-brandt": EXPECTED["OPENCV_FISHEYE"]}
"""The coefficients that a model has, and a lens with any whose model is not stated.

One that is missing is 0 to nerfstudio.
"""

DISTORTION = ("k1", "k2", "k3", "k4", "p1", "p2")
F_THETA = tuple(f"ftheta_p{power}" for power in range(6))
FORWARD = tuple(f"ftheta_f{power}" for power in range(6))
"""The fit of the distance by powers of the angle, which some add and neither program takes."""

REFERENCE = "PIXELDIST_TO_ANGLE"
"""Which way the polynomial of an f-theta lens goes, in files that say it."""

PANORAMAS = ("latlong", "equirectangular", "orthographic")
LENS = (
    *("camera_model", "is_fisheye", "w", "h", "fl_x", "fl_y", "cx", "cy", "camera_angle_x", "camera_angle_y"),
    *("x_fov", "y_fov", *DISTORTION, *F_THETA, *PANORAMAS, "k5", "k6", "reference_poly"),
)
"""The keys of a lens, at the top or in a frame."""

OTHER_KEYS = (
    *("transform_matrix", "transform_matrix_start", "transform_matrix_end", "orientation_override", "offset"),
    *("applied_transform", "applied_scale", *FORWARD),
)
"""What else may look like a key of a lens or a pose; `offset` places the scene in instant-ngp's cube."""

AGREEMENT = 1e-3
"""Relative difference up to which a field of view and a focal length say the same."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    entries = file.section_of_list("frames")
    frames = [entries.section(place, "a frame") for place in entries.values]
    cameras = by_name((frame.text("file_path", "the image's name"), frame) for frame in frames)
    unit = told_scale(source.path, given)
    return rig_of_named(source, cameras, lambda frame: _read_posed(file, frame, given), given, unit)


def _read_posed(file: Section, frame: Section, given: Given) -> PosedCamera:
    T = frame.rigid("transform_matrix", "the pose from camera to world").copy()
    scale = file.number("applied_scale", "a number above 0") if "applied_scale" in file else 1.0
    if not scale > 0:
        raise file.fault("applied_scale", "a number above 0")
    T[:3, 3] /= scale
    return PosedCamera(frame.where, _camera(_lens(file, frame), given), T @ Y_UP_Z_BACK)


def _lens(file: Section, frame: Section) -> Section:
    """The keys of the frame's lens, its own and the file's, which may not disagree."""
    for section in (file, frame):
        section.knows(*LENS, *OTHER_KEYS)
    values = {key: file.values[key] for key in LENS if key in file}
    for key in LENS:
        if key in frame and values.setdefault(key, frame.values[key]) != frame.values[key]:
            raise frame.fault(key, f"{shown(values[key])}, as at the top of the file")
    return Section(frame.file, frame.key, values)


def _camera(lens: Section, given: Given) -> Camera:
    for key in PANORAMAS:
        if lens.values.get(key):
            raise InvalidInput(f"{lens.at(key)} is no lens; expected a perspective or fisheye image")
    size = lens.sides("w", "h", given.size)
    cx, cy = (
        lens.number(key, "pixels") if key in lens else side / 2
        for key, side in zip(("cx", "cy"), size, strict=True)
    )
    tell_missing(lens, ("cx", "cy"), "the image's centre")
    centre = {"cx": cx - 0.5, "cy": cy - 0.5}
    if F_THETA[0] in lens:
        return camera_of(lens.where, "f-theta", size, centre | {"angle_poly": _angle_poly(lens)})
    model = _model(lens)
    fx = _focal(lens, "x", size[0])
    if fx is None:
        raise lens.fault("fl_x", "the focal length, pixels, or camera_angle_x")
    fy = _focal(lens, "y", size[1])
    if fy is None:
        tell_missing(lens, ["fl_y"], "fl_x")
    focal = {"fx": fx, "fy": fx if fy is None else fy}
    return camera_of(lens.where, model, size, centre | focal | _distortion(lens, model))


def _angle_poly(lens: Section) -> list[float]:
    if lens.values.get("reference_poly", REFERENCE) != REFERENCE:
        raise lens.fault("reference_poly", REFERENCE)
    keys = F_THETA if F_THETA[-1] in lens else F_THETA[:-1]  # instant-ngp's own have five
    constant, *poly = (lens.number(key, "a coefficient") for key in keys)
    if constant != 0:
        raise lens.fault(F_THETA[0], "0, the angle at the centre")
    return poly


def _model(lens: Section) -> str:
    name = lens.choice("camera_model", MODELS) if "camera_model" in lens else ""
    is_fisheye = lens.values.get("is_fisheye", name == "OPENCV_FISHEYE")
    if not isinstance(is_fisheye, bool) or (name and is_fisheye != (name == "OPENCV_FISHEYE")):
        raise lens.fault("is_fisheye", f"true or false, as camera_model {shown(name)} has it")
    return "kannala-brandt" if is_fisheye else "pinhole"


def _focal(lens: Section, axis: str, side: int) -> float | None:
    """The focal length along an axis, pixels, stated or of the field of view; None where there is neither."""
    stated = lens.number(f"fl_{axis}", "pixels") if f"fl_{axis}" in lens else None
    angle = lens.number(f"camera_angle_{axis}", "radians") if f"camera_angle_{axis}" in lens else None
    if angle is None and f"{axis}_fov" in lens:
        angle = math.radians(lens.number(f"{axis}_fov", "degrees"))
    if angle is not None and not 0 < angle < math.pi:
        raise lens.fault(f"camera_angle_{axis}", "a field of view below 180°, radians")
    seen = None if angle is None else 0.5 * side / math.tan(0.5 * angle)
    if stated is not None and seen is not None and abs(seen - stated) > AGREEMENT * abs(stated):
        tell(
            f"{lens.at(f'fl_{axis}')} is {stated:.6g} px, where the field of view makes it {seen:.6g} px; "
            "the former counts"
        )
    return seen if stated is None else stated


def _distortion(lens: Section, model: str) -> dict[str, float]:
    params = {name: lens.number(name, "a coefficient") for name in DISTORTION if name in lens}
    expected = EXPECTED.get(str(lens.values.get("camera_model")), UNSTATED[model] if params else ())
    tell_missing(lens, expected, "0")
    for name, number in params.items():
        if number != 0 and name not in ORDERS[model]:
            raise lens.fault(name, f"0, as {model} has no {name} here")
    for name in ("k5", "k6"):
        if lens.values.get(name):
            raise lens.fault(name, "0, as these programs have no such term")
    return {name: number for name, number in params.items() if name in ORDERS[model]}


def _recognises(source: Source) -> bool:
    if "frames" not in source.keys:
        return False
    frames = source.document.values["frames"]
    return isinstance(frames, list) and any(
        isinstance(frame, dict) and "transform_matrix" in frame for frame in frames
    )


FORMAT = RigFormat(
    "transforms",
    "nerfstudio and instant-ngp transforms.json",
    _recognises,
    _read,
    has_many=True,
)
