"""KITTI-360's `calib_cam_to_pose.txt` with the fisheyes' `image_02.yaml` and `image_03.yaml`.

A line `image_02: 12 numbers` is the 3x4 pose that takes points of that camera to the vehicle, in
metres (KITTI-360's documentation, "Calibrations"); the cameras are CamOdoCal's MEI. image_02 looks
to the left and image_03 to the right; what they share is the rim. Pixel (0, 0) is the centre of a pixel.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from rectbench.calibrations.assembling import rig_of_posed
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Source
from rectbench.calibrations.formats.toolboxes import camodocal
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

FISHEYES = ("image_02.yaml", "image_03.yaml")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    table = next(source for source in sources if _recognises(source))
    cameras = [source for source in sources if camodocal.FORMAT.recognises(source)]
    cameras = cameras or [table.beside(name) for name in FISHEYES]
    if len(cameras) != 2:
        raise InvalidInput(f"{table.path}: comes with {len(cameras)} cameras; expected two, such as image_02")
    poses = table.table(":")
    posed = []
    for camera in cameras:
        T = poses.rigid(camera.name, "12 numbers, the 3x4 pose of a camera")
        posed.append(replace(camodocal.read_posed(camera, given), T_shared_camera=T))
    return rig_of_posed(posed, given, "kitti360")


def _recognises(source: Source) -> bool:
    return bool(re.search(r"(?m)^image_0\d:(?:[ \t]+\S+){12}[ \t]*$", source.head))


FORMAT = RigFormat(
    "kitti360", "KITTI-360 calib_cam_to_pose.txt with image_02.yaml and image_03.yaml", _recognises, _read
)
