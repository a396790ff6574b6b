"""A perspective rectification as OpenCV's `stereoRectify` gives one: R1, R2, P1, P2, Q."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rectbench.errors import Unsupported
from rectbench.types import FloatArray
from rectbench.warps.rectification import Rectification
from rectbench.warps.targets import Perspective

SAME = 1e-9
"""What differs by less, relative to its size, is rounding."""


class OpenCVForm(NamedTuple):
    """The matrices under the names that OpenCV has for them, pixels and metres."""

    R1: FloatArray
    """[3, 3], from the left camera's frame to the rectified one."""
    R2: FloatArray
    """[3, 3], from the right camera's."""
    P1: FloatArray
    """[3, 4], pixels of the rectified left image from points in its frame."""
    P2: FloatArray
    """[3, 4], of the right image from points in the left one's rectified frame."""
    Q: FloatArray
    """[4, 4], (X, Y, Z, W) = Q (û_left, v̂, disparity, 1), for `cv2.reprojectImageTo3D`."""


def opencv_form(rect: Rectification) -> OpenCVForm:
    """The same rectification in OpenCV's form.

    Raises Unsupported, with the reason, where it has none: an image that is no perspective one, or a pair
    whose cameras are not parallel after rectification, as a homography from matches leaves them.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> rb.opencv_form(rb.rectify(rig, method="conventional")).P1.round(1)
    array([[285.9,   0. , 425.4,   0. ],
           [  0. , 285.9, 401.1,   0. ],
           [  0. ,   0. ,   1. ,   0. ]])
    """
    K_left, K_right = (_intrinsics(target) for target in (rect.left.target, rect.right.target))
    turn = rect.R_rect_right @ rect.rig.R_right_left @ rect.R_rect_left.T
    baseline = rect.R_rect_right @ rect.rig.t_right_left
    if np.abs(turn - np.eye(3)).max() > SAME or np.abs(baseline[1:]).max() > SAME * np.linalg.norm(baseline):
        raise Unsupported("the rectified cameras are not parallel to each other and across their baseline")
    if np.abs(K_left[1] - K_right[1]).max() > SAME * K_left[1, 1]:
        raise Unsupported("the two images have different rows")
    P1 = np.column_stack([K_left, np.zeros(3)])
    P2 = np.column_stack([K_right, K_right @ [baseline[0], 0, 0]])
    Q = _reprojection(K_left, K_right, baseline[0])
    return OpenCVForm(rect.R_rect_left, rect.R_rect_right, P1, P2, Q)


def _intrinsics(target: object) -> FloatArray:
    """K [3, 3] of a target that is an image with square pixels, as the field means it."""
    if not isinstance(target, Perspective):
        raise Unsupported(f"the rectified image is no perspective one but {type(target).__name__}")
    if not target.matrix[2, 2] > 0:
        raise Unsupported("the rectified image looks away from the rectified frame's axis")
    K = target.matrix / target.matrix[2, 2]
    focal = K[0, 0]
    square = np.array([[focal, 0, K[0, 2]], [0, focal, K[1, 2]], [0, 0, 1]])
    if not focal > 0 or np.abs(K - square).max() > SAME * focal:
        raise Unsupported("the rectified image has no single focal length: it is stretched or skewed")
    return square


def _reprojection(K_left: FloatArray, K_right: FloatArray, t_x: float) -> FloatArray:
    focal, cx, cy = K_left[0, 0], K_left[0, 2], K_left[1, 2]
    return np.array(
        [[1, 0, 0, -cx], [0, 1, 0, -cy], [0, 0, 0, focal], [0, 0, -1 / t_x, (cx - K_right[0, 2]) / t_x]]
    )
