"""COLMAP's sparse model: `cameras.txt` or `.bin`, with the `images` or `rigs` file beside it.

The two cameras are those of two images, the ones asked for or else the first two of the file; or, where
no images are asked for and there is a `rigs` file with a rig of several cameras, that rig's reference
(left) and its next camera (right). A pose takes points of the world, or of the rig, to the camera:
a quaternion w x y z and a translation. COLMAP puts (0.5, 0.5) on the centre of the top-left pixel, half
a pixel further than rectbench. Its scale is arbitrary unless something fixed it, which no file tells.

| COLMAP's model | here |
|---|---|
| SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV, BROWN_CONRADY | pinhole |
| OPENCV_FISHEYE, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE | kannala-brandt |
| SIMPLE_FISHEYE, FISHEYE | equidistant |
| FOV, EUCM | field-of-view, extended-unified |
| THIN_PRISM_FISHEYE, RAD_TAN_THIN_PRISM_FISHEYE | thin-prism-fisheye, fisheye624 |
| SIMPLE_DIVISION, DIVISION | division |

EQUIRECTANGULAR, a panorama and no lens, is refused. Written is a text model of two images, left.png and
right.png, in metres.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.calibrations.assembling import camera_of, inverse, pose_matrix, rigid
from rectbench.calibrations.contract import UNITS, Given, RigFormat
from rectbench.calibrations.documents import Source, agreed_size, errors_at, one_line, shown, tell
from rectbench.calibrations.formats.photogrammetry.colmap_files import (
    CameraRecord,
    ImageRecord,
    Pose,
    SensorRecord,
    read_cameras,
    read_images,
    read_rigs,
)
from rectbench.calibrations.layouts import layout_of
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, UnknownName
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

SIMPLE = ("f", "cx", "cy")
FOCAL = ("fx", "fy", "cx", "cy")
RADTAN = ("k1", "k2", "p1", "p2")
PRISM_FISHEYE = (*RADTAN, "k3", "k4", "sx1", "sy1")
FISHEYE624 = ("k0", "k1", "k2", "k3", "k4", "k5", "p0", "p1", "s0", "s1", "s2", "s3")

MODELS: dict[str, tuple[str, tuple[str, ...]]] = {
    "SIMPLE_PINHOLE": ("pinhole", SIMPLE),
    "PINHOLE": ("pinhole", FOCAL),
    "SIMPLE_RADIAL": ("pinhole", (*SIMPLE, "k1")),
    "RADIAL": ("pinhole", (*SIMPLE, "k1", "k2")),
    "OPENCV": ("pinhole", (*FOCAL, *RADTAN)),
    "OPENCV_FISHEYE": ("kannala-brandt", (*FOCAL, "k1", "k2", "k3", "k4")),
    "FULL_OPENCV": ("pinhole", (*FOCAL, *RADTAN, "k3", "k4", "k5", "k6")),
    "FOV": ("field-of-view", (*FOCAL, "omega")),
    "SIMPLE_RADIAL_FISHEYE": ("kannala-brandt", (*SIMPLE, "k1")),
    "RADIAL_FISHEYE": ("kannala-brandt", (*SIMPLE, "k1", "k2")),
    "THIN_PRISM_FISHEYE": ("thin-prism-fisheye", (*FOCAL, *PRISM_FISHEYE)),
    "RAD_TAN_THIN_PRISM_FISHEYE": ("fisheye624", (*FOCAL, *FISHEYE624)),
    "SIMPLE_DIVISION": ("division", (*SIMPLE, "k")),
    "DIVISION": ("division", (*FOCAL, "k")),
    "SIMPLE_FISHEYE": ("equidistant", SIMPLE),
    "FISHEYE": ("equidistant", FOCAL),
    "EUCM": ("extended-unified", (*FOCAL, "alpha", "beta")),
    "EQUIRECTANGULAR": ("", ("w", "h")),
    "BROWN_CONRADY": ("pinhole", (*SIMPLE, "k1", "k2", "k3", "p1", "p2")),
}
"""Projection model and parameters, in COLMAP's order; a binary file calls the first 18 by their place."""

NUMBERED = {place: (name, len(MODELS[name][1])) for place, name in enumerate(list(MODELS)[:18])}

LAYOUTS = {name: layout for name, layout in MODELS.items() if "fx" in layout[1]}
"""The models that are written; those with one focal length are special cases of them."""

CAMERA_LINE = re.compile(r"^\s*\d+\s+[A-Z][A-Z0-9_]*\s+\d+\s+\d+\s+[-+.\d]", re.MULTILINE)
OTHER_FILES = ("images", "rigs", "frames", "points3d", "project")
"""What a model's other files begin with."""

QUATERNION_TOLERANCE = 1e-2
"""How far from 1 a quaternion's length may be; COLMAP's own text of an old version has six digits."""


@dataclass(frozen=True)
class _PlacedCamera:
    """A camera of the model, where it stands, and what an error or the rig's source calls it."""

    where: str
    name: str
    camera: int
    T_camera_common: FloatArray


def read_colmap(
    path: str | os.PathLike[str], images: Sequence[str] = (), size: Any = None, unit: str | None = None
) -> Rig:
    """The rig of two images, or of the rig file, of the model whose cameras file is `path`.

    Parameters
    ----------
    path : `cameras.txt` or `cameras.bin`.
    images : names of the left and the right image as COLMAP has them, or their last parts; none of
        them for the rig file's rig, or the first two images.
    size : what the size of both images must be, if given.
    unit : what the model's translations are in, a key of `UNITS`; metres where left out.

    Raises InvalidInput in one line that names file, record and what was expected.
    """
    cameras_file = Path(path)
    pair = _images_named(cameras_file, images) if images else _pair(cameras_file)
    cameras = read_cameras(cameras_file, {placed.camera for placed in pair}, NUMBERED)
    left, right = (_camera(cameras_file, cameras, placed, size) for placed in pair)
    T = pair[1].T_camera_common @ inverse(pair[0].T_camera_common)
    names = " and ".join(
        f"{one_line(placed.name)} ({side})" for placed, side in zip(pair, ("left", "right"), strict=True)
    )
    scale = f"taken to be in {unit}" if unit else "arbitrary unless something fixed it"
    with errors_at(" and ".join(dict.fromkeys(placed.where for placed in pair))):
        return Rig(
            left,
            right,
            T[:3, :3],
            UNITS[unit or "m"] * T[:3, 3],
            name=one_line(cameras_file.resolve().parent.name) or cameras_file.stem,
            source=f"COLMAP, {names}. Its scale is the model's, {scale}.",
        )


def _pair(cameras_file: Path) -> tuple[_PlacedCamera, _PlacedCamera]:
    """Two cameras of the rig file, where there is one with a rig of several, or the first two images."""
    rigs_file = _beside(cameras_file, "rigs")
    if rigs_file.is_file():
        for sensors in read_rigs(rigs_file):
            posed = [sensor for sensor in sensors if sensor.pose is not None]
            if len(posed) > 1:
                _tell_more(rigs_file, len(posed), "cameras of its rig")
                return _of_sensor(posed[0]), _of_sensor(posed[1])
    images_file = _beside(cameras_file, "images")
    first = list(islice(read_images(images_file), 3))
    if len(first) < 2:
        raise InvalidInput(f"{images_file}: holds {len(first)} images; expected two at least")
    _tell_more(images_file, len(first), f"images, {one_line(first[0].name)} and {one_line(first[1].name)}")
    return _of_image(first[0]), _of_image(first[1])


def _tell_more(file: Path, count: int, what: str) -> None:
    if count > 2:
        tell(f"{file}: the first two {what} are taken; others by `cameras=` (--cameras LEFT,RIGHT)")


def _images_named(cameras_file: Path, names: Sequence[str]) -> tuple[_PlacedCamera, _PlacedCamera]:
    images_file = _beside(cameras_file, "images")
    if len(names) != 2:
        raise InvalidInput(f"{images_file}: {len(names)} images are asked for; expected two, left and right")
    exact: dict[str, ImageRecord] = {}
    ending: dict[str, list[ImageRecord]] = {name: [] for name in names}
    for image in read_images(images_file):
        for name in names:
            if image.name == name:
                exact.setdefault(name, image)
            elif _ends_alike(image.name, name):
                ending[name].append(image)
        if len(exact) == len(set(names)):
            break
    left, right = (_found(images_file, name, exact, ending) for name in names)
    if left.where == right.where:
        raise InvalidInput(f"{left.where}: is asked for as left and as right; expected two images")
    return left, right


def _ends_alike(one: str, other: str) -> bool:
    """Whether one path is the last part of the other."""
    parts, others = (path.replace("\\", "/").split("/")[::-1] for path in (one, other))
    return all(a == b for a, b in zip(parts, others, strict=False))


def _found(
    file: Path, name: str, exact: dict[str, ImageRecord], ending: dict[str, list[ImageRecord]]
) -> _PlacedCamera:
    if name in exact:
        return _of_image(exact[name])
    if len(ending[name]) != 1:
        found = "no" if not ending[name] else f"{len(ending[name])} images that could be"
        raise InvalidInput(f"{file}: holds {found} {one_line(name)!r}; expected one image of that name")
    return _of_image(ending[name][0])


def _of_image(image: ImageRecord) -> _PlacedCamera:
    return _PlacedCamera(image.where, f"image {image.name}", image.camera, _rigid(image.pose, image.where))


def _of_sensor(sensor: SensorRecord) -> _PlacedCamera:
    pose = _rigid(sensor.pose or (), sensor.where)
    return _PlacedCamera(sensor.where, f"the rig's camera {sensor.camera}", sensor.camera, pose)


def _rigid(pose: Pose, where: str) -> FloatArray:
    w, x, y, z, *t = pose
    if not np.isfinite(pose).all():
        raise InvalidInput(f"{where}: has the pose {shown(list(pose))}; expected finite numbers")
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm([w, x, y, z]))
    if not abs(length - 1) < QUATERNION_TOLERANCE:
        raise InvalidInput(f"{where}: qw qx qy qz have the length {length:g}; expected 1")
    return rigid(Rotation.from_quat([x, y, z, w]).as_matrix(), t)


def _camera(file: Path, cameras: dict[int, CameraRecord], placed: _PlacedCamera, size: Any) -> Camera:
    if placed.camera not in cameras:
        raise InvalidInput(f"{placed.where}: its camera {placed.camera} is missing; expected it in {file}")
    record = cameras[placed.camera]
    model, names = _model(record)
    if len(record.params) != len(names):
        raise InvalidInput(
            f"{record.where}: has {len(record.params)} parameters; expected {len(names)} ({' '.join(names)})"
        )
    params = dict(zip(names, record.params, strict=True))
    if "f" in params:
        params["fx"] = params["fy"] = params.pop("f")
    params["cx"] -= 0.5
    params["cy"] -= 0.5
    return camera_of(record.where, model, agreed_size(record.where, record.size, size), params)


def _model(record: CameraRecord) -> tuple[str, tuple[str, ...]]:
    with errors_at(record.where):
        if record.model not in MODELS:
            raise UnknownName("COLMAP camera model", one_line(record.model), MODELS)
        if not MODELS[record.model][0]:
            raise InvalidInput(f"{record.model} is a panorama; expected a lens")
    return MODELS[record.model]


def _beside(cameras_file: Path, kind: str) -> Path:
    """The model's file of another kind, of the same suffix."""
    name = cameras_file.name
    return cameras_file.with_name(
        name.replace("cameras", kind) if "cameras" in name else f"{kind}{cameras_file.suffix}"
    )


def _recognises(source: Source) -> bool:
    name = Path(source.path).name.lower()
    if name.startswith(OTHER_FILES):
        return False
    if name.endswith(".bin"):
        return name == "cameras.bin" or _looks_binary(source.content)
    return b"\0" not in source.content[:4096] and _looks_text(source)


def _looks_text(source: Source) -> bool:
    uncommented = re.sub(r"^\s*#.*$", "", source.head, flags=re.MULTILINE).lstrip()
    return bool(CAMERA_LINE.match(uncommented)) or "# Camera list with one line" in source.head


def _looks_binary(content: bytes) -> bool:
    if len(content) < 32:
        return False
    count, _, model, width, height = struct.unpack("<QIiQQ", content[:32])
    return 0 < count < 1 << 32 and model in NUMBERED and max(width, height) < 1 << 20


def _read(sources: Sequence[Source], given: Given) -> Rig:
    """The model among the sources, which may hold its other files too."""
    found = [source.path for source in sources if _recognises(source)]
    unrecognised = [
        source.path
        for source in sources
        if source.path not in found and not Path(source.path).name.lower().startswith(OTHER_FILES)
    ]
    # COLMAP too prefers the binary files where there are both.
    binary = [path for path in found if path.lower().endswith(".bin")]
    path, *more = [*(binary or found), *unrecognised]
    if more:
        raise InvalidInput(f"{path}: is read together with {more[0]}; expected one COLMAP model")
    return read_colmap(path, given.cameras or (), given.size, given.unit)


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """A text model of two images, the left one's camera in the world's place, and of no points."""
    poses = (("left", rig.left, np.eye(4)), ("right", rig.right, pose_matrix(rig)))
    cameras = [_camera_line(number, camera, side) for number, (side, camera, _) in enumerate(poses, 1)]
    images = [_image_line(number, f"{side}.png", T) for number, (side, _, T) in enumerate(poses, 1)]
    return {
        "cameras.txt": "# Camera list with one line of data per camera:\n"
        "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n" + "".join(cameras),
        "images.txt": "# Image list with two lines of data per image:\n"
        "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
        "#   POINTS2D[] as (X, Y, POINT3D_ID)\n" + "".join(images),
        "points3D.txt": "# 3D point list with one line of data per point:\n"
        "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n",
    }


def _camera_line(number: int, camera: Camera, side: str) -> str:
    model, equal = layout_of(camera, LAYOUTS, "colmap", side)
    params = dict(equal.params)
    params["cx"] += 0.5
    params["cy"] += 0.5
    numbers = " ".join(repr(params[name]) for name in LAYOUTS[model][1])
    return f"{number} {model} {equal.width} {equal.height} {numbers}\n"


def _image_line(number: int, name: str, T_camera_world: FloatArray) -> str:
    x, y, z, w = Rotation.from_matrix(T_camera_world[:3, :3]).as_quat()
    pose = " ".join(repr(float(value)) for value in (w, x, y, z, *T_camera_world[:3, 3]))
    return f"{number} {pose} {number} {name}\n\n"


FORMAT = RigFormat(
    "colmap",
    "COLMAP sparse model: cameras and images or rigs (.txt, .bin)",
    _recognises,
    _read,
    has_many=True,
    write=Writing(_texts, in_folder=True),
)
