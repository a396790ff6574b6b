from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import InvalidInput, Rig
from rectbench.rigs import POSES, PoseNoise, perturb


def test_exact_is_the_rig_itself(rig: Rig) -> None:
    assert perturb(rig, POSES["exact"], 4) is rig


@pytest.mark.parametrize("noise", [POSES["perturbed"], PoseNoise(1, 0), PoseNoise(0, 2)])
def test_the_error_is_as_large_as_stated(rig: Rig, noise: PoseNoise) -> None:
    for seed in range(20):
        believed = perturb(rig, noise, seed)
        turn = Rotation.from_matrix(believed.R_right_left @ rig.R_right_left.T).magnitude()
        a, b = rig.centre_right_in_left, believed.centre_right_in_left
        direction = np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)
        np.testing.assert_allclose(
            np.degrees([turn, direction]), [noise.rotation_deg, noise.direction_deg], atol=1e-9
        )
        assert believed.baseline_m == pytest.approx(rig.baseline_m, rel=1e-12)
        assert (believed.left, believed.right) == (rig.left, rig.right)


def test_the_seed_decides_where_the_error_points(rig: Rig) -> None:
    noise = POSES["perturbed"]
    assert perturb(rig, noise, 1) == perturb(rig, noise, 1)
    assert perturb(rig, noise, 1) != perturb(rig, noise, 2)


@pytest.mark.parametrize("angles", [(-1, 0), (0, 180), (float("nan"), 0)])
def test_a_noise_out_of_range_is_refused(angles: tuple[float, float]) -> None:
    with pytest.raises(InvalidInput, match="expected degrees in"):
        PoseNoise(*angles)
