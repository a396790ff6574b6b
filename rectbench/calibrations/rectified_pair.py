"""Two cameras whose files each have the rectification R, P that the two share.

R turns the camera into the rectified frame, and P = [K' | K' o] has the place o of that frame in its last
column; of the right camera o = (-B, 0, 0), so that P[0, 3] = -f' B with the focal length f' that both
rectified images have. ROS' calibrator of fisheye pairs overwrites a part of P after
`cv2.fisheye.stereoRectify`: today P[:, :3] becomes K R of each camera, and for years P[0, 0] and P[1, 1]
became each camera's own fx (image_pipeline issue 626). P[0, 3] stays as it was, so that B follows from it by
the focal length that stereoRectify gives, which the lenses, R and `balance` determine. The balance follows
from P's principal point where that is stereoRectify's, and is else taken to be the calibrator's own, 0.
"""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from rectbench.calibrations.contract import PosedCamera
from rectbench.calibrations.documents import tell
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput
from rectbench.types import FloatArray

FISHEYE = "kannala-brandt"
FOCAL_AGREEMENT = 1e-3
"""By how much, relative, two statements of one focal length may differ."""

CENTRE_AGREEMENT_PX = 0.5
"""How near stereoRectify's principal point comes to P's, where its focal length was P's."""


def matrix_of(camera: Camera) -> FloatArray:
    """The camera matrix [3, 3], with the skew where the camera has one."""
    p = camera.params
    return np.array([[p["fx"], p.get("skew", 0.0), p["cx"]], [0.0, p["fy"], p["cy"]], [0.0, 0.0, 1.0]])


def is_turned(P: FloatArray, R: FloatArray, camera: Camera) -> bool:
    """Whether the left part of P is K R and not the matrix of a rectified camera."""
    K = matrix_of(camera)
    return bool(
        np.abs(R - np.eye(3)).max() > 1e-9 and np.abs(P[:, :3] - K @ R).max() < FOCAL_AGREEMENT * K[0, 0]
    )


def in_one_frame(left: PosedCamera, right: PosedCamera) -> tuple[PosedCamera, PosedCamera]:
    """The two cameras as they are, or in the frame that their projections together tell of."""
    T1, T2 = left.T_shared_camera, right.T_shared_camera
    if left.projection is None or right.projection is None or T1 is None or T2 is None:
        return left, right
    P1, P2 = left.projection, right.projection
    shift = P2[0, 3] - P1[0, 3]
    turned = is_turned(P1, T1[:3, :3], left.camera) or is_turned(P2, T2[:3, :3], right.camera)
    if shift == 0 or not (turned or (_has_own_focal(left, P1) and _has_own_focal(right, P2))):
        if abs(P1[0, 0] - P2[0, 0]) > FOCAL_AGREEMENT * P2[0, 0] and shift != 0:
            found = f"have the focal lengths {P1[0, 0]:.6g} and {P2[0, 0]:.6g}, not one"
            tell(f"{left.where} and {right.where}: the projection matrices {found}; each is taken by itself")
        return left, right
    balance, agrees = (0.0, True) if turned else _balance(left, right, shift, P2)
    if not turned and not agrees and abs(P1[0, 0] - P2[0, 0]) <= FOCAL_AGREEMENT * P2[0, 0]:
        return left, right  # two lenses of one focal length, which is P's as well
    focal = _stereo_rectify(left, right, shift, balance)[0]
    tell(
        f"{left.where} and {right.where}: the projection matrices have each camera's own "
        f"{'K R' if turned else 'focal length'} in them, as ROS' calibrator of fisheyes writes them; the "
        f"baseline follows from cv2.fisheye.stereoRectify's focal length {focal:.6g} (balance {balance:.2g})"
    )
    return _placed(left, T1, P1[0, 3] / focal), _placed(right, T2, P2[0, 3] / focal)


def _placed(posed: PosedCamera, T: FloatArray, place: float) -> PosedCamera:
    moved = T.copy()
    moved[:3, 3] = [-place, 0.0, 0.0]
    return replace(posed, T_shared_camera=moved)


def _has_own_focal(posed: PosedCamera, P: FloatArray) -> bool:
    """Whether a fisheye's P has the focal length of its K."""
    fx = posed.camera.params["fx"]
    return posed.camera.model == FISHEYE and bool(abs(P[0, 0] - fx) <= 1e-6 * fx)


def _balance(left: PosedCamera, right: PosedCamera, shift: float, P: FloatArray) -> tuple[float, bool]:
    """The balance by which stereoRectify gives P's principal point, and whether it does give it.

    The principal point moves along a line with the balance, the more in the row, cy.
    """
    ends = [_stereo_rectify(left, right, shift, balance)[2] for balance in (0.0, 1.0)]
    balance = (
        float(np.clip((P[1, 2] - ends[0]) / (ends[1] - ends[0]), 0.0, 1.0)) if ends[0] != ends[1] else 0.0
    )
    _, cx, cy = _stereo_rectify(left, right, shift, balance)
    agrees = max(abs(cx - P[0, 2]), abs(cy - P[1, 2])) < CENTRE_AGREEMENT_PX
    return (balance, True) if agrees else (0.0, False)


def _stereo_rectify(
    left: PosedCamera, right: PosedCamera, shift: float, balance: float
) -> tuple[float, float, float]:
    """Focal length and principal point of the rectified images that cv2.fisheye.stereoRectify gives."""
    if left.T_shared_camera is None or right.T_shared_camera is None:
        raise InvalidInput(f"{right.where}: does not say where its camera stands; expected R and P")
    R1, R2 = left.T_shared_camera[:3, :3], right.T_shared_camera[:3, :3]
    cameras = (left.camera, right.camera)
    (K1, D1), (K2, D2) = (
        (matrix_of(c), np.array([c.params[f"k{i}"] for i in (1, 2, 3, 4)])) for c in cameras
    )
    t = R2.T @ [np.sign(shift), 0.0, 0.0]
    try:
        _, _, P, *_ = cv2.fisheye.stereoRectify(
            *(K1, D1, K2, D2, left.camera.size, R2.T @ R1, t.reshape(3, 1)),
            flags=cv2.CALIB_ZERO_DISPARITY,
            newImageSize=left.camera.size,
            balance=balance,
        )
    except cv2.error:
        P = np.full((3, 4), np.nan)
    if not P[0, 0] > 0 or not np.isfinite(P).all():
        raise InvalidInput(
            f"{left.where} and {right.where}: cv2.fisheye.stereoRectify gives these lenses no focal length, "
            "by which P tells the baseline; expected a third file with the pose"
        )
    return float(P[0, 0]), float(P[0, 2]), float(P[1, 2])
