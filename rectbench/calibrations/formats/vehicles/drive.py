"""NVIDIA DRIVE's rig JSON: `rig.sensors`, cameras with `properties` and `nominalSensor2Rig_FLU`.

Properties are words: `Model` ftheta, `width`, `height`, `cx`, `cy`, and `bw-poly`, or `polynomial` with its
`polynomial-type`, and `linear-c`, `-d`, `-e`. (0.5, 0.5) is the centre of the top-left pixel, as
DriveWorks' rays go through pixel + 0.5 - cx. `roll-pitch-yaw`, degrees about the fixed x, y and z, and `t`,
metres, take points of the sensor, x forward, y left, z up, to the rig; `correction_sensor_R_FLU` is turned
by before that, and `correction_rig_T` is added to t. Cameras go by their names.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.calibrations.assembling import rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, finite_number
from rectbench.calibrations.formats.named_cameras import by_name, rig_of_named, tell_missing
from rectbench.calibrations.formats.vehicles.f_theta_keys import f_theta_camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

POSE = "nominalSensor2Rig_FLU"
TURN, SHIFT = "correction_sensor_R_FLU", "correction_rig_T"
ANGLES = "roll-pitch-yaw"
TYPES = {"pixeldistance-to-angle": True, "angle-to-pixeldistance": False}
"""Whether a polynomial of this type is one in the distance."""

POLYNOMIALS = ("polynomial", "bw-poly", "fw-poly")
LINEAR = {"linear-c": 1.0, "linear-d": 0.0, "linear-e": 0.0}
R_FLU_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Turns a camera of x right, y down, z forward into the sensor's frame: x forward, y left, z up."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    rig = source.document.section("rig", "the rig's sensors")
    entries = rig.section_of_list("sensors")
    sensors = [entries.section(place, "a sensor") for place in entries.values]
    for sensor in sensors:
        if not _is_camera(sensor):
            sensor.knows("*")
    cameras = by_name(
        (sensor.text("name", "the sensor's name"), sensor) for sensor in sensors if _is_camera(sensor)
    )
    return rig_of_named(source, cameras, lambda sensor: _read_posed(sensor, given), given, unit="m")


def _is_camera(sensor: Section) -> bool:
    properties = sensor.values.get("properties")
    return isinstance(properties, dict) and {"Model", "cx", "cy"} <= properties.keys()


def _read_posed(sensor: Section, given: Given) -> PosedCamera:
    properties = sensor.section("properties", "the lens")
    properties.choice("Model", ("ftheta",))
    size = properties.sides("width", "height", given.size)
    centre = (properties.number("cx", "pixels") - 0.5, properties.number("cy", "pixels") - 0.5)
    key = next((key for key in POLYNOMIALS if key in properties), POLYNOMIALS[0])
    known = {"bw-poly": True, "fw-poly": False}
    by_distance = known[key] if key in known else TYPES[properties.choice("polynomial-type", TYPES)]
    tell_missing(properties, LINEAR, "those of no stretch: 1, 0, 0")
    linear = [
        properties.number(name, "a number") if name in properties else default
        for name, default in LINEAR.items()
    ]
    poly = _words(properties, key)
    properties.knows(*known)  # the other one is a fit to it
    camera = f_theta_camera(properties.where, size, centre, poly, by_distance, linear)
    return PosedCamera(sensor.where, camera, _pose(sensor))


def _words(section: Section, key: str) -> list[float]:
    words = section.text(key, "a polynomial's coefficients").split()
    numbers = [number for word in words if (number := finite_number(word)) is not None]
    if len(numbers) != len(words) or not numbers:
        raise section.fault(key, "a polynomial's coefficients")
    return numbers


def _pose(sensor: Section) -> FloatArray:
    """T_rig_camera [4, 4], metres."""
    nominal = sensor.section(POSE, f"{ANGLES} and t")
    if "quaternion" in nominal:
        raise InvalidInput(f"{nominal.at('quaternion')} is not read; expected {ANGLES} and t alone")
    tell_missing(sensor, (TURN, SHIFT), "0")
    R, t = _turn(nominal), np.array(nominal.numbers("t", "three metres", 3))
    if TURN in sensor:
        R = R @ _turn(sensor.section(TURN, ANGLES))
    if SHIFT in sensor:
        t = t + sensor.numbers(SHIFT, "three metres", 3)
    return rigid(R @ R_FLU_CAMERA, t)


def _turn(section: Section) -> FloatArray:
    angles = section.numbers(ANGLES, "three angles, degrees", 3)
    return Rotation.from_euler("xyz", angles, degrees=True).as_matrix()


def _recognises(source: Source) -> bool:
    rig = source.document.values.get("rig") if "rig" in source.keys else None
    sensors = rig.get("sensors") if isinstance(rig, dict) else None
    return isinstance(sensors, list) and any(
        isinstance(sensor, dict) and POSE in sensor for sensor in sensors
    )


FORMAT = RigFormat("drive", "NVIDIA DRIVE rig with f-theta cameras (JSON)", _recognises, _read, has_many=True)
