"""BoofCV's `StereoParameters` (YAML): `left`, `right` and `rightToLeft`.

`rightToLeft` takes points of the right camera to the left one: a row-major `rotation` and `x y z` in
the unit of the calibration target, which the file does not tell (often millimetres). The lens is the
pinhole with radial (of r², r⁴, ...: up to four) and tangential coefficients, t1 and t2 being OpenCV's p1 and
p2. Where there are four, or a skew, it is `radial-tangential`.
"""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.calibrations.assembling import assembled, camera_of, inverse, rigid, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.cameras import Camera
from rectbench.rigs.rig import Rig

RADIAL = ("k1", "k2", "k3", "k4")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    file = single(sources).document
    file.knows("model")  # stereo_camera
    left, right = (_read_camera(file.section(side, "a camera"), given) for side in ("left", "right"))
    pose = file.section("rightToLeft", "the pose of the right camera")
    R = pose.rotation("rotation")
    t = [pose.number(axis, "the unit of the calibration target") for axis in "xyz"]
    return assembled(left, right, inverse(rigid(R, t)), given, pose.at("x"), sources[0].name)


def _read_camera(section: Section, given: Given) -> Camera:
    kind = section.choice("model", ("pinhole", "pinhole_radial_tangential"))
    pinhole = section.section("pinhole", "fx fy cx cy width height")
    skew = pinhole.number("skew", "pixels") if "skew" in pinhole else 0.0
    params = {name: pinhole.number(name, "pixels") for name in ("fx", "fy", "cx", "cy")}
    if kind == "pinhole_radial_tangential":
        params |= _read_distortion(section.section("radial_tangential", "radial, t1 and t2"))
    size = pinhole.sides("width", "height", given.size)
    if skew or params.get("k4"):
        return camera_of(section.at("pinhole"), "radial-tangential", size, params | {"skew": skew})
    params.pop("k4", None)
    return camera_of(section.at("pinhole"), "pinhole", size, params)


def _read_distortion(section: Section) -> dict[str, float]:
    if "radial" not in section:
        tell(f"{section.at('radial')} is missing; taken to be none")
    radial = section.numbers("radial", "up to four coefficients") if "radial" in section else []
    if len(radial) > len(RADIAL):
        raise section.fault("radial", "up to four coefficients")
    tangential = {}
    for t, ours in (("t1", "p1"), ("t2", "p2")):
        if t in section:
            tangential[ours] = section.number(t, "a number")
        else:
            tell(f"{section.at(t)} is missing; taken to be 0")
    return dict(zip(RADIAL, radial, strict=False)) | tangential


FORMAT = RigFormat(
    "boofcv", "BoofCV stereo parameters (YAML)", lambda source: "rightToLeft" in source.keys, _read
)
