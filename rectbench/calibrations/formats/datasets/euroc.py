"""A `sensor.yaml` of the EuRoC MAV dataset and of Kimera: a file a camera.

`T_BS` takes points of the sensor to the body, in metres ("Sensor extrinsics wrt. the body-frame").
`intrinsics` are fu fv cu cv, `distortion_coefficients` those of Kalibr's radtan or equidistant; Kimera
writes `distortion_coeffs` and `omni` too.
"""

from __future__ import annotations

from rectbench.calibrations.assembling import camera_of
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.odometry.kalibr import EQUI, FOCAL, RADTAN

MODELS = {
    "none": ("pinhole", ()),
    "radtan": ("pinhole", RADTAN),
    "radial-tangential": ("pinhole", RADTAN),
    "plumb_bob": ("pinhole", RADTAN),
    "equidistant": ("kannala-brandt", EQUI),
    "equi": ("kannala-brandt", EQUI),
}


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file and where it stands in the body."""
    file = source.document
    model, params = _read_lens(file)
    size = file.size("resolution", given.size)
    T_body_camera = file.rigid("T_BS", "the pose from sensor to body, metres")
    camera = camera_of(f"{source.path}: intrinsics", model, size, params)
    return PosedCamera(source.path, camera, T_body_camera)


def _read_lens(file: Section) -> tuple[str, dict[str, float]]:
    kind = file.choice("distortion_model", MODELS, "none")
    if file.values.get("camera_model", "pinhole") != "pinhole":
        raise file.fault("camera_model", "pinhole")
    model, order = MODELS[kind]
    params = file.named("intrinsics", FOCAL)
    if not order:
        return model, params
    key = "distortion_coeffs" if "distortion_coeffs" in file else "distortion_coefficients"
    distortion = file.numbers(key, f"{len(order)} finite numbers ({' '.join(order)})")
    if len(distortion) < len(order) or any(distortion[len(order) :]):
        raise file.fault(key, f"{len(order)} finite numbers ({' '.join(order)})")
    return model, params | dict(zip(order, distortion, strict=False))


FORMAT = CameraFormat(
    "euroc",
    "EuRoC and Kimera sensor.yaml (two files)",
    lambda source: {"T_BS", "intrinsics"} <= source.keys,
    read_posed,
)
