"""A flat board before a rig: its images by many samples a pixel, and exactly where its corners are."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

import rectbench as rb

WHITE, BLACK, GREY = 215, 30, 90.0


class Print(NamedTuple):
    """What is printed on a board: grey levels [H, W]; corners [N, 2] in texels from its top left edge."""

    texture: np.ndarray
    corners: np.ndarray


def chessboard(columns: int, rows: int, px: int = 40, margin: int = 24) -> Print:
    """A board of so many squares; its corners are the inner ones."""
    squares = np.where(np.add.outer(np.arange(rows), np.arange(columns)) % 2, WHITE, BLACK)
    texture = np.pad(np.kron(squares, np.ones((px, px), int)), margin, constant_values=WHITE)
    corners = [(margin + i * px, margin + j * px) for j in range(1, rows) for i in range(1, columns)]
    return Print(texture.astype(np.uint8), np.array(corners, dtype=float))


def tag_grid(
    columns: int, rows: int, family: str, px: int = 80, gap: int = 24, *, touching: bool = False
) -> Print:
    """Tags of an OpenCV dictionary; `touching` as Kalibr prints them, black squares at their corners."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, family))
    size = [count * (px + gap) + 5 * gap for count in (rows, columns)]
    texture, corners = np.full(size, WHITE, np.uint8), []
    for j in range(rows + touching):
        for i in range(columns + touching):
            x, y = (2 * gap + k * (px + gap) for k in (i, j))
            if touching:
                texture[y : y + gap, x : x + gap] = BLACK
            if i < columns and j < rows:
                x, y = x + gap, y + gap
                border = 2 if touching else 1
                tag = cv2.aruco.generateImageMarker(dictionary, j * columns + i, px, borderBits=border)
                texture[y : y + px, x : x + px] = np.where(tag > 0, WHITE, BLACK)
                corners += [(x, y), (x + px, y), (x + px, y + px), (x, y + px)]
    return Print(texture, np.array(corners, dtype=float))


class Seen(NamedTuple):
    """A board in both images of a rig."""

    left: np.ndarray
    right: np.ndarray
    corners: rb.Matches


def seen_board(
    rig: rb.Rig,
    printed: Print,
    *,
    width_m: float = 0.4,
    distance_m: float = 0.6,
    turn_deg: tuple[float, float, float] = (12.0, -20.0, 4.0),
    before: rb.StereoPair | None = None,
    blur_px: float = 0.7,
    samples: int = 4,
) -> Seen:
    """The board `distance_m` ahead of the left camera, turned by angles about x, y, z; with noise.

    It hangs in an even grey, or `before` other images of the rig, as grey.
    """
    texel_m = width_m / printed.texture.shape[1]
    R = Rotation.from_euler("xyz", turn_deg, degrees=True).as_matrix()
    middle = texel_m * np.array([*printed.texture.shape[::-1], 0]) / 2
    t = np.array([0.04, 0.02, distance_m]) - R @ middle
    points = np.c_[printed.corners * texel_m, np.zeros(len(printed.corners))] @ R.T + t
    poses = ((rig.left, R, t), (rig.right, rig.R_right_left @ R, rig.right_from_left(t)))
    behind = (None, None) if before is None else (before.left[..., 1], before.right[..., 1])
    images = [
        _image(camera, R, t, printed.texture, texel_m, background, blur_px, samples, seed)
        for seed, ((camera, R, t), background) in enumerate(zip(poses, behind, strict=True))
    ]
    corners = rb.Matches(rig.left.project(points)[0], rig.right.project(rig.right_from_left(points))[0])
    return Seen(images[0], images[1], corners)


def _image(
    camera: rb.Camera,
    R: np.ndarray,
    t: np.ndarray,
    texture: np.ndarray,
    texel_m: float,
    background: np.ndarray | None,
    blur_px: float,
    samples: int,
    seed: int,
) -> np.ndarray:
    rng, grid = np.random.default_rng(seed), camera.pixel_grid()
    other = np.full(grid.shape[:2], GREY) if background is None else background.astype(float)
    total = np.zeros(grid.shape[:2])
    for i, j in np.ndindex(samples, samples):
        offset = (np.array([i, j]) + rng.uniform(size=grid.shape)) / samples - 0.5
        rays, seen = camera.unproject(grid + offset)
        with np.errstate(all="ignore"):
            distance = (R[:, 2] @ t) / (rays @ R[:, 2])
            texels = np.floor((rays * distance[..., None] - t) @ R / texel_m)[..., :2]
        on = seen & (distance > 0) & np.all((texels >= 0) & (texels < texture.shape[::-1]), axis=-1)
        column, row = np.moveaxis(np.where(on[..., None], texels, 0).astype(int), -1, 0)
        total += np.where(on, texture[row, column], other)
    noisy = cv2.GaussianBlur(total / samples**2, (0, 0), blur_px) + rng.normal(0, 2, total.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def misses(found: rb.Matches, truth: rb.Matches) -> np.ndarray:
    """Found less true pixels, left beside right [N, 4], of the true corner that is nearest on the left."""
    nearest = np.linalg.norm(found.left[:, None] - truth.left, axis=2).argmin(axis=1)
    return np.hstack([found.left - truth.left[nearest], found.right - truth.right[nearest]])
