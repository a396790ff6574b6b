"""Rigs and poses that several tests share, and hypothesis strategies over them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import rectbench as rb

LENSES: dict[str, dict[str, float]] = {
    "equidistant": {},
    "equisolid": {},
    "stereographic": {},
    "kannala-brandt": {"k1": 0.02, "k2": -0.008, "k3": 0.002, "k4": -0.0003},
    "unified": {"xi": 0.9, "k1": -0.05, "k2": 0.01, "p1": 3e-4, "p2": -2e-4},
    "extended-unified": {"alpha": 0.6, "beta": 1.1},
    "double-sphere": {"xi": -0.2, "alpha": 0.58},
    "field-of-view": {"omega": 0.92},
}


def camera(
    model: str = "equidistant", size: tuple[int, int] = (480, 320), fov_deg: float = 120.0
) -> rb.Camera:
    """A camera that sees `fov_deg` across, its principal point a little off the middle."""
    half = np.radians(fov_deg) / 2
    unit = rb.Camera(model, size, {"fx": 1, "fy": 1, **LENSES[model]})
    (reach, _), _ = unit.project([np.sin(half), 0, np.cos(half)])
    focal = size[0] / 2 / reach
    centre = {"cx": (size[0] - 1) / 2 + 2.3, "cy": (size[1] - 1) / 2 - 1.7}
    return rb.Camera(model, size, {"fx": focal, "fy": focal * 1.003, **centre, **LENSES[model]})


def rig(
    model: str = "equidistant",
    rotation_deg: tuple[float, float, float] = (1.0, -2.0, 0.7),
    centre_m: tuple[float, float, float] = (0.12, 0.006, -0.004),
    **kwargs: object,
) -> rb.Rig:
    """Two equal cameras, the right one turned by a rotation vector and moved to `centre_m`."""
    lens = camera(model, **kwargs)  # type: ignore[arg-type]
    R = Rotation.from_rotvec(np.radians(rotation_deg)).as_matrix()
    return rb.Rig(lens, lens, R, -R @ np.array(centre_m), name=f"{model}-test")


def aligned_rig(width: int, height: int, fov_deg: float, max_angle_deg: float | None = None) -> rb.Rig:
    """Two equidistant cameras side by side, as in the table of figures to check against."""
    focal = width / np.radians(fov_deg)
    centre = {"cx": (width - 1) / 2, "cy": (height - 1) / 2}
    lens = rb.Camera("equidistant", (width, height), {"fx": focal, "fy": focal, **centre}, max_angle_deg)
    return rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0, 0]), name="aligned")


def points_before(rig: rb.Rig, count: int = 300, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points [N, 3] in the left camera's frame that both cameras see, and their pixels [N, 2] each."""
    rng = np.random.default_rng(seed)
    pixels = rng.uniform([0, 0], np.array(rig.left.size) - 1, (count, 2))
    rays, ok = rig.left.unproject(pixels)
    points = rays * rng.uniform(4, 60, (count, 1)) * rig.baseline_m
    px_right, seen = rig.right.project(rig.right_from_left(points))
    both = ok & seen & rig.right.contains(px_right)
    return points[both], pixels[both], px_right[both]


small_turns = st.tuples(*[st.floats(-5, 5)] * 3)
off_axis_centres = st.tuples(st.floats(0.08, 0.4), st.floats(-0.02, 0.02), st.floats(-0.02, 0.02))
rigs = st.builds(rig, st.sampled_from(sorted(LENSES)), small_turns, off_axis_centres)
"""Rigs of every wide lens, nearly along x with small rotations, as in the paper."""


def assert_same_pose(read: rb.Rig, written: rb.Rig) -> None:
    """To rounding."""
    np.testing.assert_allclose(read.R_right_left, written.R_right_left, atol=1e-14)
    np.testing.assert_allclose(read.t_right_left, written.t_right_left, atol=1e-14)
