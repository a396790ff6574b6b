"""Without a calibration, the matches alone make rows correspond."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.matching.pose.uncalibrated import uncalibrated
from rectbench.metrics import row_error
from rectbench.types import Images
from tests.matching.box_room import photograph


def pinhole_rig(focal: float) -> rb.Rig:
    lens = rb.Camera("pinhole", (480, 360), {"fx": focal, "fy": focal, "cx": 236, "cy": 183})
    R = cv2.Rodrigues(np.radians([1.0, -2.0, 1.5]))[0]
    return rb.Rig(lens, lens, R, -R @ np.array([0.4, 0.03, -0.03]))


def corner_pair(rig: rb.Rig) -> Images:
    """Photographs into a corner of the room: of a single wall, matches would leave the geometry open."""
    aside = cv2.Rodrigues(np.radians([12.0, 25.0, 0.0]))[0]
    left = photograph(rig.left, aside, np.zeros(3))
    return Images(
        left, photograph(rig.right, rig.R_right_left @ aside, aside.T @ rig.centre_right_in_left, noise=2)
    )


@pytest.mark.parametrize("focal", [280.0, 415.0, 700.0])
@pytest.mark.parametrize("method", ["hartley", "fusiello"])
def test_rows_correspond_whatever_the_true_focal_length_is(focal: float, method: str) -> None:
    true_rig = pinhole_rig(focal)
    found = uncalibrated(corner_pair(true_rig))
    rect = rb.rectify(found.rig, method, matches=found.matches)
    # True correspondences at other depths than the walls', which the method has not seen.
    rays, _ = true_rig.left.unproject(found.matches.left)
    points = rays * np.random.default_rng(1).uniform(2.5, 6, (len(rays), 1))
    px_right, _ = true_rig.right.project(true_rig.right_from_left(points))
    assert row_error(rect, found.matches.left, px_right).columns()["row_error_source_median_px"] < 0.6


def test_matches_are_of_one_geometry() -> None:
    true_rig = pinhole_rig(415.0)
    found = uncalibrated(corner_pair(true_rig))
    K = np.array([[415.0, 0, 236], [0, 415, 183], [0, 0, 1]])
    F = np.linalg.inv(K).T @ true_rig.essential_matrix @ np.linalg.inv(K)
    left, right = (np.column_stack([px, np.ones(len(px))]) for px in found.matches)
    assert len(left) > 100
    assert np.quantile(np.abs(rb.sampson_residuals(F, left, right)), 0.99) < 1.5


def test_the_rig_says_what_it_is() -> None:
    found = uncalibrated(corner_pair(pinhole_rig(415.0)))
    assert found.rig.name == "uncalibrated"
    assert found.rig.baseline_m == pytest.approx(1)
    assert found.rig.left.params["fx"] == pytest.approx(240 / np.tan(np.radians(30)))


def test_images_without_texture_tell_nothing() -> None:
    blank = np.full((100, 120), 90, np.uint8)
    with pytest.raises(rb.PoseNotFound, match="0 matches"):
        uncalibrated(Images(blank, blank))
