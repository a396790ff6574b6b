"""The chosen method serves a rig better than OpenCV's own rectification; `pytest -s` prints both."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import rectbench as rb

METHODS = ("abraham", "local-homography", "polar-optimal")
LENS = {"kannala-brandt": ("k1", "k2", "k3", "k4"), "pinhole": ("k1", "k2", "p1", "p2")}


def opencvs_own(rig: rb.Rig, balance: float) -> rb.Rectification:
    """`cv2.fisheye.stereoRectify` or `cv2.stereoRectify` with balance, or alpha: 0 crops, 1 keeps."""
    intrinsics = []
    for camera in (rig.left, rig.right):
        p = camera.params
        K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
        intrinsics += [K, np.array([p[name] for name in LENS[camera.model]])]
    pose = rig.left.size, rig.R_right_left, rig.t_right_left[:, None]
    if rig.left.model == "pinhole":
        R1, R2, P1, P2, *_ = cv2.stereoRectify(*intrinsics, *pose, alpha=balance)
    else:
        R1, R2, P1, P2, _ = cv2.fisheye.stereoRectify(
            *intrinsics, *pose, cv2.CALIB_ZERO_DISPARITY, balance=balance
        )
    warps = (
        rb.Warp(camera, R, rb.Perspective(P[:, :3]))
        for camera, R, P in ((rig.left, R1, P1), (rig.right, R2, P2))
    )
    return rb.Rectification(rig, *warps, rig.left.size)


@pytest.mark.parametrize("name", ["t265", "mynteye", "tumvi-kb", "sony-as200v", "bumblebee2"])
@pytest.mark.parametrize("balance", [0.0, 1.0])
def test_the_best_method_distorts_less_where_it_shows_as_much(name: str, balance: float) -> None:
    rig = rb.load_rig(name)
    theirs = rb.metrics.frame_costs(opencvs_own(rig, balance), rig)
    shown = min(theirs["coverage_pixels"], 0.999)
    choice = rb.best_method(rig, framing=rb.Framing(coverage=shown), methods=METHODS)
    ours = choice.best.measured
    for who, costs in (("OpenCV", theirs), (choice.best.method, ours)):
        print(
            f"\n{name}, balance {balance:g}, {who}: keeps {costs['coverage_pixels']:.1%}, log distortion "
            f"{costs['log_distortion_kept']:.3f}, {costs['magnification']:.0%} of the source's resolution",
            end="",
        )
    assert ours["coverage_pixels"] > shown - 0.01
    assert ours["log_distortion_kept"] < 0.6 * theirs["log_distortion_kept"]
    assert ours["magnification"] > 0.85
