"""The rigs that ship with rectbench are sound, and stand the way their sources say."""

from __future__ import annotations

import re
from importlib import resources

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rectbench import Camera, load_rig, rectify
from rectbench.applications.listing import listed
from rectbench.calibrations import rig_names
from rectbench.rigs import MOTIONS

FISHEYES = {
    *("aria", "astrobee", "canon-8mm", "gopro", "hilti", "kitti-360", "lafida", "mynteye", "ocam", "quadcam"),
    *("sony-as200v", "t265", "tiscamera", "tumvi", "uzh-fpv"),
}
"""Each another lens; `tumvi-kb` is that of `tumvi` by another model."""
PERSPECTIVE = {"bumblebee2", "eth3d", "kaist-urban", "kitti", "middlebury", "vi-sensor", "zed"}
"""Calibrations of cameras that exist, whose lenses aim at straight lines."""


@pytest.fixture(scope="module")
def summaries() -> dict[str, str]:
    """What `rectbench list rigs` tells of each."""
    return {entry.name: entry.summary for entry in listed("rigs").entries}


def fields_of_view_deg(summary: str) -> tuple[int, int]:
    (view,) = re.findall(r"(\d+)° x (\d+)°", summary)
    return int(view[0]), int(view[1])


def test_the_rigs_hold_fifteen_fisheye_lenses_and_seven_perspective_pairs(summaries: dict[str, str]) -> None:
    across = {name: fields_of_view_deg(summary)[0] for name, summary in summaries.items()}
    assert all(across[name] > 110 for name in FISHEYES)
    assert all(across[name] < 95 for name in PERSPECTIVE)
    assert sum(across[name] < 140 for name in FISHEYES) >= 5
    assert sum(across[name] >= 150 for name in FISHEYES) >= 8


@pytest.mark.parametrize("name", rig_names())
def test_a_field_of_view_that_a_source_states_is_the_lens_s(name: str, summaries: dict[str, str]) -> None:
    stated = re.search(r"(\d+) by (\d+) degrees", load_rig(name).source)
    if stated:
        assert (int(stated[1]), int(stated[2])) == fields_of_view_deg(summaries[name])


@pytest.mark.parametrize("name", rig_names())
@pytest.mark.parametrize("method", ["abraham", "conventional"])
def test_a_method_serves_every_rig_as_calibrated_and_sideways(name: str, method: str) -> None:
    for motion in ("as-calibrated", "sideways"):
        rectify(MOTIONS[motion].apply(load_rig(name)), method=method)


@pytest.mark.parametrize("name", rig_names())
def test_name_source_and_place_are_right(name: str) -> None:
    rig = load_rig(name)
    assert rig.name == name
    assert len(rig.source) > 40
    assert rig.centre_right_in_left[0] > 0.95 * rig.baseline_m
    assert 0.05 < rig.baseline_m < 0.7
    assert (resources.files("rectbench_scenes") / "rigs" / f"{name}.yaml").is_file()


@pytest.mark.parametrize("name", rig_names())
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_lens_covers_the_middle_of_its_image(name: str, side: str) -> None:
    camera: Camera = getattr(load_rig(name), side)
    pixels = camera.pixel_grid()[::16, ::16]
    rays, ok = camera.unproject(pixels)
    assert ok.mean() > 0.54  # a full circle on an image of 4 by 3
    assert ok[ok.shape[0] // 2, ok.shape[1] // 2]
    back, _ = camera.project(rays)
    np.testing.assert_allclose(back[ok], pixels[ok], atol=1e-6)


def test_all_the_contract_s_lenses_are_there() -> None:
    sides = [camera for name in rig_names() for camera in (load_rig(name).left, load_rig(name).right)]
    distorted = [camera for camera in sides if camera.model == "pinhole" and camera.params["k1"] != 0]
    assert len(distorted) >= 4
    models = {camera.model for camera in sides}
    assert {"kannala-brandt", "double-sphere", "unified", "extended-unified", "ocam", "equisolid"} <= models
    assert {"fisheye624", "field-of-view", "thin-prism-fisheye"} <= models


def test_sony_sees_135_by_90_degrees() -> None:
    camera = load_rig("sony-as200v").left
    assert camera.size == (1920, 1080)
    edges, _ = camera.unproject([[-0.5, 539.5], [1919.5, 539.5], [959.5, -0.5], [959.5, 1079.5]])
    np.testing.assert_allclose(np.degrees(np.arccos(edges[:, 2])), [67.5, 67.5, 45, 45], atol=1e-9)


def test_canon_is_an_8_mm_lens_near_180_degrees() -> None:
    camera = load_rig("canon-8mm").left
    assert camera.size == (2736, 1842)
    assert camera.params["fx"] * 22.3 / 2736 == pytest.approx(8)
    assert camera.max_angle_deg == 90


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


def test_kitti_s_rectifying_rotations_tell_the_pose_of_its_cameras() -> None:
    """R_rect_00, R_rect_01 and P_rect_01 of the same file."""
    R_rect_left = np.array(
        [
            [9.999239e-01, 9.837760e-03, -7.445048e-03],
            [-9.869795e-03, 9.999421e-01, -4.278459e-03],
            [7.402527e-03, 4.351614e-03, 9.999631e-01],
        ]
    )
    R_rect_right = np.array(
        [
            [9.996878e-01, -8.976826e-03, 2.331651e-02],
            [8.876121e-03, 9.999508e-01, 4.418952e-03],
            [-2.335503e-02, -4.210612e-03, 9.997184e-01],
        ]
    )
    rig = load_rig("kitti")
    np.testing.assert_allclose(R_rect_right.T @ R_rect_left, rig.R_right_left, atol=2e-6)
    np.testing.assert_allclose(
        R_rect_left @ rig.centre_right_in_left, [3.875744e02 / 7.215377e02, 0, 0], atol=1e-4
    )


def test_lafida_s_lens_projects_as_its_own_program_does() -> None:
    """`WorldToImg` of MultiCol-SLAM, whose affine matrix scales columns and ours rows."""
    c, d, e, u0, v0 = (
        0.999626131079017,
        -0.0034775192597376,
        0.00385134991673147,
        392.219508388648,
        243.494438476351,
    )
    backward = [
        *(293.667187375663, 149.982043337335, -10.448650568161, 28.2295300683376, 7.13365723186292),
        *(0.056303218962532, 10.4144677485333, 0.166354960773665, -5.86858687381081, 1.18165998645705),
        *(3.1108311354746, 0.810799620714366),
    ]
    angle, turn = np.meshgrid(np.radians(np.linspace(1, 79, 40)), np.linspace(0, 2 * np.pi, 60))
    radius = np.polynomial.polynomial.polyval(angle - np.pi / 2, backward)
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    rays = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], axis=-1)
    pixels, ok = load_rig("lafida").left.project(rays)
    assert ok.all()
    np.testing.assert_allclose(pixels, np.stack([c * x + d * y + u0, e * x + y + v0], axis=-1), atol=5e-3)
