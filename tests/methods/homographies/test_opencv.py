"""OpenCV's two rectifications are delivered as OpenCV gives them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import rectbench as rb
from tests.methods.homographies.pinholes import CENTRE, SIZE, homographies, pinholes, rectified
from tests.rigs_for_tests import points_before, rig


def distorted_rig() -> rb.Rig:
    lens = {"fx": 300, "fy": 302, "cx": 321, "cy": 238, "k1": -0.12, "k2": 0.03, "p1": 2e-4, "p2": -1e-4}
    cameras = (rb.Camera("pinhole", SIZE, params) for params in (lens, lens | {"fx": 310, "k1": -0.1}))
    R = rig().R_right_left
    return rb.Rig(*cameras, R, -R @ [0.12, 0.006, -0.004])


def lens_of(camera: rb.Camera) -> tuple[np.ndarray, np.ndarray]:
    p = camera.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1]])
    return K, np.array([p[name] for name in ("k1", "k2", "p1", "p2")])


@pytest.mark.parametrize(("alpha", "flags"), [(-1.0, 1024), (0.0, 1024), (1.0, 1024), (0.5, 0)])
def test_tables_are_those_of_opencv(alpha: float, flags: int) -> None:
    assert cv2.CALIB_ZERO_DISPARITY == 1024
    pair = distorted_rig()
    points = "same" if flags else "free"
    rect = rb.rectify(pair, method="opencv-stereo-rectify", alpha=alpha, principal_points=points)
    (K_left, D_left), (K_right, D_right) = lens_of(pair.left), lens_of(pair.right)
    t = pair.t_right_left.reshape(3, 1)
    R1, R2, P1, P2, *_ = cv2.stereoRectify(
        K_left, D_left, K_right, D_right, SIZE, pair.R_right_left, t, flags=flags, alpha=alpha
    )
    for side, K, D, R, P in (("left", K_left, D_left, R1, P1), ("right", K_right, D_right, R2, P2)):
        theirs = cv2.initUndistortRectifyMap(K, D, R, P[:, :3], SIZE, cv2.CV_32FC1)
        valid = rect.valid(side)
        for a, b in zip(rect.maps(side), theirs, strict=True):
            np.testing.assert_allclose(a[valid], b[valid], atol=2e-3)


def test_alpha_goes_from_no_black_to_nothing_lost() -> None:
    pair = distorted_rig()
    tight = rb.rectify(pair, method="opencv-stereo-rectify", alpha=0.0)
    wide = rb.rectify(pair, method="opencv-stereo-rectify", alpha=1.0)
    for side in ("left", "right"):
        assert tight.valid(side).mean() > 0.995
        outline, _ = rb.outline_pixels(pair.left if side == "left" else pair.right)
        assert (np.abs(wide.warp(side).forward(outline) - CENTRE) <= np.array(SIZE) / 2 + 1).all()


def test_a_fisheye_rig_is_undistorted_first() -> None:
    pair = rig("kannala-brandt")
    rect = rb.rectify(pair, method="opencv-stereo-rectify")
    _, px_left, px_right = points_before(pair, 300)
    assert rb.metrics.row_error(rect, px_left, px_right).columns()["row_error_max_px"] < 1e-9


def test_uncalibrated_homographies_are_opencvs() -> None:
    pair = pinholes()
    _, left, right = points_before(pair, 200)
    rect = rb.rectify(pair, method="opencv-uncalibrated", matches=(left, right))
    found, *theirs = cv2.stereoRectifyUncalibrated(left, right, rb.fundamental_matrix(left, right), SIZE)
    assert found
    for warp, H, px in zip((rect.left, rect.right), theirs, (left, right), strict=True):
        np.testing.assert_allclose(warp.forward(px), cv2.perspectiveTransform(px[None], H)[0], atol=1e-6)


def test_the_uncalibrated_right_image_is_hartleys() -> None:
    ours, opencv = (rectified(pinholes(), method) for method in ("hartley", "opencv-uncalibrated"))
    (_, H_hartley), (_, H_opencv) = homographies(ours), homographies(opencv)
    # Both turn the epipole onto the x axis and then send it to infinity; where the image is put may differ.
    lines = H_hartley[2], H_opencv[2]
    np.testing.assert_allclose(*lines, rtol=2e-2, atol=1e-7)
    assert lines[1] @ [*CENTRE, 1] == pytest.approx(1)
