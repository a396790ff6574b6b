"""Whether the two views of a rig have anything in common, and how much."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from rectbench.errors import Unsupported
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.view.sampling import evaluation_pixels

INVERSE_DISTANCES = (0.0, 0.005, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
"""At these a point is looked for in the other view, 1 / baselines: cameras may converge on what is near."""
SAMPLED_PIXELS = 2_000
LEAST_SHARE_PIXELS = 50_000
"""Where none of the first pixels is seen by the other camera, these are asked: an overlap may be a sliver."""


def overlap_share(rig: Rig, count: int = SAMPLED_PIXELS) -> float:
    """The share of the left view that the right camera sees too, at some distance from half a baseline on.

    >>> import rectbench as rb
    >>> round(overlap_share(rb.load_rig("t265")), 2)
    1.0
    """
    rays = rig.left.unproject(evaluation_pixels(rig.left, count))[0] @ rig.R_right_left.T
    inverse = np.array(INVERSE_DISTANCES)[:, None, None] / rig.baseline_m
    seen = rig.right.sees(rays + inverse * rig.t_right_left)
    return float(seen.any(axis=0).mean()) if len(rays) else 0.0


def require_overlap(rig: Rig) -> None:
    """Raise Unsupported, with how the cameras stand, where the views have nothing in common."""
    if _overlap(rig):
        return
    raise Unsupported(
        f"the two views of rig {rig.name} have nothing in common: their overlap is 0 %, the cameras look "
        f"{_apart_deg(rig.R_right_left):.0f} degrees apart with lenses of {rig.left.fov_deg:.0f} and "
        f"{rig.right.fov_deg:.0f} degrees"
    )


@lru_cache(maxsize=64)
def _overlap(rig: Rig) -> bool:
    """Whether they have anything in common; all methods of a rig ask for the same."""
    return bool(overlap_share(rig) or overlap_share(rig, LEAST_SHARE_PIXELS))


def _apart_deg(R: FloatArray) -> float:
    """The angle between the two optical axes."""
    return float(np.degrees(np.arccos(np.clip(R[2, 2], -1.0, 1.0))))
