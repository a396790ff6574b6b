"""The TOML of anipose and aniposelib, freemocap and caliscope: a table a camera.

Keys are `size`, `matrix`, `distortions` (OpenCV's, of a pinhole, or with `fisheye = true` of its fisheye),
`rotation` (a rotation vector) and `translation`, which take points of the world to the camera, in the unit
of the calibration board, often millimetres. Left and right are the first two tables, or those asked for by
the table's name or the `name` in it. caliscope has the tables under `cameras`. Pixel (0, 0) is the centre of
a pixel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rectbench.calibrations.assembling import Pair, chosen, inverse, rig_of_posed, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv import ORDERS, check_pinhole, opencv_camera
from rectbench.calibrations.pose_file import read_rotation
from rectbench.rigs.rig import Rig

KEYS = {"matrix", "distortions", "translation"}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    tables = file if _tables(file.values) else file.section("cameras", "a table a camera")
    cameras = {name: tables.section(name, "a camera") for name in _tables(tables.values)}
    if given.cameras and not set(given.cameras) <= cameras.keys():
        cameras = {str(camera.values.get("name", name)): camera for name, camera in cameras.items()}

    def rig_of(names: Pair) -> Rig:
        return rig_of_posed([_read_posed(cameras[name], given) for name in names], given, source.name)

    return rig_of(chosen(list(cameras), given, source.path, rig_of))


def _tables(values: Mapping[str, Any]) -> list[str]:
    """The names of the tables that are cameras."""
    return [name for name, table in values.items() if isinstance(table, dict) and table.keys() >= KEYS]


def _read_posed(section: Section, given: Given) -> PosedCamera:
    lens = "fisheye" if str(section.values.get("fisheye", False)).lower() == "true" else "pinhole"
    size = section.size("size", given.size)
    camera = opencv_camera(section, "matrix", "distortions", lens, size, section.where)
    if lens == "pinhole":
        _check_pinhole(section, [camera.params[name] for name in ORDERS[lens]])
    R = read_rotation(section, "rotation")
    t = section.array("translation", "three numbers in the board's unit", (3,))
    return PosedCamera(section.where, camera, inverse(rigid(R, t)))


def _check_pinhole(section: Section, coefficients: list[float]) -> None:
    """Four are a fisheye's in all that anipose writes itself, which then says so."""
    is_usual = "fisheye" in section or len(section.array("distortions", "coefficients", range(1, 15))) != 4
    named = dict(zip(ORDERS["pinhole"], coefficients, strict=True))
    check_pinhole(section.at("distortions"), named, "`fisheye = true` or `fisheye = false`", is_usual)


def _recognises(source: Source) -> bool:
    if not source.keys:
        return False
    values = source.document.values
    inner = values.get("cameras")
    return bool(_tables(values) or (isinstance(inner, dict) and _tables(inner)))


FORMAT = RigFormat(
    "anipose", "anipose, freemocap and caliscope calibration (TOML)", _recognises, _read, has_many=True
)
