"""The made-up rig, its numbers, and what the examples of several families are built from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rectbench import Camera, Rig
from tests.calibrations.calibration_files import D1, D2, K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT

SIZE = (848, 800)
T_RL = np.eye(4)
T_RL[:3, :3], T_RL[:3, 3] = R_RIGHT_LEFT, T_RIGHT_LEFT
T_BODY_LEFT = np.eye(4)
T_BODY_LEFT[:3, :3] = Rotation.from_euler("xyz", [91, -3, 88], degrees=True).as_matrix()
T_BODY_LEFT[:3, 3] = [0.3, -0.02, 1.1]
T_BODY_RIGHT = T_BODY_LEFT @ np.linalg.inv(T_RL)

FOCAL1, FOCAL2 = ([float(K[i, j]) for i, j in ((0, 0), (1, 1), (0, 2), (1, 2))] for K in (K1, K2))
FOCAL = ("fx", "fy", "cx", "cy")
RADTAN1, RADTAN2 = [-0.28, 0.07, 2e-4, 1.8e-5], [-0.27, 0.06, -1e-4, 3e-5]
RATIONAL1 = [*RADTAN1, 0.01, 0.02, -0.03, 0.004]
RATIONAL2 = [*RADTAN2, 0.011, 0.019, -0.028, 0.003]
XI1, XI2 = 0.91, 0.89


@dataclass(frozen=True)
class Example:
    """Files by name, what of them is passed to `load_rig`, and the rig that comes out."""

    files: Mapping[str, str | bytes]
    rig: Rig
    paths: tuple[str, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)


def camera(model: str, names: tuple[str, ...], numbers: list[float], focal: list[float]) -> Camera:
    return Camera(model, SIZE, dict(zip((*FOCAL, *names), (*focal, *numbers), strict=True)))


def rig(left: Camera, right: Camera) -> Rig:
    return Rig(left, right, R_RIGHT_LEFT, T_RIGHT_LEFT)


KB = ("k1", "k2", "k3", "k4")
RADTAN = ("k1", "k2", "p1", "p2")
RATIONAL = (*RADTAN, "k3", "k4", "k5", "k6")
FISHEYES = rig(
    camera("kannala-brandt", KB, D1[0].tolist(), FOCAL1), camera("kannala-brandt", KB, D2[0].tolist(), FOCAL2)
)
PINHOLES = rig(camera("pinhole", RADTAN, RADTAN1, FOCAL1), camera("pinhole", RADTAN, RADTAN2, FOCAL2))
RATIONALS = rig(
    camera("pinhole", RATIONAL, RATIONAL1, FOCAL1), camera("pinhole", RATIONAL, RATIONAL2, FOCAL2)
)
UNIFIEDS = rig(
    camera("unified", ("xi", *RADTAN), [XI1, *RADTAN1], FOCAL1),
    camera("unified", ("xi", *RADTAN), [XI2, *RADTAN2], FOCAL2),
)
DOUBLE_SPHERES = rig(
    camera("double-sphere", ("xi", "alpha"), [-0.2, 0.59], FOCAL1),
    camera("double-sphere", ("xi", "alpha"), [-0.19, 0.6], FOCAL2),
)


def matrix_block(key: str, matrix: np.ndarray) -> str:
    """As cv::FileStorage writes a matrix."""
    rows, columns = matrix.shape
    data = ", ".join(map(repr, matrix.ravel().tolist()))
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [{data}]\n"


def rectification() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """R1, R2, P1, P2 of the made-up pose: x along the baseline, as cv2.stereoRectify defines them."""
    baseline = np.linalg.norm(T_RIGHT_LEFT)
    x = -R_RIGHT_LEFT.T @ T_RIGHT_LEFT / baseline
    y = np.cross([0.0, 0.0, 1.0], x)
    y /= np.linalg.norm(y)
    R1 = np.stack([x, y, np.cross(x, y)])
    P1 = np.array([[300.0, 0, 400, 0], [0, 300, 390, 0], [0, 0, 1, 0]])
    P2 = P1.copy()
    P2[0, 3] = -300 * baseline
    return R1, R1 @ R_RIGHT_LEFT.T, P1, P2


POSE_FILE = yaml.safe_dump({"R_right_left": R_RIGHT_LEFT.tolist(), "t_right_left": T_RIGHT_LEFT.tolist()})
_KITTI = Camera("pinhole", (1241, 376), {"fx": 718.856, "fy": 718.856, "cx": 607.1928, "cy": 185.2157})
KITTI_RECTIFIED = Rig(_KITTI, _KITTI, np.eye(3), [-386.1448 / 718.856, 0, 0])
"""The grey cameras of KITTI's odometry sequences 00 to 02, rectified, as several tools write them down."""
