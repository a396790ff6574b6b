"""Homographies that are turns of a camera of unknown focal length: K R K⁻¹."""

import numpy as np

import rectbench as rb

VIEW_DEG = (10.0, 150.0)
"""The focal length is held to views between these, the plausible ones: small rotations leave it open, so that
noise would carry it anywhere."""
HALF_TURN = np.diag([-1.0, -1.0, 1.0])
"""About the optical axis."""
HALF_TURNS = (np.eye(3), HALF_TURN, np.diag([-1.0, 1.0, -1.0]), np.diag([1.0, -1.0, -1.0]))
"""About each axis, and none: of both images they leave rows that correspond corresponding."""


def intrinsics(focal: float, centre: np.ndarray) -> np.ndarray:
    """K of a pinhole image whose principal point is its middle."""
    return np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1.0]])


def focal_range(view: rb.PinholeView) -> tuple[float, float]:
    """The shortest and the longest plausible focal length, px."""
    shortest, longest = (view.size[0] / 2 / np.tan(np.radians(fov) / 2) for fov in reversed(VIEW_DEG))
    return shortest, longest


def open_focal(view_deg: float) -> str:
    """What is told of a focal length that ended at a bound."""
    return f"the matches leave the focal length open: it ended at a view of {view_deg:.0f}°"


def fundamental_of(H_left: np.ndarray, H_right: np.ndarray) -> np.ndarray:
    """F = H_rightᵀ [i]× H_left, for which these homographies make rows correspond."""
    return np.outer(H_right[2], H_left[1]) - np.outer(H_right[1], H_left[2])


def upright(R_left: np.ndarray, R_right: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same two rotations after the half turn, or none, that leaves both images most upright."""
    turn = max(HALF_TURNS, key=lambda turn: float(np.trace(turn @ (R_left + R_right))))
    return turn @ R_left, turn @ R_right


def upright_roll(F: np.ndarray, centre: np.ndarray) -> float:
    """A quarter turn where the left epipole lies more above the middle than beside it; else 0."""
    x, y, w = np.linalg.svd(F)[2][-1]
    return 0.0 if abs(y - w * centre[1]) <= abs(x - w * centre[0]) else float(np.pi / 2)


def rotation(x: float, y: float, z: float) -> np.ndarray:
    """Rx Ry Rz. Written out: the fit asks for thousands of them."""
    (cx, cy, cz), (sx, sy, sz) = np.cos([x, y, z]), np.sin([x, y, z])
    return np.array(
        [
            [cy * cz, -cy * sz, sy],
            [cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy],
            [sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy],
        ]
    )
