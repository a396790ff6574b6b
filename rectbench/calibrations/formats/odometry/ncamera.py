"""The `ncamera` YAML of maplab, aslam and SVO: a list of cameras, each with its pose in the body.

`T_B_C` takes points of the camera to the body, in metres (`T_C_B` its inverse). maplab's sensor files hold
the same under `sensors`, as the sensor of type NCAMERA. The projections are those of aslam_cv2; pixel (0, 0)
is the centre of a pixel. Left and right are the first two, or those asked for: cam0, cam1, ... by places.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rectbench.calibrations.assembling import camera_of, inverse, rig_of_list, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.calibrations.formats.odometry.kalibr import LAYOUTS, Layout
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

PROJECTIONS = {"pinhole": "pinhole", "unified-projection": "omni"}
DISTORTIONS = {"none": "none", "radial-tangential": "radtan", "equidistant": "equi", "fisheye": "fov"}
"""What Kalibr calls these; aslam's `fisheye` is the field-of-view model with its one angle."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    return rig_of_list(source, _cameras(source), _read_posed, given)


def _cameras(source: Source) -> Section:
    """The list of cameras, by their places."""
    file = source.document
    if "cameras" in file:
        return file.section_of_list("cameras")
    sensors = file.section_of_list("sensors")
    for place, sensor in sensors.values.items():
        if _is_rig(sensor):
            return sensors.section(place, "a sensor").section_of_list("cameras")
    raise InvalidInput(f"{file.at('sensors')} holds no sensor with cameras; expected one of type NCAMERA")


def _read_posed(entry: Section, given: Given) -> PosedCamera:
    section = entry.section("camera", "a camera")
    layout = _layout(section)
    params = _numbers(section, "intrinsics", layout.intrinsics)
    if layout.distortion:
        params |= _numbers(section.section("distortion", "its parameters"), "parameters", layout.distortion)
    size = section.sides("image_width", "image_height", given.size)
    camera = camera_of(entry.at("camera"), layout.model, size, params)
    if "T_C_B" in entry and "T_B_C" not in entry:
        T_body_camera = inverse(entry.rigid("T_C_B", "the pose from body to camera, metres"))
    else:
        T_body_camera = entry.rigid("T_B_C", "the pose from camera to body, metres")
    return PosedCamera(entry.at("camera"), camera, T_body_camera)


def _layout(section: Section) -> Layout:
    projection = section.text("type", " or ".join(PROJECTIONS))
    known = [theirs for theirs, ours in DISTORTIONS.items() if (PROJECTIONS.get(projection), ours) in LAYOUTS]
    if not known:
        raise section.fault("type", " or ".join(PROJECTIONS))
    distortion = "none"
    if "distortion" not in section:
        tell(f"{section.at('distortion')} is missing; taken to be none")
    else:
        distortions = section.section("distortion", "its type and parameters")
        distortion = distortions.text("type", ", ".join(known))
        if distortion not in known:
            raise distortions.fault("type", f"{', '.join(known)} with {projection}")
    return LAYOUTS[PROJECTIONS[projection], DISTORTIONS[distortion]]


def _numbers(section: Section, key: str, names: tuple[str, ...]) -> dict[str, float]:
    numbers = section.array(key, f"{len(names)} finite numbers ({' '.join(names)})", (len(names),))
    return dict(zip(names, numbers.tolist(), strict=True))


def _is_rig(values: Any) -> bool:
    cameras = values.get("cameras") if isinstance(values, dict) else None
    return isinstance(cameras, list) and any(isinstance(item, dict) and "camera" in item for item in cameras)


def _recognises(source: Source) -> bool:
    if not source.keys & {"cameras", "sensors"}:
        return False
    values = source.document.values
    sensors = values.get("sensors")
    return _is_rig(values) or (isinstance(sensors, list) and any(map(_is_rig, sensors)))


FORMAT = RigFormat("ncamera", "maplab, aslam and SVO camera rig (YAML)", _recognises, _read, has_many=True)
