"""MultiCal's `calibration.json`: `cameras` and `camera_poses`.

A camera has OpenCV's `K` and `dist`; `model` is standard, rational, thin_prism or tilted, its pinhole. The
fisheye of MultiCal (`camera_fisheye.py`) calls itself standard too and has four coefficients, where OpenCV's
`calibrateCamera` never gives so few: four are taken for a fisheye's, which is told. `R` and `T` of a pose
take points of the rig, or of the master camera, to the camera: what is called `cam2_to_cam1` is
X_cam2 = R X_cam1 + T, as MultiCal's `with_master` and the example of its FORMAT.md have it. Translations are
in the unit of the boards. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rectbench.calibrations.assembling import inverse, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.calibrations.documents.numbers import flat_numbers
from rectbench.calibrations.formats.named_cameras import rig_of_named
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

PINHOLES = ("standard", "rational", "thin_prism", "tilted")
FISHEYES = ("fisheye", "fix_k1", "fix_k2", "fix_k3", "fix_k4")
"""What MultiCal calls its lenses; its fisheye may also be called standard."""

KEYS = ("model", "image_size", "K", "dist", "fix_aspect", "has_skew")
POSES = "camera_poses"
LINK = "_to_"
FEWEST = 4
"""Coefficients of a fisheye; `calibrateCamera` gives five or more."""


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    cameras = file.section("cameras", "the cameras by name")
    poses = file.section(POSES, "the cameras' poses by name")
    sections = {name: cameras.section(name, "a camera") for name in cameras.values if _pose_keys(poses, name)}
    _check_master(poses)
    return rig_of_named(source, sections, partial(_read_posed, poses, given=given), given)


def _pose_keys(poses: Section, name: str) -> list[str]:
    return [key for key in poses.values if key == name or key.startswith(f"{name}{LINK}")]


def _check_master(poses: Section) -> None:
    """Poses in the frames of several masters, a chain, are not what MultiCal writes."""
    masters = {key.partition(LINK)[2] for key in poses.values if LINK in key}
    if len(masters) > 1:
        raise InvalidInput(
            f"{poses.where} has poses in {len(masters)} cameras' frames; expected one master's"
        )


def _read_posed(poses: Section, section: Section, given: Given) -> PosedCamera:
    section.only(KEYS)
    key = _pose_keys(poses, section.key.removeprefix("cameras.").removesuffix("."))[0]
    pose = poses.section(key, "R and T")
    pose.only(("R", "T"))
    lens = _lens(section)
    size = section.size("image_size", given.size)
    camera = opencv_camera(section, "K", "dist", lens, size, section.where)
    T_camera_rig = rigid(pose.rotation("R"), pose.array("T", "a translation", (3,)))
    return PosedCamera(section.where, camera, inverse(T_camera_rig))


def _lens(section: Section) -> str:
    model = section.choice("model", (*PINHOLES, *FISHEYES), "standard")
    if model in FISHEYES:
        return "fisheye"
    is_fisheye = model == "standard" and len(flat_numbers(section.values.get("dist")) or ()) == FEWEST
    if is_fisheye:
        tell(f"{section.at('dist')}: four coefficients, taken for those of MultiCal's fisheye")
    return "fisheye" if is_fisheye else "pinhole"


FORMAT = RigFormat(
    "multical",
    "MultiCal calibration (JSON)",
    lambda source: {"cameras", POSES} <= source.keys,
    _read,
    has_many=True,
)
