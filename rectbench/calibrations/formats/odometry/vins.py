"""The configuration of VINS-Fusion, VINS-Fisheye and the like: camera files and body_T_cam0, body_T_cam1.

`body_T_cam0` takes points of camera 0 to the body (IMU), in metres, as the VINS-Fusion maintainers
state it. `cam0_calib` and `cam1_calib` name the CamOdoCal files of the cameras, beside the configuration.
VINS-Mono's own configuration holds one camera; two of them are read as `toolboxes.camodocal` says.
Written is what a configuration says of its cameras, the left one standing for the body; the topics and all
about the IMU are left to its user.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from rectbench.calibrations.assembling import inverse, pose_matrix, rig_of_posed, single
from rectbench.calibrations.contract import Given, RigFormat
from rectbench.calibrations.documents import Source
from rectbench.calibrations.formats.toolboxes import camodocal
from rectbench.rigs.file_formats import Writing
from rectbench.rigs.rig import Rig

CAMERAS = ("cam0", "cam1")


def _read(sources: Sequence[Source], given: Given) -> Rig:
    config = single([source for source in sources if _recognises(source)])
    file = config.document
    file.knows("estimate_extrinsic")
    posed = []
    for name in CAMERAS:
        calibration = file.text(f"{name}_calib", "the name of the camera's file")
        source = _named(calibration, sources) or config.beside(calibration)
        T = file.rigid(f"body_T_{name}", "the pose from camera to body, metres")
        posed.append(replace(camodocal.read_posed(source, given), T_shared_camera=T))
    return rig_of_posed(posed, given, config.name)


def _named(name: str, sources: Sequence[Source]) -> Source | None:
    """The file of that name among those that the user gave."""
    return next((source for source in sources if Path(source.path).name == Path(name).name), None)


def _recognises(source: Source) -> bool:
    return "cam0_calib" in source.keys or ("body_T_cam0" in source.keys and "model_type" not in source.keys)


def _texts(rig: Rig, name: str) -> dict[str, str]:
    """The part of a configuration that is about the cameras, the left one in the body's place."""
    storage = cv2.FileStorage(".yml", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    storage.write("num_of_cam", 2)
    for place, side in enumerate(("left", "right")):
        storage.write(f"cam{place}_calib", f"{side}.yaml")
    storage.write("image_width", rig.left.width)
    storage.write("image_height", rig.left.height)
    storage.write("body_T_cam0", np.eye(4))
    storage.write("body_T_cam1", inverse(pose_matrix(rig)))
    files = {"config.yaml": storage.releaseAndGetString()}
    for side, camera in (("left", rig.left), ("right", rig.right)):
        files[f"{side}.yaml"] = camodocal.camera_text(camera, side, "vins")
    return files


FORMAT = RigFormat(
    "vins",
    "VINS-Fusion configuration with its cameras' files (YAML)",
    _recognises,
    _read,
    write=Writing(_texts, in_folder=True),
)
