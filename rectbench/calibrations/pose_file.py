"""A file with nothing but the pose of two cameras, for formats whose files have one camera each.

Either the project's own keys `R_right_left` and `t_right_left`, or OpenCV's `R` (3x3 or a rotation
vector; `rvec`, `om`) and `T` (`tvec`): X_right = R X_left + T, as `stereoCalibrate` gives it. RTAB-Map's
`*_pose.yaml` has the same under `rotation_matrix` and `translation_matrix`.
"""

from __future__ import annotations

import cv2

from rectbench.calibrations.assembling import rigid
from rectbench.calibrations.documents import Section, Source, errors_at
from rectbench.rigs.rig import Rig, checked_rotation
from rectbench.types import FloatArray
from rectbench.yaml_text import yaml_text

ROTATION = ("R_right_left", "R", "rvec", "om", "Om", "rotation_vector", "rotation_matrix")
TRANSLATION = ("t_right_left", "T", "tvec", "t", "translation_vector", "translation_matrix")


def recognises(source: Source) -> bool:
    """Whether a file holds a rotation and a translation."""
    return bool(source.keys & set(ROTATION)) and bool(source.keys & set(TRANSLATION))


def read(source: Source) -> FloatArray:
    """T_right_left [4, 4] in the file's unit; raises InvalidInput for what is no pose."""
    file = source.document
    R_key = next(key for key in ROTATION if key in file)
    t_key = next(key for key in TRANSLATION if key in file)
    return rigid(read_rotation(file, R_key), file.array(t_key, "three metres", (3,)))


def read_rotation(file: Section, key: str) -> FloatArray:
    """The rotation [3, 3] under `key`, written as a matrix or as a rotation vector."""
    numbers = file.array(key, "a 3x3 rotation or a rotation vector", (9, 3))
    R = numbers.reshape(3, 3) if numbers.size == 9 else cv2.Rodrigues(numbers)[0]
    with errors_at(file.at(key)):
        return checked_rotation(R, "R_right_left")


def pose_text(rig: Rig) -> str:
    """The file of a rig's pose, by the project's own keys."""
    return yaml_text({"R_right_left": rig.R_right_left.tolist(), "t_right_left": rig.t_right_left.tolist()})
