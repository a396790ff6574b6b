"""The rigs that ship with rectbench are sound, and stand the way their sources say."""

from __future__ import annotations

from importlib import resources

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import Camera, load_rig
from rectbench.calibrations import rig_names
from rectbench.rigs import MOTIONS


@pytest.mark.parametrize("name", rig_names())
def test_name_source_and_place_are_right(name: str) -> None:
    rig = load_rig(name)
    assert rig.name == name
    assert len(rig.source) > 40
    assert rig.centre_right_in_left[0] > 0.95 * rig.baseline_m
    assert 0.05 < rig.baseline_m < 0.5
    assert (resources.files("rectbench_scenes") / "rigs" / f"{name}.yaml").is_file()


@pytest.mark.parametrize("name", rig_names())
def test_both_epipoles_stay_out_of_the_view(name: str) -> None:
    for motion in ("as-calibrated", "sideways"):
        for seed in range(20):
            rig = MOTIONS[motion].apply(load_rig(name), seed)
            c, t = rig.centre_right_in_left, rig.t_right_left
            assert not rig.left.sees([c, -c]).any()
            assert not rig.right.sees([t, -t]).any()


@pytest.mark.parametrize("name", rig_names())
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_lens_covers_the_middle_of_its_image(name: str, side: str) -> None:
    camera: Camera = getattr(load_rig(name), side)
    pixels = camera.pixel_grid()[::16, ::16]
    rays, ok = camera.unproject(pixels)
    assert ok.mean() > 0.6
    assert ok[ok.shape[0] // 2, ok.shape[1] // 2]
    back, _ = camera.project(rays)
    np.testing.assert_allclose(back[ok], pixels[ok], atol=1e-6)


def test_all_the_contract_s_lenses_are_there() -> None:
    sides = [camera for name in rig_names() for camera in (load_rig(name).left, load_rig(name).right)]
    distorted = [camera for camera in sides if camera.model == "pinhole" and camera.params["k1"] != 0]
    assert len(distorted) >= 4
    assert {"kannala-brandt", "double-sphere", "unified", "extended-unified", "ocam", "equisolid"} <= {
        camera.model for camera in sides
    }


def test_sony_sees_135_by_90_degrees() -> None:
    camera = load_rig("sony-as200v").left
    assert camera.size == (1920, 1080)
    edges, _ = camera.unproject([[-0.5, 539.5], [1919.5, 539.5], [959.5, -0.5], [959.5, 1079.5]])
    np.testing.assert_allclose(np.degrees(np.arccos(edges[:, 2])), [67.5, 67.5, 45, 45], atol=1e-9)


def test_canon_is_an_8_mm_lens_near_180_degrees() -> None:
    camera = load_rig("canon-8mm").left
    assert camera.size == (2736, 1842)
    assert camera.params["fx"] * 22.3 / 2736 == pytest.approx(8)
    assert camera.max_angle_deg == 85


def test_two_calibrations_of_the_tum_vi_rig_agree() -> None:
    first, second = load_rig("tumvi"), load_rig("tumvi-kb")
    turn = Rotation.from_matrix(first.R_right_left @ second.R_right_left.T).magnitude()
    assert np.degrees(turn) < 0.1
    np.testing.assert_allclose(first.centre_right_in_left, second.centre_right_in_left, atol=1e-3)
    for side in ("left", "right"):
        pixels = first.left.pixel_grid()[::16, ::16]
        (a, a_ok), (b, b_ok) = (getattr(rig, side).unproject(pixels) for rig in (first, second))
        between = np.degrees(np.linalg.norm(a - b, axis=-1))[a_ok & b_ok]
        assert np.median(between) < 0.15
        assert between.max() < 0.4
