"""The epipolar frame: x along the baseline, in which a ray is the pair of angles (β, γ).

    β = atan2(y, z)              the epipolar plane, equal in both images for one point
    γ = atan2(x, hypot(y, z))    the place along the epipolar line

(Zhou, Dai and Li, section III-B; with atan2, so that |β| may pass 90°.)
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.cameras import Camera
from rectbench.errors import Unsupported, argument
from rectbench.rigs import Rig
from rectbench.types import FloatArray

EDGE_STEP_RAD = 1e-6
"""An epipole nearer to the edge of the view than this counts as lying on the edge, outside."""
SEAM_STEPS = 180
"""Angles β, 2° apart, among which the seam is placed,"""
SEAM_PLACES = 91
"""and places along each epipolar line, at which it is told what a seam there would cut."""


@lru_cache(maxsize=64)
def rectifying_rotations(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """(R_rect_left, R_rect_right), camera to rectified frame, after Bouguet; read-only.

    Each camera takes half the relative rotation; then the smallest rotation lays the baseline on the x axis,
    so that disparities are positive. Of a pair that is given right camera first (`Rig.is_right_first`) it is
    laid on the opposite direction: its images stay upright, and `signed_baseline_m` is below zero.

    Where the lenses see β = ±180°, as where the view goes round an epipole, the frame is turned about the
    baseline, so that this seam cuts the least: to the middle of the largest gap between the angles β that
    are seen, or, where all are, to where its epipolar lines cross the fewest source pixels.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> R_rect_left, R_rect_right = rb.rectifying_rotations(rig)
    >>> (R_rect_right @ rig.t_right_left / rig.baseline_m).round(9) + 0.0  # the baseline is the x axis
    array([-1.,  0.,  0.])
    """
    rotations = forward_rotations(rig)
    if _seen_pixels(rig, rotations, np.array([math.pi])).any():
        turn = turned_about_x(math.pi - _seam_rad(rig, rotations))
        rotations = turn @ rotations[0], turn @ rotations[1]
    for rotation in rotations:
        rotation.flags.writeable = False
    return rotations


def forward_rotations(rig: Rig) -> tuple[FloatArray, FloatArray]:
    """The same wherever the seam lies: z is as near as can be to where the two cameras look, in the mean."""
    half = Rotation.from_matrix(rig.R_right_left).as_rotvec() / 2
    R_mid_left = Rotation.from_rotvec(half).as_matrix()
    R_mid_right = Rotation.from_rotvec(-half).as_matrix()
    baseline = R_mid_left @ rig.centre_right_in_left / rig.baseline_m
    R_rect_mid = _smallest_rotation(baseline, np.array([-1.0 if rig.is_right_first else 1.0, 0.0, 0.0]))
    return R_rect_mid @ R_mid_left, R_rect_mid @ R_mid_right


def _seam_rad(rig: Rig, rotations: tuple[FloatArray, FloatArray]) -> float:
    """Where a seam cuts the least, β in the frame of these rotations."""
    beta = math.pi + 2 * math.pi * np.arange(SEAM_STEPS) / SEAM_STEPS
    cut_px = _seen_pixels(rig, rotations, beta)
    if cut_px.all() or not cut_px.any():
        return float(beta[cut_px.argmin()])
    # From an angle that is seen on, so that no gap lies across the end.
    first = int(cut_px.argmax())
    is_gap = np.append(np.roll(cut_px, -first) == 0, False)
    starts = np.flatnonzero(is_gap[1:] & ~is_gap[:-1]) + 1
    lengths = np.array([is_gap[start:].argmin() for start in starts])
    longest = int(lengths.argmax())
    middle = first + starts[longest] + (lengths[longest] - 1) / 2
    return math.pi + 2 * math.pi * float(middle) / SEAM_STEPS


def _seen_pixels(rig: Rig, rotations: tuple[FloatArray, FloatArray], beta: FloatArray) -> FloatArray:
    """[K], how many source pixels of both images the epipolar lines of angles β [K] cross."""
    gamma = np.linspace(-math.pi / 2, math.pi / 2, SEAM_PLACES)
    x, across = np.broadcast_arrays(np.sin(gamma), beta[:, None])
    rays = np.stack([x, np.cos(gamma) * np.sin(across), np.cos(gamma) * np.cos(across)], axis=-1)
    crossed = np.zeros(len(beta))
    for camera, R_rect_cam in zip((rig.left, rig.right), rotations, strict=True):
        pixels, ok = camera.project(rays @ R_rect_cam)
        steps = np.linalg.norm(np.diff(pixels, axis=1), axis=-1)
        seen = ok & camera.contains(pixels)
        crossed += np.where(seen[:, 1:] & seen[:, :-1], steps, 0.0).sum(axis=1) + seen.any(axis=1)
    return crossed


def turned_about_x(angle_rad: float) -> FloatArray:
    """The rotation [3, 3] that adds an angle to β."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def signed_baseline_m(rig: Rig) -> float:
    """x of the right camera's centre in the left camera's rectified frame, metres."""
    R_rect_left, _ = rectifying_rotations(rig)
    return float((R_rect_left @ rig.centre_right_in_left)[0])


def _smallest_rotation(direction: FloatArray, target: FloatArray) -> FloatArray:
    """The rotation of least angle that takes one unit vector [3] to another."""
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
                    f"state its image circle ({argument('max_angle_deg')})"
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
        np.sqrt(abs(np.linalg.det(camera.whole.project_jacobian([0.0, 0.0, 1.0])[:, :2])))
        for camera in (rig.left, rig.right)
    ]
    return float(np.mean(rates))
