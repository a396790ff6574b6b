"""MC-Calib's `calibrated_cameras_data.yml`: `camera_0`, `camera_1`, ... of a group.

`camera_pose_matrix` takes points of the camera to the group's reference, in the unit of the boards: MC-Calib
writes the inverse of its own poses, and its display draws the cameras where these put them. `distortion_type`
0 is OpenCV's pinhole, 1 its fisheye; pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from rectbench.calibrations.assembling import Pair, chosen, rig_of_posed, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.toolboxes.opencv import opencv_camera
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

LENSES = {0: "pinhole", 1: "fisheye"}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.document
    cameras = [name for name in file.values if re.fullmatch(r"camera_\d{1,3}", name)]

    def rig_of(names: Pair) -> Rig:
        sections = [file.section(name, "a camera") for name in names]
        groups = [section.values.get("camera_group") for section in sections]
        if groups[0] != groups[1]:
            where = sections[1].at("camera_group")
            raise InvalidInput(f"{where} is not that of the other camera; expected one group of both")
        return rig_of_posed([_read_posed(section, given) for section in sections], given, source.name)

    return rig_of(chosen(cameras, given, source.path, rig_of))


def _read_posed(section: Section, given: Given) -> PosedCamera:
    kind = section.number("distortion_type", "0 or 1")
    if kind not in LENSES:
        raise section.fault("distortion_type", "0 (perspective) or 1 (fisheye)")
    lens = LENSES[int(kind)]
    size = section.sides("img_width", "img_height", given.size)
    camera = opencv_camera(section, "camera_matrix", "distortion_vector", lens, size, section.where)
    T_group_camera = section.rigid("camera_pose_matrix", "the pose from camera to group")
    return PosedCamera(section.where, camera, T_group_camera)


FORMAT = RigFormat(
    "mccalib",
    "MC-Calib calibrated_cameras_data (YAML)",
    lambda source: {"nb_camera", "camera_0"} <= source.keys,
    _read,
    has_many=True,
)
