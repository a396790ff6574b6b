"""A rig as read against a tool's own formula: the pixels of points that both cameras see."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rectbench import Rig, load_rig
from tests.calibrations.examples import EXAMPLES
from tests.calibrations.test_every_format import written

Projection = Callable[[np.ndarray], np.ndarray]
"""Pixels [N, 2], rectbench's, of points [N, 3] of the frame that the file's cameras share, in metres."""


def rig_of(name: str, folder: Path) -> Rig:
    example = EXAMPLES[name]
    return load_rig(written(example, folder), **example.options)


def content(name: str, file: str = "") -> Any:
    """What the JSON of an example holds."""
    files = EXAMPLES[name].files
    return json.loads(files[file] if file else next(iter(files.values())))


def points_ahead(angle_deg: float) -> np.ndarray:
    """Points [N, 3] of the left camera's frame within that angle of its axis, one to six metres away."""
    rng = np.random.default_rng(3)
    theta, phi = np.radians(angle_deg) * np.sqrt(rng.uniform(size=300)), rng.uniform(0, 2 * np.pi, 300)
    rays = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    return rays * rng.uniform(1, 6, (300, 1))


def assert_agrees(
    rig: Rig, shared_from_left: np.ndarray, left: Projection, right: Projection, angle_deg: float = 40.0
) -> None:
    """Both cameras put points where the tool does; `shared_from_left` [4, 4] is of the tool's numbers."""
    points = points_ahead(angle_deg)
    shared = points @ shared_from_left[:3, :3].T + shared_from_left[:3, 3]
    for camera, own, project in (
        (rig.left, points, left),
        (rig.right, rig.right_from_left(points), right),
    ):
        pixels, seen = camera.project(own)
        assert seen.mean() > 0.9
        np.testing.assert_allclose(pixels[seen], project(shared)[seen], atol=1e-7)


def transformation(R: Any, t: Any) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, np.ravel(t)
    return T


def rotation_of_wxyz(w: float, x: float, y: float, z: float) -> np.ndarray:
    """The matrix of a unit quaternion, written out."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
