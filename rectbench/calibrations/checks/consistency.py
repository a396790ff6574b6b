"""What a file says twice, compared: a disagreement is told, and the format's main word is kept."""

from __future__ import annotations

import math

import numpy as np

from rectbench.calibrations.documents import Section, finite_number, tell
from rectbench.calibrations.documents.numbers import flat_numbers
from rectbench.types import FloatArray

ANGLE_DEG = 0.1
"""By how much two statements of one rotation may differ; files round to some 1e-5 rad."""

SHARE = 0.02
"""By how much two statements of one length may differ, relative to the larger."""


def compare_numbers(section: Section, key: str, expected: float, what: str, share: float = SHARE) -> None:
    """Tell where the number under `key`, if there is one, is not the one that follows from `what`."""
    number = finite_number(section.values.get(key))
    if number is not None and abs(number - expected) > share * max(abs(number), abs(expected)):
        tell(f"{section.at(key)} is {number:.6g}, but {expected:.6g} by {what}, which is kept to")


def compare_rotations(where: str, R: FloatArray, expected: FloatArray, what: str) -> None:
    """Tell where the rotation `R` [3, 3], said at `where`, turns otherwise than that of `what`."""
    angle_deg = angle_between_deg(R, expected)
    if angle_deg > ANGLE_DEG:
        tell(f"{where} turns {angle_deg:.2f}° otherwise than {what}, which is kept to")


@np.errstate(all="ignore")
def compare_lengths(where: str, length: float, t: FloatArray, what: str) -> None:
    """Tell where a baseline's length, said at `where`, is not that of `t` [3], the translation of `what`."""
    expected = float(np.linalg.norm(t))
    if abs(length - expected) > SHARE * max(length, expected):
        tell(f"{where} is a baseline of {length:.6g}, but {what} one of {expected:.6g}, which is kept to")


def compare_poses(where: str, T: FloatArray, expected: FloatArray, what: str) -> None:
    """Tell where the pose [4, 4] said at `where` has another rotation or baseline than that of `what`."""
    compare_rotations(where, T[:3, :3], expected[:3, :3], what)
    compare_lengths(where, float(np.linalg.norm(T[:3, 3])), expected[:3, 3], what)


@np.errstate(all="ignore")
def rotation_in(section: Section, key: str) -> FloatArray | None:
    """The rotation [3, 3] under `key`, or None where there is none, or another thing."""
    numbers = flat_numbers(section.values.get(key))
    if numbers is None or len(numbers) != 9:
        return None
    R = np.reshape(numbers, (3, 3))
    is_rotation = np.abs(R.T @ R - np.eye(3)).max() < 1e-3 and np.linalg.det(R) > 0
    return R if is_rotation else None


@np.errstate(all="ignore")
def angle_between_deg(R: FloatArray, other: FloatArray) -> float:
    """The angle of the rotation from one to the other, degrees."""
    between = R.T @ other
    axis = [between[2, 1] - between[1, 2], between[0, 2] - between[2, 0], between[1, 0] - between[0, 1]]
    return math.degrees(math.atan2(float(np.linalg.norm(axis)), float(np.trace(between)) - 1.0))
