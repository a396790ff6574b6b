"""Real pairs: what parts the calibrated pose from the images' own is explained by pose and lens together."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb

PAIRS = [("fs1.png", "fs2.png"), ("robot1.png", "robot2.png")]


@pytest.mark.parametrize("names", PAIRS)
def test_row_errors_of_a_calibration_are_explained_by_pose_and_lens_together(
    real_data: Path,
    names: tuple[str, str],
) -> None:
    calibrated = rb.load_rig("t265")
    images = [cv2.imread(str(real_data / "pairs/t265" / name), cv2.IMREAD_UNCHANGED) for name in names]
    estimate = rb.estimate_pose(images, calibrated)
    believed, of_pose = estimate.rig(calibrated), estimate.rig_covariance(calibrated)
    of_lenses = rb.RigCovariance.from_sigmas(calibrated, centre_px=0.15, focal_px=0.2)
    rect, pixels, depth_m = rb.rectify(believed), estimate.inliers.left, 1.6

    # Where the calibration says that the matched points are, in the rectification of the images' pose.
    rays, _ = calibrated.left.unproject(pixels)
    px_right, _ = calibrated.right.project(calibrated.right_from_left(rays * depth_m))
    apart = rb.metrics.row_error(rect, pixels, px_right).rectified_px

    def deviations(covariance: rb.RigCovariance) -> np.ndarray:
        found = rb.metrics.uncertainty(rect, believed, covariance, depth_m=depth_m, pixels=pixels)
        in_sigmas = apart / found.row_error_sigma_px[0]
        return in_sigmas[np.isfinite(in_sigmas)]

    # The pose's own covariance presumes the lenses exact, and is far too sure.
    assert np.sqrt(np.mean(deviations(of_pose) ** 2)) > 3
    assert 0.5 < np.sqrt(np.mean(deviations(of_pose + of_lenses) ** 2)) < 1.3
    assert np.mean(deviations(of_pose + of_lenses) < 2) > 0.9
