"""The cameras of NVIDIA's NuRec scenes, which CARLA replays: `camera_calibrations` of a rig's trajectories.

A camera has `T_sensor_rig`, which takes its points (x right, y down, z forward) to the rig, metres, and a
`camera_model` of type ftheta: `reference_poly` says which of `pixeldist_to_angle_poly` and
`angle_to_pixeldist_poly` the lens is, `linear_cde` how the sensor is stretched, `max_angle` where the image
ends, radians. Pixel (0, 0) is the centre of a pixel, which 3DGUT's FThetaCameraModel says of these
parameters. Cameras go by their `logical_sensor_name`. A rolling shutter is left out.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from rectbench.calibrations.assembling import single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.named_cameras import by_name, rig_of_named, tell_missing
from rectbench.calibrations.formats.vehicles.f_theta_keys import f_theta_camera
from rectbench.rigs.rig import Rig

CAMERAS = "camera_calibrations"
POLYNOMIALS = {
    "PIXELDIST_TO_ANGLE": ("pixeldist_to_angle_poly", True),
    "ANGLE_TO_PIXELDIST": ("angle_to_pixeldist_poly", False),
}
"""The key of a reference polynomial, and whether it is one in the distance."""

MAX_COEFFICIENTS = 12
KEYS = (
    *("resolution", "shutter_type", "principal_point", "reference_poly", "max_angle", "linear_cde"),
    *("external_distortion_parameters", *(key for key, _ in POLYNOMIALS.values())),
)


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    entries = source.document.section(CAMERAS, "the cameras")
    sections = [entries.section(key, "a camera") for key in entries.values]
    cameras = by_name(
        (section.text("logical_sensor_name", "the camera's name"), section) for section in sections
    )
    return rig_of_named(source, cameras, lambda section: _read_posed(section, given), given, unit="m")


def _read_posed(section: Section, given: Given) -> PosedCamera:
    model = section.section("camera_model", "type and parameters")
    model.choice("type", ("ftheta",))
    lens = model.section("parameters", "those of an f-theta camera")
    lens.only(KEYS)
    lens.knows(*(key for key, _ in POLYNOMIALS.values()))  # the other one is a fit to the reference
    if lens.values.get("external_distortion_parameters"):
        raise lens.fault("external_distortion_parameters", "none, as a windscreen's are no lens here")
    key, by_distance = POLYNOMIALS[lens.choice("reference_poly", POLYNOMIALS)]
    lens.knows(*(other for other, _ in POLYNOMIALS.values()))  # a fit to the reference
    poly = lens.array(key, "a polynomial's coefficients", range(1, MAX_COEFFICIENTS)).tolist()
    cx, cy = lens.numbers("principal_point", "two pixels", 2)
    tell_missing(lens, ["linear_cde"], "1, 0, 0")
    tell_missing(lens, ["max_angle"], "as far as the polynomial rises")
    linear = lens.numbers("linear_cde", "c, d, e", 3) if "linear_cde" in lens else (1.0, 0.0, 0.0)
    angle = math.degrees(lens.number("max_angle", "radians")) if "max_angle" in lens else None
    size = lens.size("resolution", given.size)
    camera = f_theta_camera(lens.where, size, (cx, cy), poly, by_distance, linear, angle)
    return PosedCamera(section.where, camera, section.rigid("T_sensor_rig", "the pose from camera to rig"))


FORMAT = RigFormat(
    "nurec",
    "NVIDIA NuRec rig trajectories, as CARLA replays them (JSON)",
    lambda source: CAMERAS in source.keys,
    _read,
    has_many=True,
)
