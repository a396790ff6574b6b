"""Which angles exist in a rig's images, and the frame that just holds them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.frame import angles, rectifying_rotations
from rectbench.warps.view.sampling import outline_pixels


class Range(NamedTuple):
    """An interval of angles, radians."""

    low: float
    high: float


class ViewAngles(NamedTuple):
    """The angles of the pixels that exist: γ an image, β of both (rows are shared).

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> round(rb.view_angles(rig).gamma.high, 3)
    1.401
    """

    gamma_left: Range
    gamma_right: Range
    beta: Range

    @property
    def gamma(self) -> Range:
        """The γ of either image."""
        return _union(self.gamma_left, self.gamma_right)


def view_angles(rig: Rig) -> ViewAngles:
    """Ranges of γ and β over all pixels of both images, in the rig's rectified frame.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> np.degrees(rb.view_angles(rb.load_rig("t265"))).round()
    array([[-81.,  80.],
           [-80.,  80.],
           [-81.,  81.]])
    """
    gammas: list[Range] = []
    betas: list[Range] = []
    for camera, R_rect_cam in zip((rig.left, rig.right), rectifying_rotations(rig), strict=True):
        pixels, spacing = outline_pixels(camera)
        gamma, beta = angles(camera.unproject(pixels)[0] @ R_rect_cam.T)
        # Between two grid pixels the image circle may reach further, by their spacing at the most.
        margin = spacing / max(camera.size)
        gammas.append(_range(gamma, margin, math.pi / 2))
        betas.append(_range(beta, margin, math.pi))
    return ViewAngles(gammas[0], gammas[1], _union(betas[0], betas[1]))


def _union(a: Range, b: Range) -> Range:
    return Range(min(a.low, b.low), max(a.high, b.high))


def _range(values: FloatArray, margin: float, limit: float) -> Range:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    slack = margin * (high - low)
    return Range(max(low - slack, -limit), min(high + slack, limit))


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
        for camera, R_rect_cam in zip((rig.left, rig.right), rotations, strict=True)
    ]
    return np.stack(rays)
