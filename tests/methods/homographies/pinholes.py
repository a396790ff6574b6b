"""Pairs of ideal pinhole cameras, which homographies see as they are, and what rectifies them."""

from __future__ import annotations

import numpy as np

import rectbench as rb
from tests.rigs_for_tests import points_before, rig

SIZE = (640, 480)
CENTRE = np.array([319.5, 239.5])
TOED_IN = ((2.0, 4.0, 3.0), (0.2, 0.01, 0.02))


def pinholes(
    rotation_deg: tuple[float, float, float] = TOED_IN[0],
    centre_m: tuple[float, float, float] = TOED_IN[1],
    focal: float = 520.0,
) -> rb.Rig:
    """Two equal cameras, principal point in the middle, focal in px; the right one turned and moved."""
    lens = rb.Camera("pinhole", SIZE, {"fx": focal, "fy": focal, "cx": CENTRE[0], "cy": CENTRE[1]})
    turned = rig(rotation_deg=rotation_deg).R_right_left
    return rb.Rig(lens, lens, turned, -turned @ np.array(centre_m), name="pinholes")


def random_pinholes(seed: int) -> rb.Rig:
    """Cameras turned by up to some 10° each way, on a baseline near the x axis."""
    rng = np.random.default_rng(seed)
    return pinholes(
        tuple(rng.uniform(-10, 10, 3)), (0.2, *rng.uniform(-0.05, 0.05, 2)), rng.uniform(450, 900)
    )


def rectified(pair: rb.Rig, method: str) -> rb.Rectification:
    """By this method, from some hundred exact matches."""
    _, left, right = points_before(pair, 150)
    return rb.rectify(pair, method=method, matches=(left, right))


def camera_matrix(rig: rb.Rig) -> np.ndarray:
    """K [3, 3] of both cameras."""
    focal = rig.left.params["fx"]
    return np.array([[focal, 0, CENTRE[0]], [0, focal, CENTRE[1]], [0, 0, 1]])


def fundamental(rig: rb.Rig) -> np.ndarray:
    """F [3, 3] between the pixels of the rig's images."""
    K_inverse = np.linalg.inv(camera_matrix(rig))
    return K_inverse.T @ rig.essential_matrix @ K_inverse


def homographies(rect: rb.Rectification) -> tuple[np.ndarray, np.ndarray]:
    """H_left and H_right [3, 3] from source to rectified pixels, 1 in the middle of the image."""
    K_inverse = np.linalg.inv(camera_matrix(rect.rig))
    found = [warp.target.matrix @ warp.R_rect_cam @ K_inverse for warp in (rect.left, rect.right)]
    left, right = (H / (H[2] @ [*CENTRE, 1]) for H in found)
    return left, right


def pixel_grid() -> np.ndarray:
    """All pixels of the image, homogeneous [N, 3]."""
    u, v = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    return np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1)
