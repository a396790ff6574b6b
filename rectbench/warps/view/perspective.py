"""Where a perspective rectification looks: its plane lies along the baseline, and shows one half of space."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rectbench.errors import Unsupported
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.frame import forward_rotations, turned_about_x
from rectbench.warps.view.sampling import evaluation_pixels

FARTHEST = math.tan(math.radians(60.0))
"""No farther from the foot of the perpendicular than this, as a multiple of its distance, the image's middle
lies: it would be stretched beyond use there, and along the baseline there is no plane."""
OFF_AXIS = math.tan(math.radians(35.0))
"""While the sources' middles are no farther from that foot, the image shows most about them; beyond, it shows
more about the middle of what lies in front."""
TURNS = 180
"""Directions about the baseline, 2° apart, among which the plane's is found."""


class PerspectiveFrame(NamedTuple):
    """The frame of a perspective rectification: x along the baseline, z across the image plane.

    >>> import rectbench as rb
    >>> rb.PerspectiveFrame.of(rb.load_rig("t265")).middle.round(3)
    array([-0.007, -0.006])
    """

    R_rect_left: FloatArray
    """Rectified from left camera frame [3, 3]."""
    R_rect_right: FloatArray
    """Rectified from right camera frame [3, 3]."""
    middle: FloatArray
    """(x/z, y/z) [2] of what the image is to show in its middle, the mean of both."""

    @classmethod
    def of(cls, rig: Rig) -> PerspectiveFrame:
        """That of a rig: looking ahead, with the sources' middles in the middle, where this shows them.

        Where a source's middle is far off in that plane or behind it, as of a camera that looks along the
        baseline, the plane is turned about the baseline to where it shows most of both views. Raises
        Unsupported where no such plane shows both.
        """
        rotations = forward_rotations(rig)
        cameras = rig.left.whole, rig.right.whole
        centres = [((np.array(camera.size) - 1) / 2)[None] for camera in cameras]
        rays = np.concatenate(
            [c.unproject(px)[0] @ R.T for c, px, R in zip(cameras, centres, rotations, strict=True)]
        )
        if (np.abs(rays[:, :2]) <= OFF_AXIS * rays[:, 2:]).all():
            return cls(*rotations, _middle(rays))
        views = [
            camera.unproject(evaluation_pixels(camera))[0] @ R.T
            for camera, R in zip((rig.left, rig.right), rotations, strict=True)
        ]
        beta = 2 * math.pi * np.arange(TURNS) / TURNS
        towards = np.stack([np.zeros(TURNS), np.sin(beta), np.cos(beta)])
        shown = [np.maximum(view @ towards, 0.0).mean(axis=0) for view in views]
        both = shown[0] * shown[1]
        if not both.any():
            raise Unsupported(
                "no plane along the baseline shows both views: seen from there they look to opposite sides"
            )
        turn = turned_about_x(-float(beta[both.argmax()]))
        in_front = [np.maximum((view @ turn.T)[:, 2:], 0.0) * (view @ turn.T) for view in views]
        rays = np.stack([weighted.sum(axis=0) for weighted in in_front])
        return cls(turn @ rotations[0], turn @ rotations[1], _middle(rays))


def _middle(rays: FloatArray) -> FloatArray:
    middle: FloatArray = np.clip(rays[:, :2] / rays[:, 2:], -FARTHEST, FARTHEST).mean(axis=0)
    return middle
