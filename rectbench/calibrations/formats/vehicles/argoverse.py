"""Argoverse's cameras: `vehicle_calibration_info.json` of the first, two tables as JSON of the second.

| | Argoverse 1 | Argoverse 2 |
|---|---|---|
| file | `camera_data_`, a list of `key`, `value` | `intrinsics`, `egovehicle_SE3_sensor`: `sensor_name` |
| lens | `focal_length_x_px_`, `focal_center_x_px_`, ... | `fx_px`, `fy_px`, `cx_px`, `cy_px`, ... |
| camera to vehicle, metres | `vehicle_SE3_camera_` | `qw` `qx` `qy` `qz` `tx_m` `ty_m` `tz_m` |

The tables of Argoverse 2 are Feather files; as JSON they are lists of rows, or pandas' columns. The images
of both are undistorted already (argoverse-api #81, av2-api #219), so the distortion in the files, that of
the cameras, is no part of the lens, which is told. Argoverse 1 tells no image size: 1920x1200 for its ring
cameras, 2464x2056 for its stereo pair. Pixel (0, 0) is the centre of a pixel. stereo_front_left and right
are left and right, unless others are asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rectbench.calibrations.assembling import camera_of, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.calibrations.formats.named_cameras import by_name, quaternion_rotation, rig_of_named
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

FIRST = "camera_data_"
SIZES = {"ring": (1920, 1200), "stereo": (2464, 2056)}
PREFIX = "image_raw_"
PAIR = ("stereo_front_left", "stereo_front_right")
LENS, POSE = {"sensor_name", "fx_px", "cx_px"}, {"sensor_name", "qw", "tx_m"}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    lenses = [source for source in sources if _rows(source, LENS)]
    if not any(FIRST in source.keys for source in sources):
        return _second(lenses, sources, given)
    source = single(sources)
    entries = source.document.section_of_list(FIRST)
    sections = [entries.section(place, "a camera") for place in entries.values]
    cameras = by_name(
        (section.text("key", "the camera's name").removeprefix(PREFIX), section) for section in sections
    )
    return rig_of_named(source, cameras, lambda entry: _read_first(entry, given), given, "m", [PAIR])


def _read_first(entry: Section, given: Given) -> PosedCamera:
    name = entry.text("key", "the camera's name").removeprefix(PREFIX)
    value = entry.section("value", "a camera")
    if value.values.get("skew_"):
        raise value.fault("skew_", "0")
    params = {
        f"{ours}{axis}": value.number(f"focal_{theirs}_{axis}_px_", "pixels")
        for ours, theirs in (("f", "length"), ("c", "center"))
        for axis in "xy"
    }
    _tell(value, value.values.get("distortion_coefficients_"), "distortion_coefficients_")
    size = given.size or SIZES.get(name.partition("_")[0])
    if size is None:
        raise InvalidInput(
            f"{value.where}: tells no image size; expected `{argument('size')}` beside the file"
        )
    pose = value.section("vehicle_SE3_camera_", "rotation and translation")
    rotation = pose.section("rotation", "coefficients")
    T = rigid(
        quaternion_rotation(rotation.at("coefficients"), rotation.numbers("coefficients", "w, x, y, z", 4)),
        pose.numbers("translation", "three metres", 3),
    )
    return PosedCamera(value.where, camera_of(value.where, "pinhole", size, params), T)


def _second(lenses: list[Source], sources: Sequence[Source], given: Given) -> Rig:
    poses = [source for source in sources if _rows(source, POSE)]
    if len(lenses) != 1 or len(poses) != 1:
        raise InvalidInput(
            f"{sources[0].path}: is one of {len(lenses)} tables of intrinsics and {len(poses)} of poses; "
            "expected one of each, intrinsics and egovehicle_SE3_sensor"
        )
    places = {row.text("sensor_name", "a name"): row for row in _rows(poses[0], POSE)}
    rows = by_name((row.text("sensor_name", "a name"), row) for row in _rows(lenses[0], LENS))

    def read(row: Section) -> PosedCamera:
        name = row.text("sensor_name", "a name")
        if name not in places:
            raise InvalidInput(f"{poses[0].path}: has no sensor {name}; expected its pose in the vehicle")
        return PosedCamera(row.where, _read_lens(row, given), _read_pose(places[name]))

    return rig_of_named(lenses[0], rows, read, given, "m", [PAIR])


def _read_lens(row: Section, given: Given) -> Camera:
    params = {name: row.number(f"{name}_px", "pixels") for name in ("fx", "fy", "cx", "cy")}
    _tell(row, [row.values.get(name) for name in ("k1", "k2", "k3")], "k1, k2, k3")
    return camera_of(row.where, "pinhole", row.sides("width_px", "height_px", given.size), params)


def _read_pose(row: Section) -> FloatArray:
    wxyz = [row.number(f"q{part}", "a part of a unit quaternion") for part in "wxyz"]
    t = [row.number(f"t{axis}_m", "metres") for axis in "xyz"]
    return rigid(quaternion_rotation(row.at("qw"), wxyz), t)


def _tell(section: Section, distortion: Any, key: str) -> None:
    if isinstance(distortion, list) and any(distortion):
        tell(f"{section.at(key)}: left out, as Argoverse's images are undistorted")


def _rows(source: Source, marks: set[str]) -> list[Section]:
    """The rows of a table with these columns; none of another file."""
    rows = list(source.records)
    if not rows and source.keys >= marks:
        columns = source.document.values
        if all(isinstance(column, dict) for column in columns.values()):
            keys = list(columns["sensor_name"])
            rows = [
                Section(source.path, f"{key}.", {name: column.get(key) for name, column in columns.items()})
                for key in keys
            ]
    return rows if rows and rows[0].values.keys() >= marks else []


def _recognises(source: Source) -> bool:
    return FIRST in source.keys or bool(_rows(source, LENS) or _rows(source, POSE))


FORMAT = RigFormat("argoverse", "Argoverse 1 and 2 vehicle cameras (JSON)", _recognises, _read, has_many=True)
