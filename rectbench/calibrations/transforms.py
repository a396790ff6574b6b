"""Rigid transformations [4, 4]."""

from __future__ import annotations

from typing import Any

import numpy as np

from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray


def inverse(T: FloatArray) -> FloatArray:
    """The inverse [4, 4] of a rigid transformation."""
    R = T[:3, :3].T
    return rigid(R, -R @ T[:3, 3])


def rigid(R: Any, t: Any) -> FloatArray:
    """The transformation [4, 4] with X' = R X + t."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def pose_matrix(rig: Rig) -> FloatArray:
    """T_right_left [4, 4], metres."""
    return rigid(rig.R_right_left, rig.t_right_left)
