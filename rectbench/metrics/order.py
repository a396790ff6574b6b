"""Order: whether a rectification keeps the order of points along rows and of rows, and can be undone."""

from __future__ import annotations

import math

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.rigs import Rig
from rectbench.scored import SeenView
from rectbench.types import FloatArray
from rectbench.warps import Rectification, Warp, rectifying_rotations
from rectbench.warps.rectification import in_frame


def order(rect: Rectification, rig: Rig) -> dict[str, float]:
    """Least ∂û/∂γ and ∂v̂/∂β in px/rad, share of pixels where both are positive, closure of the inverse.

    (β, γ) belong to the true `rig`. Closure is the greatest |inverse(forward(x)) - x| in source
    pixels. All over pixels of both images that stay in the frame.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> order(rb.rectify(rig, method="abraham"), rig)["order_upright"]
    1.0
    """
    return order_of(rect, rig, SeenView.of(rig))


def order_of(rect: Rectification, rig: Rig, seen: SeenView) -> dict[str, float]:
    """The same, with what the rig's lenses see."""
    rotations = rectifying_rotations(rig)
    given = ((rect.left, rotations[0], seen.left.few), (rect.right, rotations[1], seen.right.few))
    sides = [_side(*side, rect.size) for side in given]
    along, across, upright, closure = (np.concatenate(values) for values in zip(*sides, strict=True))
    if not along.size:
        return {column.key: math.nan for column in Order.columns}
    return {
        "order_du_dgamma_min": float(along.min()),
        "order_dv_dbeta_min": float(across.min()),
        "order_upright": float(upright.mean()),
        "closure_px": float(closure.max()),
    }


def _side(
    warp: Warp, R_epi_cam: FloatArray, seen_px: FloatArray, size: tuple[int, int]
) -> tuple[FloatArray, ...]:
    mapped = warp.forward(seen_px)
    shown = in_frame(mapped, size)
    pixels, mapped = seen_px[shown], mapped[shown]
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


class Order(Metric):
    """Whether points keep their order along rows and rows theirs, and whether the map can be undone."""

    name, topic = "order", "Order"
    columns = (
        Column(
            "order_du_dgamma_min",
            "least ∂û/∂γ",
            "px/rad",
            None,
            "Least growth of the column along an epipolar line; below 0, points change places.",
            average="min",
            shown="pairs",
        ),
        Column(
            "order_dv_dbeta_min",
            "least ∂v̂/∂β",
            "px/rad",
            None,
            "Least growth of the row from one epipolar line to the next; below 0, rows change places.",
            average="min",
            shown="pairs",
        ),
        Column.share(
            "order_upright",
            "upright",
            "higher",
            "Share of pixels that are not mirrored (det J > 0).",
            shown="pairs",
        ),
        Column.pixels(
            "closure_px",
            "closure",
            "Largest |inverse(forward(x)) − x| in source pixels.",
            average="max",
            tolerance=Tolerance(0.0, 1e-6),
            shown="pairs",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Over the pixels of both images that stay in the frame."""
        return order_of(case.rect, case.rig, case.pair.seen_view)
