"""A perspective rectification in OpenCV's form does in OpenCV what it does here."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.warps import Framing, framed, opencv_form
from tests.rigs_for_tests import rig


def pinhole_rig(centre_m: tuple[float, float, float] = (0.12, 0.006, -0.004)) -> rb.Rig:
    lens = {"fx": 300, "fy": 302, "cx": 321, "cy": 238, "k1": -0.12, "k2": 0.03, "p1": 2e-4, "p2": -1e-4}
    other = lens | {"fx": 310, "cx": 315.5, "k1": -0.1}
    R = cv2.Rodrigues(np.radians([1.0, -2.0, 0.7]))[0]
    cameras = (rb.Camera("pinhole", (640, 480), params) for params in (lens, other))
    return rb.Rig(*cameras, R, -R @ np.array(centre_m))


def opencv_lens(camera: rb.Camera) -> tuple[np.ndarray, np.ndarray]:
    p = camera.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
    names = ("k1", "k2", "p1", "p2") if camera.model == "pinhole" else ("k1", "k2", "k3", "k4")
    return K, np.array([p[name] for name in names])


@pytest.mark.parametrize("centre_m", [(0.12, 0.006, -0.004), (-0.12, 0.003, 0.0), (0.002, 0.12, 0.001)])
@pytest.mark.parametrize("framing", [Framing(), Framing(coverage=0.7, pixels=1e5)], ids=["own", "framed"])
def test_opencv_makes_the_same_tables_of_it(centre_m: tuple[float, float, float], framing: Framing) -> None:
    rect = framed(rb.rectify(pinhole_rig(centre_m), "conventional"), framing)
    form = opencv_form(rect)
    sides = (("left", form.R1, form.P1), ("right", form.R2, form.P2))
    for side, R, P in sides:
        K, D = opencv_lens(rect.warp(side).source)
        theirs = cv2.initUndistortRectifyMap(K, D, R, P[:, :3], rect.size, cv2.CV_32FC1)
        ours, valid = rect.maps(side), rect.valid(side)
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(a[valid], b[valid], atol=2e-3)


def test_a_fisheye_rig_has_opencvs_form_too() -> None:
    rect = rb.rectify(rig("kannala-brandt"), "conventional", focal="fov", fov_deg=90.0)
    form = opencv_form(rect)
    K, D = opencv_lens(rect.rig.right)
    theirs = cv2.fisheye.initUndistortRectifyMap(K, D, form.R2, form.P2[:, :3], rect.size, cv2.CV_32FC1)
    valid = rect.valid("right")
    for a, b in zip(rect.maps("right"), theirs, strict=True):
        np.testing.assert_allclose(a[valid], b[valid], atol=2e-3)


@pytest.mark.parametrize("centre_m", [(0.12, 0.006, -0.004), (-0.12, 0.003, 0.0), (0.002, 0.12, 0.001)])
def test_q_gives_the_points_that_triangulation_gives(centre_m: tuple[float, float, float]) -> None:
    rect = rb.rectify(pinhole_rig(centre_m), "conventional")
    form = opencv_form(rect)
    sign = np.sign(-form.P2[0, 3])
    disparity = (sign * np.linspace(3, 40, 48 * 64).reshape(48, 64)).astype(np.float32)
    theirs = cv2.reprojectImageTo3D(disparity, form.Q)
    v, u = np.mgrid[:48, :64]
    ours = rect.triangulate(np.stack([u, v], axis=-1), disparity) @ form.R1.T
    np.testing.assert_allclose(ours, theirs, rtol=1e-4)


def test_p2_projects_points_of_the_left_rectified_frame_into_the_right_image() -> None:
    rect = rb.rectify(pinhole_rig(), "conventional")
    form, point_left = opencv_form(rect), np.array([0.3, -0.2, 2.5])
    u, v, w = form.P2 @ [*(form.R1 @ point_left), 1]
    px_right = rect.rig.right.project(rect.rig.right_from_left(point_left))[0]
    np.testing.assert_allclose([u / w, v / w], rect.right.forward(px_right), atol=1e-6)


def test_the_rotations_are_those_of_stereo_rectify() -> None:
    pair = pinhole_rig()
    K_left, D_left = opencv_lens(pair.left)
    K_right, D_right = opencv_lens(pair.right)
    R1, R2, *_ = cv2.stereoRectify(
        K_left, D_left, K_right, D_right, pair.left.size, pair.R_right_left, pair.t_right_left[:, None]
    )
    form = opencv_form(rb.rectify(pair, "conventional"))
    np.testing.assert_allclose(form.R1, R1, atol=1e-9)
    np.testing.assert_allclose(form.R2, R2, atol=1e-9)


@pytest.mark.parametrize(
    ("method", "reason"),
    [
        ("abraham", "no perspective one but Epipolar"),
        ("local-homography", "no perspective one but Epipolar"),
        ("hartley", "stretched or skewed"),
    ],
)
def test_what_has_no_such_form_says_why(method: str, reason: str) -> None:
    rect = rb.rectify(pinhole_rig(), method)
    with pytest.raises(rb.Unsupported, match=reason):
        opencv_form(rect)


def test_cameras_that_are_not_parallel_have_no_such_form() -> None:
    rect = rb.rectify(pinhole_rig(), "conventional")
    turned = cv2.Rodrigues(np.array([0.0, 0.001, 0.0]))[0] @ rect.R_rect_right
    off = replace(rect, right=replace(rect.right, R_rect_cam=turned))
    with pytest.raises(rb.Unsupported, match="not parallel"):
        opencv_form(off)
