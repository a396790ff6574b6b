"""opencv-fisheye: OpenCV's own tables, to what its float32 and its iterations keep."""

import cv2
import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import rig


@pytest.mark.parametrize("name", ["t265", "mynteye", "fla"])
@pytest.mark.parametrize("balance", [0.0, 1.0])
def test_its_tables_are_those_of_opencv(name: str, balance: float) -> None:
    pair = rb.load_rig(name)
    rect = rb.rectify(pair, "opencv-fisheye", balance=balance)
    lenses = []
    for camera in (pair.left, pair.right):
        p = camera.params
        K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
        lenses.append((K, np.array([p["k1"], p["k2"], p["k3"], p["k4"]])))
    R1, R2, P1, P2, _ = cv2.fisheye.stereoRectify(
        *lenses[0],
        *lenses[1],
        pair.left.size,
        pair.R_right_left,
        pair.t_right_left[:, None],
        cv2.CALIB_ZERO_DISPARITY,
        balance=balance,
    )
    for side, lens, R, P in (("left", lenses[0], R1, P1), ("right", lenses[1], R2, P2)):
        theirs = cv2.fisheye.initUndistortRectifyMap(*lens, R, P, rect.size, cv2.CV_32FC1)
        ours = rect.maps(side)
        seen = rect.valid(side)
        assert seen.mean() > 0.05
        for our, their in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(our[seen], their[seen], atol=2e-3)


def test_lenses_that_are_too_wide_for_opencv_are_refused() -> None:
    with pytest.raises(rb.Unsupported, match=r"the lens is too wide"):
        rb.rectify(rb.load_rig("lens-220").scaled(0.25), "opencv-fisheye")


def test_lenses_and_sizes_that_opencv_does_not_take_are_refused() -> None:
    with pytest.raises(rb.Unsupported, match="this one is double-sphere"):
        rb.rectify(rig("double-sphere"), "opencv-fisheye")
    left, right = rig("kannala-brandt").left, rig("kannala-brandt", size=(400, 300)).right
    with pytest.raises(rb.Unsupported, match="images of one size"):
        rb.rectify(rb.Rig(left, right, np.eye(3), np.array([-0.1, 0, 0])), "opencv-fisheye")
