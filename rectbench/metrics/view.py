"""View: how much of what both images see a rectification keeps, from its middle outwards."""

from __future__ import annotations

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric, Tolerance
from rectbench.scored import SHARES
from rectbench.types import FloatArray
from rectbench.warps import Warp

PROJECTION, PERSPECTIVE = "projection", "perspective"
"""The note of a cell whose rectified images are perspective ones, whatever its method says of them."""
PERSPECTIVE_PX = 0.01
"""An image is a perspective one where a homography of its rays is this near to all of it."""
LEAST_PIXELS, SAMPLED = 32, 16
"""Of the view's scored pixels every so many are looked at; fewer tell nothing."""


def across_key(share: float) -> str:
    """The column of the field of view that A_s fills.

    >>> across_key(0.5)
    'view_50_deg'
    """
    return f"view_{100 * share:.0f}_deg"


def perspective_matrix(warp: Warp, pixels: FloatArray) -> FloatArray | None:
    """The homography [3, 3], rectified pixels from rays, that a warp is over source pixels [N, 2].

    Up to a factor. None where the image is not a perspective one, or too little of it is known.
    """
    some = pixels[:: max(1, min(SAMPLED, len(pixels) // LEAST_PIXELS))]
    px_rect, (rays, _) = warp.forward(some), warp.source.unproject(some)
    known = np.all(np.isfinite(px_rect), axis=-1)
    if known.sum() < LEAST_PIXELS:
        return None
    rays, px_rect = rays[known], px_rect[known]
    middle, spread = px_rect.mean(axis=0), px_rect.std()
    places = (px_rect - middle) / spread
    none = np.zeros_like(rays)
    across = np.hstack([rays, none, -places[:, :1] * rays])
    down = np.hstack([none, rays, -places[:, 1:] * rays])
    # The homography [9] that solves these equations best, of unit length (Hartley and Zisserman, 4.1).
    H = np.linalg.svd(np.vstack([across, down]), full_matrices=False)[2][-1].reshape(3, 3)
    homogeneous = rays @ H.T
    with np.errstate(divide="ignore", invalid="ignore"):
        off = (homogeneous[:, :2] / homogeneous[:, 2:] - places) * spread
    if not np.abs(off).max() < PERSPECTIVE_PX:
        return None
    P: FloatArray = np.array([[spread, 0, middle[0]], [0, spread, middle[1]], [0, 0, 1]]) @ H
    return P


def is_perspective(warp: Warp, pixels: FloatArray) -> bool:
    """Whether a homography takes the rays of source pixels [N, 2] to where the warp takes them.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> pixels = rb.ScoredView.of(rig).left.pixels
    >>> [is_perspective(rb.rectify(rig, m).left, pixels) for m in ("conventional", "abraham")]
    [True, False]
    """
    return perspective_matrix(warp, pixels) is not None


class View(Metric):
    """The share of the view that is wholly kept, and how wide shares of it are."""

    name, topic = "view", "Coverage"
    columns = (
        Column.share(
            "view_kept",
            "view kept",
            "higher",
            "The largest share of the source pixels, taken from the middle of what both images see "
            "outwards, of which "
            "the method shows every one.",
            tolerance=Tolerance(0.0, 0.005),
            shown="summary",
        ),
        *(
            Column(
                across_key(share),
                f"field of view, {100 * share:.0f} %",
                "°",
                None,
                f"Horizontal field of view of the {100 * share:.0f} % of the source pixels nearest to the"
                f" middle.",
                shown="rows",
            )
            for share in SHARES
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images: the lesser share kept, the mean field of view."""
        view = case.pair.scored_view
        if is_perspective(case.rect.left, view.left.pixels) and is_perspective(
            case.rect.right, view.right.pixels
        ):
            case.remarks[PROJECTION] = PERSPECTIVE
        across = {across_key(share): view.across_deg(share) for share in SHARES}
        return {"view_kept": case.delivered.kept_share, **across}
