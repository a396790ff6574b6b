"""Which angles exist in a rig's images, and the frame that just holds them."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from rectbench.cameras import Camera
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.frame import angles, rectifying_rotations
from rectbench.warps.view.boundary import extremes

SLACK_RAD = 1e-5
"""By so much more than the angles that were found, so that rounding loses no pixel."""


class Range(NamedTuple):
    """An interval of angles, radians."""

    low: float
    high: float


class ViewAngles(NamedTuple):
    """The angles of the pixels that exist: γ an image, β of both (rows are shared).

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> round(rb.view_angles(rig).gamma.high, 3)
    1.395
    """

    gamma_left: Range
    gamma_right: Range
    beta: Range

    @property
    def gamma(self) -> Range:
        """The γ of either image."""
        return _union(self.gamma_left, self.gamma_right)


@lru_cache(maxsize=64)
def view_angles(rig: Rig) -> ViewAngles:
    """Ranges of γ and β over all pixels of both images, in the rig's rectified frame; exact to 1e-5 rad.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> np.degrees(rb.view_angles(rb.load_rig("t265"))).round()
    array([[-80.,  80.],
           [-80.,  80.],
           [-80.,  80.]])
    """
    rotations = rectifying_rotations(rig)
    (gamma_left, beta_left), (gamma_right, beta_right) = (
        _ranges(camera, R_rect_cam)
        for camera, R_rect_cam in zip((rig.left, rig.right), rotations, strict=True)
    )
    return ViewAngles(gamma_left, gamma_right, _union(beta_left, beta_right))


def _ranges(camera: Camera, R_rect_cam: FloatArray) -> tuple[Range, Range]:
    """γ and β that the camera sees: on its boundary, and at an epipole, where all epipolar lines meet."""
    low, high = extremes(camera, lambda rays: np.stack(angles(rays @ R_rect_cam.T)))
    behind, ahead = camera.sees(np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) @ R_rect_cam)
    gamma = Range(-math.pi / 2 if behind else low[0], math.pi / 2 if ahead else high[0])
    beta = Range(-math.pi, math.pi) if behind or ahead else Range(low[1], high[1])
    return _widened(gamma, math.pi / 2), _widened(beta, math.pi)


def _widened(angles: Range, limit: float) -> Range:
    return Range(max(float(angles.low) - SLACK_RAD, -limit), min(float(angles.high) + SLACK_RAD, limit))


def _union(a: Range, b: Range) -> Range:
    return Range(min(a.low, b.low), max(a.high, b.high))


def perspective_size(rig: Rig) -> tuple[int, int]:
    """(width, height) of a perspective rectification: that of the larger source image, each way.

    >>> import rectbench as rb
    >>> rb.perspective_size(rb.load_rig("t265"))
    (848, 800)
    """
    return max(rig.left.width, rig.right.width), max(rig.left.height, rig.right.height)


def centre_rays(rig: Rig) -> FloatArray:
    """Rays [2, 3] of the middle pixels of both images, in the rectified frame.

    >>> import rectbench as rb
    >>> rb.centre_rays(rb.load_rig("t265")).round(2)
    array([[ 0.  , -0.01,  1.  ],
           [-0.02,  0.  ,  1.  ]])
    """
    rotations = rectifying_rotations(rig)
    rays = [
        camera.unproject([(camera.width - 1) / 2, (camera.height - 1) / 2])[0] @ R_rect_cam.T
        for camera, R_rect_cam in zip((rig.left.whole, rig.right.whole), rotations, strict=True)
    ]
    return np.stack(rays)
