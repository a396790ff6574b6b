"""Coverage: how much of the source is kept, and how much of the output shows anything."""

from __future__ import annotations

from typing import Any

import numpy as np

from rectbench.cameras import Camera
from rectbench.cameras.projection import projected_partials
from rectbench.formulas.evaluation import evaluate_points
from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification, Warp
from rectbench.warps.rectification import in_frame
from rectbench.warps.warp import rotated

DENSE_PIXELS = 150_000
"""Coverage and order look at about this many pixels of an image, on a regular grid."""


def dense_pixels(camera: Camera, count: int = DENSE_PIXELS) -> FloatArray:
    """A regular grid of whole pixels [N, 2] that the lens sees; all of them in a small image."""
    step = max(1, round((camera.width * camera.height / count) ** 0.5))
    grid = camera.pixel_grid()[step // 2 :: step, step // 2 :: step].reshape(-1, 2)
    return grid[camera.unproject(grid)[1]]


def coverage(rect: Rectification, rig: Rig) -> dict[str, float]:
    """Shares kept of the source pixels, of their solid angle, of the overlap; share of output valid.

    Each is the mean of both images. The overlap is what the other camera sees too, of points at
    infinity.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> kept = coverage(rb.rectify(rig, method="abraham"), rig)
    >>> 0 < kept["coverage_overlap"] <= 1
    True
    """
    sides = ((rect.left, rig.right, rig.R_right_left), (rect.right, rig.left, rig.R_right_left.T))
    shares = np.array([_kept_shares(warp, other, R, rect.size) for warp, other, R in sides])
    pixels, solid_angle, overlap = shares.mean(axis=0)
    valid = [rect.valid("left").mean(), rect.valid("right").mean()]
    source_pixels = np.mean([camera.width * camera.height for camera in (rig.left, rig.right)])
    return {
        "coverage_pixels": float(pixels),
        "coverage_solid_angle": float(solid_angle),
        "coverage_overlap": float(overlap),
        "valid_output": float(np.mean(valid)),
        "output_pixels_per_source_pixel": float(rect.size[0] * rect.size[1] / source_pixels),
    }


def _kept_shares(
    warp: Warp, other: Camera, R_other_cam: FloatArray, size: tuple[int, int]
) -> tuple[float, float, float]:
    def formula(c: Any, u: Any, v: Any, xp: Any) -> tuple[Any, ...]:
        x, y, z, ok = warp.source.unproject_formula(c.warp.source, u, v, xp)
        du, dv, _ = projected_partials(warp.source, c.warp.source, x, y, z, xp)
        u_other, v_other, shared = other.project_formula(c.other, *rotated(c.R_other_cam, x, y, z), xp)
        nowhere = 0.0 * u - 1e9
        return solid_angle(du, dv, xp), *(xp.where(shared, w, nowhere) for w in (u_other, v_other)), ok

    pixels = dense_pixels(warp.source)
    kept = in_frame(warp.forward(pixels), size)
    rows = tuple(tuple(map(float, row)) for row in R_other_cam)
    constants = {"warp": warp.constants, "other": other.constants, "R_other_cam": rows}
    seen, _ = evaluate_points(formula, constants, pixels)
    angle, shared = seen[:, 0], other.contains(seen[:, 1:])
    overlap = kept[shared].mean() if shared.any() else np.nan
    return float(kept.mean()), float(angle[kept].sum() / angle.sum()), float(overlap)


def solid_angle(du: Any, dv: Any, xp: Any) -> Any:
    """Solid angle of a pixel, steradians, from the projection's gradients du/d(ray) and dv/d(ray)."""
    uu, uv, vv = (sum(p * q for p, q in zip(a, b, strict=True)) for a, b in ((du, du), (du, dv), (dv, dv)))
    return 1.0 / xp.sqrt(uu * vv - uv * uv)


class Coverage(Metric):
    """How much of the source is kept, and how much of the output shows anything."""

    name, topic = "coverage", "Coverage"
    columns = (
        Column.share(
            "coverage_pixels",
            "pixels kept",
            "higher",
            "Share of source pixels that reach the output.",
            tolerance=Tolerance(0.0, 0.002),
            promised=True,
        ),
        Column.share(
            "coverage_solid_angle",
            "field of view kept",
            "higher",
            "Share of the lens's solid angle that is kept.",
            tolerance=Tolerance(0.0, 0.002),
            promised=True,
        ),
        Column.share(
            "coverage_overlap",
            "overlap kept",
            "higher",
            "Share of the view common to both cameras that is kept.",
            shown="pairs",
        ),
        Column.share(
            "valid_output",
            "output used",
            "higher",
            "Share of the output that shows anything.",
            shown="pairs",
            promised=True,
        ),
        Column(
            "output_pixels_per_source_pixel",
            "output / source",
            "px/px",
            None,
            "Pixels of output spent on one pixel of source.",
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Means of both images."""
        return coverage(case.rect, case.rig)
