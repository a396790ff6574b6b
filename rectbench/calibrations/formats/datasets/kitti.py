"""KITTI's `calib_cam_to_cam.txt` of the raw data: four cameras, before rectification; and its `calib.txt`.

Lines `S_00: width height`, `K_00`, `D_00` (k1 k2 p1 p2 k3), `R_00` and `T_00` for each camera 00 to 03; R and
T take points of camera 0 to that camera, in metres (the raw data's readme). Left and right are 00 and
01, the grey cameras, unless others are asked for, such as 02 and 03. Pixel (0, 0) is the centre of a pixel.

The odometry and object benchmarks' file has lines `P0: 12 numbers` to P3, the projections K [1 t] of
rectified cameras, from the frame of camera 0: of P0 and P1, unless P2 and P3 are asked for. It leaves the
size out.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from rectbench.calibrations.assembling import inverse, rig_of_posed, rigid, single
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source, errors_at, tell
from rectbench.calibrations.formats.toolboxes.opencv import camera_matrix, opencv_camera
from rectbench.cameras import Camera
from rectbench.rigs.rig import Rig


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = single(sources)
    file = source.table(":")
    file.knows("[SKDRT]_0?", "P?", "Tr*")  # other cameras, and where the lidar stands
    file.knows("[SRP]_rect_0?", "R_rect")  # of the rectified images
    found = [key for key in file.values if re.fullmatch(r"K_0\d|P\d", key)]
    if given.cameras is None and len(found) > 2:
        tell(
            f"{source.path}: holds {len(found)} cameras; 0 and 1 are taken, others by `cameras=` (--cameras)"
        )
    if "P0" in file:
        names = given.cameras or ("P0", "P1")
        return rig_of_posed([_read_rectified(file, name, given) for name in names], given, source.name)
    names = given.cameras or ("00", "01")
    return rig_of_posed([_read_posed(file, name, given) for name in names], given, source.name)


def _read_posed(file: Section, name: str, given: Given) -> PosedCamera:
    size = file.size(f"S_{name}", given.size)
    camera = opencv_camera(file, f"K_{name}", f"D_{name}", "pinhole", size, counts=(5,))
    T_camera_first = rigid(file.rotation(f"R_{name}"), file.array(f"T_{name}", "three metres", (3,)))
    return PosedCamera(file.at(f"R_{name}"), camera, inverse(T_camera_first))


def _read_rectified(file: Section, name: str, given: Given) -> PosedCamera:
    P = file.array(name, "12 numbers, a 3x4 projection", (12,)).reshape(3, 4)
    size = file.sides("width", "height", given.size)
    K = Section(file.file, file.key, {name: P[:, :3].tolist()})
    with errors_at(file.at(name)):
        camera = Camera("pinhole", size, camera_matrix(K, name, "pinhole"))
        return PosedCamera(file.at(name), camera, rigid(np.eye(3), -np.linalg.solve(P[:, :3], P[:, 3])))


def _recognises(source: Source) -> bool:
    is_raw = all(re.search(rf"(?m)^{key}_0\d:", source.head) for key in "KT")
    return is_raw or all(re.search(rf"(?m)^P{place}:(?:[ \t]+\S+){{12}}", source.head) for place in (0, 1))


FORMAT = RigFormat(
    "kitti",
    "KITTI raw calib_cam_to_cam.txt, odometry and object calib.txt",
    _recognises,
    _read,
    has_many=True,
)
