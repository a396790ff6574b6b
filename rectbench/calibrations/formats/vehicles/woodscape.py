"""WoodScape's calibration of one camera (`00001_FV.json`): `intrinsic` and `extrinsic`, two files a rig.

The radius on the sensor is ρ = k1 θ + k2 θ² + k3 θ³ + k4 θ⁴ in pixels; u = x + cx_offset + (width - 1)/2, v
= `aspect_ratio` y + cy_offset + (height - 1)/2, so pixel (0, 0) is the centre of a pixel. The extrinsic
`quaternion` (x, y, z, w) and `translation`, metres, take points of the camera to the vehicle (WoodScape,
scripts/calibration/projection.py). The lens is `ocam` by its `inverse_poly`, the same polynomial about 90°.
"""

from __future__ import annotations

from rectbench.calibrations.assembling import rigid
from rectbench.calibrations.contract import CameraFormat, Given, PosedCamera
from rectbench.calibrations.documents import Source
from rectbench.calibrations.formats.named_cameras import quaternion_rotation
from rectbench.calibrations.formats.vehicles.f_theta_keys import f_theta_camera

COEFFICIENTS = ("k1", "k2", "k3", "k4")
KEYS = (*COEFFICIENTS, "model", "poly_order", "aspect_ratio", "cx_offset", "cy_offset", "width", "height")
MARKS = {"intrinsic", "extrinsic"}


def read_posed(source: Source, given: Given) -> PosedCamera:
    """The camera in the file, posed in the vehicle."""
    lens = source.document.section("intrinsic", "the lens")
    lens.only(KEYS)
    if "model" in lens:
        lens.choice("model", ("radial_poly",))
    if "poly_order" in lens and lens.number("poly_order", "4") != len(COEFFICIENTS):
        raise lens.fault("poly_order", f"{len(COEFFICIENTS)}")
    size = lens.sides("width", "height", given.size)
    offsets = [lens.number(f"c{axis}_offset", "pixels") for axis in "xy"]
    centre = (offsets[0] + (size[0] - 1) / 2, offsets[1] + (size[1] - 1) / 2)
    aspect = lens.number("aspect_ratio", "a number above 0")
    if not aspect > 0:
        raise lens.fault("aspect_ratio", "a number above 0")
    # The aspect stretches v, where [c d; e 1] stretches u: both by 1/aspect, and the radius by as much more.
    poly = [0.0, *(aspect * lens.number(name, "pixels") for name in COEFFICIENTS)]
    camera = f_theta_camera(lens.where, size, centre, poly, by_distance=False, linear=(1 / aspect, 0.0, 0.0))
    pose = source.document.section("extrinsic", "quaternion and translation")
    pose.only(("quaternion", "translation"))
    x, y, z, w = pose.numbers("quaternion", "x, y, z, w", 4)
    R = quaternion_rotation(pose.at("quaternion"), [w, x, y, z])
    return PosedCamera(source.path, camera, rigid(R, pose.numbers("translation", "three metres", 3)))


def _recognises(source: Source) -> bool:
    if not source.keys >= MARKS:
        return False
    lens = source.document.values["intrinsic"]
    return isinstance(lens, dict) and {"k1", "cx_offset"} <= lens.keys()


FORMAT = CameraFormat("woodscape", "WoodScape camera (JSON; two files)", _recognises, read_posed)
