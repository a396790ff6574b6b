"""Order: whether a rectification keeps the order of points along rows and of rows, and can be undone."""

from __future__ import annotations

import math

import numpy as np

from rectbench.metrics.coverage import dense_pixels
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps import Rectification, Warp, rectifying_rotations
from rectbench.warps.rectification import in_frame

ORDER_PIXELS = 5_000


def order(rect: Rectification, rig: Rig) -> dict[str, float]:
    """Least ∂û/∂γ and ∂v̂/∂β in px/rad, share of pixels where both are positive, closure of the inverse.

    (β, γ) belong to the true `rig`. Closure is the greatest |inverse(forward(x)) - x| in source
    pixels. All over pixels of both images that stay in the frame.
    """
    rotations = rectifying_rotations(rig)
    sides = [_side(warp, R, rect.size) for warp, R in zip((rect.left, rect.right), rotations, strict=True)]
    along, across, upright, closure = (np.concatenate(values) for values in zip(*sides, strict=True))
    if not along.size:
        return dict.fromkeys(
            ("order_du_dgamma_min", "order_dv_dbeta_min", "order_upright", "closure_px"), math.nan
        )
    return {
        "order_du_dgamma_min": float(along.min()),
        "order_dv_dbeta_min": float(across.min()),
        "order_upright": float(upright.mean()),
        "closure_px": float(closure.max()),
    }


def _side(warp: Warp, R_epi_cam: FloatArray, size: tuple[int, int]) -> tuple[FloatArray, ...]:
    pixels = dense_pixels(warp.source, ORDER_PIXELS)
    mapped = warp.forward(pixels)
    pixels, mapped = pixels[in_frame(mapped, size)], mapped[in_frame(mapped, size)]
    J = warp.jacobian(pixels)
    rays, _ = warp.source.unproject(pixels)
    x, y, z = np.moveaxis(rays @ R_epi_cam.T, -1, 0)
    off = np.hypot(y, z)
    d_gamma = np.stack([off, -x * y / off, -x * z / off], axis=-1) @ R_epi_cam
    d_beta = np.stack([np.zeros_like(x), z, -y], axis=-1) @ R_epi_cam
    to_pixel = J @ warp.source.project_jacobian(rays)
    du_dgamma = (to_pixel[..., 0, :] * d_gamma).sum(axis=-1)
    dv_dbeta = (to_pixel[..., 1, :] * d_beta).sum(axis=-1)
    upright = ((du_dgamma > 0) & (dv_dbeta > 0)).astype(float)
    closure = np.linalg.norm(warp.inverse(mapped) - pixels, axis=-1)
    return du_dgamma, dv_dbeta, upright, closure
