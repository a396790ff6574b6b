from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import InvalidInput, Rig


def test_essential_matrix_vanishes_on_corresponding_rays(rig: Rig) -> None:
    points = np.random.default_rng(0).uniform([-2, -2, 1], [2, 2, 9], (50, 3))
    residuals = np.einsum("ni,ij,nj->n", rig.right_from_left(points), rig.essential_matrix, points)
    np.testing.assert_allclose(residuals, 0, atol=1e-14)


def test_right_centre_is_the_origin_of_right_coordinates(rig: Rig) -> None:
    np.testing.assert_allclose(rig.right_from_left(rig.centre_right_in_left), 0, atol=1e-16)
    assert rig.baseline_m == pytest.approx(np.linalg.norm(rig.centre_right_in_left), rel=1e-15)


def test_rotation_rounded_to_six_decimals_becomes_exact(rig: Rig) -> None:
    rounded = dataclasses.replace(rig, R_right_left=np.round(rig.R_right_left, 6))
    R = rounded.R_right_left
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(R, rig.R_right_left, atol=2e-6)


def test_exact_rotation_is_kept_to_the_last_bit(rig: Rig) -> None:
    for seed in range(20):
        R = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
        once = dataclasses.replace(rig, R_right_left=R).R_right_left
        assert np.array_equal(once, dataclasses.replace(rig, R_right_left=once).R_right_left)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("R_right_left", 1.01 * np.eye(3), "no rotation"),
        ("R_right_left", np.diag([1, 1, -1.0]), "no rotation"),
        ("R_right_left", np.full((3, 3), np.nan), "not finite"),
        ("R_right_left", np.eye(4), "shape"),
        ("R_right_left", [[1, 0], [0]], "no numbers"),
        ("R_right_left", "identity", "no numbers"),
        ("t_right_left", [0, 0, 0], "baseline is zero"),
        ("t_right_left", [0.1, np.inf, 0], "not finite"),
        ("t_right_left", [0.1, 0], "shape"),
        ("left", "camera", "expected a Camera"),
        ("name", "two\nlines", "one printable line"),
    ],
)
def test_what_makes_no_rig_is_refused_in_one_line(rig: Rig, field: str, value: object, message: str) -> None:
    with pytest.raises(InvalidInput, match=message) as caught:
        dataclasses.replace(rig, **{field: value})
    assert "\n" not in str(caught.value)


def test_a_rig_cannot_be_changed_behind_its_back(rig: Rig) -> None:
    R = np.eye(3)
    kept = dataclasses.replace(rig, R_right_left=R)
    R[0, 0] = 5
    assert kept.R_right_left[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        kept.R_right_left[0, 0] = 5
