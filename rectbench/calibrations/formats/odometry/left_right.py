"""Sections `left` and `right` in the words of Kalibr, each with a 4x4 pose `T` (YAML), as people write them.

`T` takes points of the frame that both sections share, as a rule the left camera, to the camera, as Kalibr's
`T_cn_cnm1` does; the file does not say so, which is told. What Kalibr itself writes has cam0 and cam1.
Five coefficients of `radtan` are OpenCV's k1 k2 p1 p2 k3. Translations are metres, pixel (0, 0) is the centre
of a pixel.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rectbench.calibrations.assembling import camera_of, inverse, rig_of_posed, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.calibrations.formats.odometry.kalibr import LAYOUTS, OTHERS_LAYOUTS, RADTAN
from rectbench.rigs.rig import Rig

SIDES = ("left", "right")
KEYS = ("camera_model", "distortion_model", "intrinsics", "distortion_coeffs", "resolution", "T")
OTHER_KEYS = ("rostopic", "topic", "name", "frame_id", "cam_overlaps", "timeshift_cam_imu")
"""What says nothing of lens and pose."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    posed = [_read_posed(file.section(side, "a camera"), given) for side in SIDES]
    tell(
        f"{file.at('right')}.T: taken to take points of the frame that both share to the camera, as Kalibr's "
        "T_cn_cnm1 does"
    )
    return rig_of_posed(posed, given, source.name)


def _read_posed(section: Section, given: Given) -> PosedCamera:
    section.only((*KEYS, *OTHER_KEYS))
    layouts = LAYOUTS | OTHERS_LAYOUTS
    projection = section.choice("camera_model", {name for name, _ in layouts}, "pinhole")
    known = [distortion for name, distortion in layouts if name == projection]
    distortion = section.choice("distortion_model", known, "none")
    layout = layouts[projection, distortion]
    params = section.named("intrinsics", layout.intrinsics)
    names = layout.distortion
    coefficients = section.values.get("distortion_coeffs", [])
    if (projection, distortion) == ("pinhole", "radtan") and len(coefficients) == len(RADTAN) + 1:
        names = (*RADTAN, "k3")
    if names or coefficients:
        params |= section.named("distortion_coeffs", names)
    size = section.size("resolution", given.size)
    camera = camera_of(section.where, layout.model, size, params)
    T_camera_shared = section.rigid("T", "the pose from the shared frame to the camera, metres")
    return PosedCamera(section.where, camera, inverse(T_camera_shared))


def _is_camera(values: Any) -> bool:
    return isinstance(values, dict) and {"intrinsics", "T"} <= values.keys()


def _recognises(source: Source) -> bool:
    return set(SIDES) <= source.keys and all(_is_camera(source.document.values[side]) for side in SIDES)


FORMAT = RigFormat(
    "left-right", "Sections left and right in Kalibr's words, with poses T (YAML)", _recognises, _read
)
