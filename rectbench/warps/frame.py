"""The epipolar frame: x along the baseline, in which a ray is the pair of angles (β, γ).

    β = atan2(y, z)              the epipolar plane, equal in both images for one point
    γ = atan2(x, hypot(y, z))    the place along the epipolar line

(Zhou, Dai and Li, section III-B; with atan2, so that |β| may pass 90°.)
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.cameras import Camera
from rectbench.errors import Unsupported
from rectbench.rigs import Rig
from rectbench.types import FloatArray

EDGE_STEP_RAD = 1e-6
"""An epipole nearer to the edge of the view than this counts as lying on the edge, outside."""


def rectifying_rotations(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """(R_rect_left, R_rect_right), camera to rectified frame, after Bouguet.

    Each camera takes half the relative rotation; then the smallest rotation lays the baseline on
    the x axis, so that disparity is positive. A pair given right camera first, whose right camera stands
    rather to the left of the left one than above, below, before or behind it, keeps its images upright
    instead, and has `signed_baseline_m` below zero.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> R_rect_left, R_rect_right = rb.rectifying_rotations(rig)
    >>> (R_rect_right @ rig.t_right_left / rig.baseline_m).round(9) + 0.0  # the baseline is the x axis
    array([-1.,  0.,  0.])
    """
    half = Rotation.from_matrix(rig.R_right_left).as_rotvec() / 2
    R_mid_left = Rotation.from_rotvec(half).as_matrix()
    R_mid_right = Rotation.from_rotvec(-half).as_matrix()
    baseline = R_mid_left @ rig.centre_right_in_left / rig.baseline_m
    R_rect_mid = _smallest_rotation_onto_x(baseline)
    return R_rect_mid @ R_mid_left, R_rect_mid @ R_mid_right


def signed_baseline_m(rig: Rig) -> float:
    """x of the right camera's centre in the left camera's rectified frame, metres."""
    R_rect_left, _ = rectifying_rotations(rig)
    return float((R_rect_left @ rig.centre_right_in_left)[0])


def _smallest_rotation_onto_x(direction: FloatArray) -> FloatArray:
    """The rotation of least angle that takes `direction` to the x axis, or to -x where it points there."""
    x, y, z = direction
    target = np.array([-1.0 if x < -max(abs(y), abs(z)) else 1.0, 0.0, 0.0])
    w = np.cross(direction, target)
    cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    rotation: FloatArray = np.eye(3) + cross + cross @ cross / (1 + direction @ target)
    return rotation


def angles(rays: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(γ, β) in radians [...] of rays [..., 3] in the rectified frame."""
    x, y, z = np.moveaxis(rays, -1, 0)
    return np.atan2(x, np.hypot(y, z)), np.atan2(y, z)


def refuse_epipole_in_view(rig: Rig) -> None:
    """Raise Unsupported where an epipole lies inside the view of either camera.

    All epipolar planes meet there, so that no map to scan lines can be continuous.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> lens = rb.load_rig("t265").left
    >>> rb.refuse_epipole_in_view(rb.Rig(lens, lens, np.eye(3), np.array([-0.1, 0.0, 0.0])))
    >>> in_a_row = rb.Rig(lens, lens, np.eye(3), np.array([0.0, 0.0, -0.1]))
    >>> rb.refuse_epipole_in_view(in_a_row)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    rectbench.errors.Unsupported: an epipole of rig ... lies in the left view, at pixel (420, 403) of ...
    """
    towards_right = rig.centre_right_in_left / rig.baseline_m
    baselines = {"left": (rig.left, towards_right), "right": (rig.right, rig.R_right_left @ towards_right)}
    for side, (camera, direction) in baselines.items():
        for ray in (direction, -direction):
            if _strictly_sees(camera, ray):
                (u, v), _ = camera.project(ray)
                raise Unsupported(
                    f"an epipole of rig {rig.name} lies in the {side} view, at pixel "
                    f"({u:.0f}, {v:.0f}) of {camera.width}x{camera.height}; if the lens shows nothing there, "
                    "state its image circle (max_angle_deg)"
                )


def _strictly_sees(camera: Camera, ray: FloatArray) -> bool:
    """Whether the ray lands between pixel centres, with the domain reaching a little beyond it."""
    off_axis = np.array([ray[0], ray[1], 0.0])
    outward = ray + EDGE_STEP_RAD * (off_axis / max(np.linalg.norm(off_axis), EDGE_STEP_RAD) - [0, 0, 1])
    pixels, ok = camera.project(np.stack([ray, outward]))
    inside = (pixels[0] >= 0).all() and (pixels[0] <= np.array(camera.size) - 1).all()
    return bool(ok.all() and inside)


def centre_resolution_px(rig: Rig) -> float:
    """Pixels per radian on the optical axis, the mean of the two cameras.

    >>> import rectbench as rb
    >>> round(rb.centre_resolution_px(rb.load_rig("t265")), 1)
    285.9
    """
    rates = [
        np.sqrt(abs(np.linalg.det(camera.project_jacobian([0.0, 0.0, 1.0])[:, :2])))
        for camera in (rig.left, rig.right)
    ]
    return float(np.mean(rates))
