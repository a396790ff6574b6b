"""Photographs of a box room with painted walls, through any camera, without a renderer."""

from __future__ import annotations

import cv2
import numpy as np

import rectbench as rb

HALF_M = np.array([2.5, 1.6, 4.0])
"""Half the sides of the room, which is centred 1 m ahead of the left camera."""
CENTRE_M = np.array([0.3, -0.2, 1.0])
TEXELS = 480


def walls(seed: int = 0) -> np.ndarray:
    """Six grey paintings [6, TEXELS, TEXELS], blotches of several sizes."""
    rng = np.random.default_rng(seed)
    blotches = [
        np.stack([cv2.resize(face, (TEXELS, TEXELS), interpolation=cv2.INTER_CUBIC) for face in faces])
        for faces in (rng.uniform(-1, 1, (6, n, n)) / 2**i for i, n in enumerate((12, 30, 60, 120)))
    ]
    return np.clip(128 + 70 * np.sum(blotches, axis=0), 0, 255).astype(np.float32)


def photograph(
    camera: rb.Camera, R_cam_left: np.ndarray, centre_m: np.ndarray, seed: int = 0, noise: float = 1.0
) -> np.ndarray:
    """What the camera sees [H, W] uint8, at `centre_m` in the left camera's frame; noise in grey levels."""
    rays, ok = camera.unproject(camera.pixel_grid())
    directions = np.where(ok[..., None], rays, 1.0) @ R_cam_left
    start = centre_m - CENTRE_M
    # The wall that a ray from inside the room meets first.
    with np.errstate(divide="ignore"):
        distances = (np.sign(directions) * HALF_M - start) / directions
    axis = distances.argmin(axis=-1)
    points = start + directions * distances.min(axis=-1)[..., None]
    paintings, image = walls(seed), np.zeros(axis.shape, np.float32)
    for side in range(3):
        across = [k for k in range(3) if k != side]
        for sign in (0, 1):
            on_wall = (axis == side) & ((directions[..., side] > 0) == bool(sign))
            texels = ((points[..., across] / HALF_M[across] + 1) / 2 * (TEXELS - 1)).astype(np.float32)
            painted = cv2.remap(paintings[2 * side + sign], texels, None, cv2.INTER_CUBIC)
            image[on_wall] = painted[on_wall]
    image += np.random.default_rng(seed + 7).normal(0, noise, image.shape)
    return np.where(ok, np.clip(np.rint(image), 0, 255), 0).astype(np.uint8)


def pair_of(rig: rb.Rig, seed: int = 0, noise: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Both photographs of a rig."""
    left = photograph(rig.left, np.eye(3), np.zeros(3), seed, noise)
    return left, photograph(rig.right, rig.R_right_left, rig.centre_right_in_left, seed, noise + 0.01)
