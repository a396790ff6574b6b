"""Matches that agree with one another tell what is wrong with a calibration, which filters none away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import rectbench as rb
from rectbench import consistent_matches
from rectbench.metrics import row_error
from tests.matching.sphere_room import sphere_pair, sphere_truth
from tests.rigs_for_tests import rig

TRUE = rig("kannala-brandt", size=(480, 320), fov_deg=130)


@pytest.fixture(scope="module")
def images() -> rb.StereoPair:
    return sphere_pair(TRUE)


@pytest.fixture(scope="module")
def matches(images: rb.StereoPair) -> rb.Matches:
    return consistent_matches(TRUE.left, TRUE.right, rb.Images(images.left, images.right))


def test_they_are_many_spread_and_true(matches: rb.Matches) -> None:
    truth = sphere_truth(TRUE)
    u, v = np.rint(matches.left).astype(int).T
    near = truth.px_right_of_left[v, u]
    # Half a pixel of rounding, and what a pixel moves by.
    assert np.nanquantile(np.linalg.norm(matches.right - near, axis=1), 0.98) < 1.5
    assert len(matches.left) > 300
    cells = np.unique(np.floor(matches.left / 80), axis=0)
    assert len(cells) > 0.8 * 24


@pytest.mark.parametrize("tilt_deg", [0.5, 3.0])
def test_they_measure_a_wrong_calibration_in_full(matches: rb.Matches, tilt_deg: float) -> None:
    """A tilt of 3° moves rows by 11 px; what is 3 px off a calibration is no wrong match for that."""
    tilt = Rotation.from_euler("x", tilt_deg, degrees=True).as_matrix()
    wrong = replace(TRUE, R_right_left=tilt @ TRUE.R_right_left, t_right_left=tilt @ TRUE.t_right_left)
    error = row_error(rb.rectify(wrong), *matches).source_px
    expected = np.radians(tilt_deg) * float(rb.centre_resolution_px(TRUE))
    assert np.nanmedian(error) == pytest.approx(expected, rel=0.15)


def test_images_that_tell_no_pose_have_none(images: rb.StereoPair) -> None:
    with pytest.raises(rb.PoseNotFound):
        consistent_matches(TRUE.left, TRUE.right, rb.Images(images.left, images.left))
