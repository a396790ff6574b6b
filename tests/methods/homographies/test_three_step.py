"""The turns of three steps are the least, and the focal length is found."""

from __future__ import annotations

import numpy as np
import pytest
from rectbench_methods.homographies.three_step import onto_rows, three_turns
from scipy.spatial.transform import Rotation

import rectbench as rb
from tests.methods.homographies.pinholes import pinholes, random_pinholes, rectified


@pytest.mark.parametrize("focal", [380.0, 520.0, 900.0])
def test_the_focal_length_is_found(focal: float) -> None:
    rect = rectified(pinholes((2.0, 8.0, 3.0), focal=focal), "three-step")
    assert rect.notes["focal_px"] == pytest.approx(focal, rel=1e-5)
    assert "warning" not in rect.notes


def test_matches_that_leave_the_focal_length_open_are_told() -> None:
    rect = rb.rectify(pinholes((2.0, 8.0, 3.0), focal=9000.0), method="three-step")
    assert "ended at a view of 10°" in str(rect.notes["warning"])


@pytest.mark.parametrize("epipole", [(3.0, 0.4, 0.2), (0.1, -2.0, 0.3), (-1.0, 0.2, 0.9)])
def test_no_smaller_turns_bring_an_epipole_onto_the_rows(epipole: tuple[float, float, float]) -> None:
    x, y, z = np.array(epipole) / np.linalg.norm(epipole)
    turn = onto_rows(np.array(epipole))
    brought = turn @ [x, y, z]
    np.testing.assert_allclose(brought, [np.sign(x), 0, 0], atol=1e-12)
    # The first turn by the angle to the plane z = 0, about an axis in it; the second by that to the x axis.
    to_infinity, to_row = np.arcsin(abs(z)), np.arctan2(abs(y), abs(x))
    first = Rotation.from_euler("z", np.arctan2(y * np.sign(x), x * np.sign(x))).as_matrix() @ turn
    assert Rotation.from_matrix(first).magnitude() == pytest.approx(to_infinity)
    assert Rotation.from_matrix(first @ turn.T).magnitude() == pytest.approx(to_row)


@pytest.mark.parametrize("seed", range(6))
def test_from_an_essential_matrix_the_two_cameras_become_parallel(seed: int) -> None:
    pair = random_pinholes(seed)
    R_left, R_right = three_turns(pair.essential_matrix)
    np.testing.assert_allclose(R_right @ pair.R_right_left @ R_left.T, np.eye(3), atol=1e-9)
    towards = R_left @ pair.centre_right_in_left / pair.baseline_m
    np.testing.assert_allclose(towards, [1, 0, 0], atol=1e-9)


def test_a_turn_about_the_baseline_is_shared() -> None:
    pair = pinholes((6.0, 0.0, 0.0), (0.2, 0.0, 0.0))
    R_left, R_right = three_turns(pair.essential_matrix)
    for turn in (R_left, R_right):
        assert np.degrees(Rotation.from_matrix(turn).magnitude()) == pytest.approx(3.0)
