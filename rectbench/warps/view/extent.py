"""Which angles exist in a rig's images, and the frame that just holds them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rectbench.cameras import Camera
from rectbench.rigs import Rig
from rectbench.types import FloatArray
from rectbench.warps.frame import angles, rectifying_rotations
from rectbench.warps.view.sampling import outline_pixels

ABOUT_DEG, ABOUT_RAYS = 20, 360
"""How far around the cones where a lens is blind its view is looked at ray by ray, and rays a ring."""


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
        gammas.append(_range(gamma, margin, _reach(camera, R_rect_cam)))
        betas.append(_range(np.append(beta, _beta_about(camera, R_rect_cam)), margin, math.pi))
    return ViewAngles(gammas[0], gammas[1], _union(betas[0], betas[1]))


def _reach(camera: Camera, R_rect_cam: FloatArray) -> float:
    """The greatest |γ| that the camera can see."""
    if camera.blind is None:
        return math.pi / 2
    off = np.linalg.norm((R_rect_cam @ camera.blind.axis)[1:])
    return math.pi / 2 - max(0.0, math.radians(camera.blind.within_deg) - math.asin(min(1.0, float(off))))


def _beta_about(camera: Camera, R_rect_cam: FloatArray) -> FloatArray:
    """The angles β [N] that the camera sees around the cones where it is blind, to a degree.

    So near to the epipoles pixels of a grid are many degrees of β apart.
    """
    if camera.blind is None:
        return np.empty(0)
    off = math.radians(camera.blind.within_deg) + np.radians(np.arange(ABOUT_DEG + 1))
    rays = camera.blind.rings(off, ABOUT_RAYS)
    _, beta = angles(rays[camera.sees(rays)] @ R_rect_cam.T)
    return np.concatenate([beta - math.pi / ABOUT_RAYS, beta + math.pi / ABOUT_RAYS])


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
        for camera, R_rect_cam in zip((rig.left.whole, rig.right.whole), rotations, strict=True)
    ]
    return np.stack(rays)
