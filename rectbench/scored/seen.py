"""What the lenses of a rig see, on a dense grid: that of which coverage is a share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rectbench.cameras import Camera
from rectbench.cameras.projection import projected_partials
from rectbench.formulas.evaluation import evaluate_points
from rectbench.rigs import Rig
from rectbench.types import BoolArray, FloatArray
from rectbench.warps.warp import rotated

DENSE_PIXELS, FEW_PIXELS = 60_000, 2_000
"""About so many pixels of an image, on a regular grid, coverage looks at; order at so few."""


def dense_pixels(camera: Camera, count: int = DENSE_PIXELS) -> FloatArray:
    """A regular grid of whole pixels [N, 2] that the lens sees; all of them in a small image."""
    step = max(1, round((camera.width * camera.height / count) ** 0.5))
    u, v = (np.arange(step // 2, side, step, dtype=float) for side in camera.size)
    grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    return grid[camera.unproject(grid)[1]]


@dataclass(frozen=True, eq=False)
class SeenPixels:
    """Pixels of one image on a dense grid."""

    pixels: FloatArray = field(repr=False)
    """[N, 2], those that the lens sees."""
    solid_angle_sr: FloatArray = field(repr=False)
    """[N], of each pixel."""
    shared: BoolArray = field(repr=False)
    """[N], whether the other camera sees it too, as a point at infinity."""
    few: FloatArray = field(repr=False)
    """[K, 2], a coarser such grid, for what takes longer a pixel."""

    @classmethod
    def of(cls, camera: Camera, other: Camera, R_other_cam: FloatArray) -> SeenPixels:
        """Those of a camera beside another one, turned by R_other_cam [3, 3] against it."""

        def formula(c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, ...]:
            x, y, z, ok = camera.unproject_formula(c.camera, u, v, xp)
            du, dv, _ = projected_partials(camera, c.camera, x, y, z, xp)
            u_other, v_other, shared = other.project_formula(c.other, *rotated(c.R, x, y, z), xp)
            nowhere = 0.0 * u - 1e9
            return solid_angle(du, dv, xp), *(xp.where(shared, w, nowhere) for w in (u_other, v_other)), ok

        pixels = dense_pixels(camera)
        rows = tuple(tuple(map(float, row)) for row in R_other_cam)
        constants = {"camera": camera.constants, "other": other.constants, "R": rows}
        seen, _ = evaluate_points(formula, constants, pixels)
        return cls(pixels, seen[:, 0], other.contains(seen[:, 1:]), dense_pixels(camera, FEW_PIXELS))


@dataclass(frozen=True, eq=False)
class SeenView:
    """The dense pixels of both images of a rig."""

    left: SeenPixels
    right: SeenPixels

    @classmethod
    def of(cls, rig: Rig) -> SeenView:
        """What the lenses of a rig see, whatever of it is trimmed."""
        left, right = rig.left.whole, rig.right.whole
        return cls(
            SeenPixels.of(left, right, rig.R_right_left), SeenPixels.of(right, left, rig.R_right_left.T)
        )


def solid_angle(du: Any, dv: Any, xp: Any) -> Any:
    """Solid angle of a pixel, steradians, from the projection's gradients du/d(ray) and dv/d(ray)."""
    uu, uv, vv = (sum(p * q for p, q in zip(a, b, strict=True)) for a, b in ((du, du), (du, dv), (dv, dv)))
    return 1.0 / xp.sqrt(uu * vv - uv * uv)
