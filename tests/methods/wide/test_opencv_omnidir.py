"""opencv-omnidir: OpenCV's own tables in all four modes, and which of them have epipolar rows."""

import cv2
import numpy as np
import pytest

import rectbench as rb
from tests.rigs_for_tests import points_before, rig

MODES = {
    "perspective": cv2.omnidir.RECTIFY_PERSPECTIVE,
    "cylindrical": cv2.omnidir.RECTIFY_CYLINDRICAL,
    "longlati": cv2.omnidir.RECTIFY_LONGLATI,
    "stereographic": cv2.omnidir.RECTIFY_STEREOGRAPHIC,
}


def recommended(mode: str, width: int, height: int) -> np.ndarray:
    """K_new as the module's tutorial writes it."""
    if mode == "perspective":
        return np.array([[width / 4, 0, width / 2], [0, height / 4, height / 2], [0, 0, 1]])
    return np.array([[width / 3.1415, 0, 0], [0, height / 3.1415, 0], [0, 0, 1]])


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", ["kitti-360", "quadcam"])
def test_its_tables_are_those_of_opencv(name: str, mode: str) -> None:
    pair = rb.load_rig(name).scaled(0.25)
    rect = rb.rectify(pair, "opencv-omnidir", mode=mode)
    R1, R2 = cv2.omnidir.stereoRectify(pair.R_right_left, pair.t_right_left)
    K_new = recommended(mode, *pair.left.size)
    for side, camera, R in (("left", pair.left, R1), ("right", pair.right, R2)):
        p = camera.params
        K = np.array([[p["fx"], p["skew"], p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
        D, xi = np.array([[p["k1"], p["k2"], p["p1"], p["p2"]]]), np.array([p["xi"]])
        theirs = cv2.omnidir.initUndistortRectifyMap(
            K, D, xi, R, K_new, pair.left.size, cv2.CV_32FC1, MODES[mode]
        )
        seen = rect.valid(side)
        assert seen.mean() > 0.1
        for our, their in zip(rect.maps(side), theirs[:2], strict=True):
            np.testing.assert_allclose(our[seen], their[seen], atol=2e-3)


@pytest.mark.parametrize("mode", MODES)
def test_two_of_its_modes_have_epipolar_rows(mode: str) -> None:
    pair = rig("unified", centre_m=(0.1, 0.01, -0.02))
    _, px_left, px_right = points_before(pair, 400)
    rect = rb.rectify(pair, "opencv-omnidir", mode=mode)
    errors = rb.metrics.row_error(rect, px_left, px_right).columns()
    assert errors["row_error_matches"] > 50
    if mode in ("perspective", "longlati"):
        assert errors["row_error_max_px"] < 1e-6
    else:
        assert errors["row_error_median_px"] > 0.5
        found = rb.metrics.row_misfit(rect, rb.Delivered.of(rect, rb.ScoredView.of(pair)), pair)
        assert "rows are bent by" in found.reason


def test_other_lenses_and_a_baseline_along_the_axis_are_refused() -> None:
    with pytest.raises(rb.Unsupported, match="this one is equidistant"):
        rb.rectify(rig(), "opencv-omnidir")
    lens = rig("unified").left
    ahead = rb.Rig(lens, lens, np.eye(3), np.array([0, 0, -0.2]))
    with pytest.raises(rb.Unsupported, match="along the optical axis"):
        rb.rectify(ahead, "opencv-omnidir")
