"""Poses and pixels of the formats against numbers that other people's tools have printed or compute."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from rectbench import Camera, InvalidInput, Rig, load_rig
from tests.calibrations.calibration_files import D1, D2, K1, K2, POSE, R_RIGHT_LEFT, T_RIGHT_LEFT, opencv_file
from tests.calibrations.examples import (
    EXAMPLES,
    PINHOLES,
    SIZE,
    matrix_block,
    ros_text,
)
from tests.calibrations.test_every_format import assert_same_camera, assert_same_rig

# EuRoC MAV's Vicon room sequences: cam0/sensor.yaml and cam1/sensor.yaml of the dataset.
EUROC_T_BS = (
    [
        *(0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975),
        *(0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768),
        *(-0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949, 0, 0, 0, 1),
    ],
    [
        *(0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556),
        *(0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024),
        *(-0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038, 0, 0, 0, 1),
    ],
)
EUROC_FOCAL = ([458.654, 457.296, 367.215, 248.375], [457.587, 456.134, 379.999, 255.238])
EUROC_RADTAN = (
    [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05],
    [-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05],
)
# The same rig as ORB-SLAM2 ships it (Examples/Stereo/EuRoC.yaml): the rectification by cv2.stereoRectify.
ORBSLAM2 = {
    "LEFT.R": [
        *(0.999966347530033, -0.001422739138722922, 0.008079580483432283),
        *(0.001365741834644127, 0.9999741760894847, 0.007055629199258132),
        *(-0.008089410156878961, -0.007044357138835809, 0.9999424675829176),
    ],
    "RIGHT.R": [
        *(0.9999633526194376, -0.003625811871560086, 0.007755443660172947),
        *(0.003680398547259526, 0.9999684752771629, -0.007035845251224894),
        *(-0.007729688520722713, 0.007064130529506649, 0.999945173484644),
    ],
    "LEFT.P": [
        435.2046959714599,
        0,
        367.4517211914062,
        0,
        0,
        435.2046959714599,
        252.2008514404297,
        0,
        0,
        0,
        1,
        0,
    ],
    "RIGHT.P": [
        *(435.2046959714599, 0, 367.4517211914062, -47.90639384423901),
        *(0, 435.2046959714599, 252.2008514404297, 0, 0, 0, 1, 0),
    ],
}
# And as ORB-SLAM3 ships it (Examples/Stereo/EuRoC.yaml): Stereo.T_c1_c2.
ORBSLAM3_T_C1_C2 = [
    *(0.999997256477797, -0.002317135723275, -0.000343393120620, 0.110074137800478),
    *(0.002312067192432, 0.999898048507103, -0.014090668452683, -0.000156612054392),
    *(0.000376008102320, 0.014089835846691, 0.999900662638081, 0.000889382785432, 0, 0, 0, 1),
]


def matrix(key: str, numbers: list[float], columns: int) -> str:
    return matrix_block(key, np.reshape(np.array(numbers, dtype=float), (-1, columns)))


def euroc(folder: Path) -> Rig:
    paths = []
    for number in (0, 1):
        paths.append(folder / f"cam{number}.yaml")
        content = {
            "T_BS": {"cols": 4, "rows": 4, "data": EUROC_T_BS[number]},
            "resolution": [752, 480],
            "camera_model": "pinhole",
            "intrinsics": EUROC_FOCAL[number],
            "distortion_model": "radial-tangential",
            "distortion_coefficients": EUROC_RADTAN[number],
        }
        paths[-1].write_text(yaml.safe_dump(content))
    return load_rig(paths)


def orbslam2(folder: Path) -> Rig:
    text = "%YAML:1.0\n"
    for number, side in enumerate(("LEFT", "RIGHT")):
        fx, fy, cx, cy = EUROC_FOCAL[number]
        text += f"{side}.height: 480\n{side}.width: 752\n"
        text += matrix(f"{side}.D", [*EUROC_RADTAN[number], 0.0], 5)
        text += matrix(f"{side}.K", [fx, 0, cx, 0, fy, cy, 0, 0, 1], 3)
        text += matrix(f"{side}.R", ORBSLAM2[f"{side}.R"], 3) + matrix(f"{side}.P", ORBSLAM2[f"{side}.P"], 4)
    (folder / "orbslam2.yaml").write_text(text)
    return load_rig(folder / "orbslam2.yaml")


def orbslam3(folder: Path) -> Rig:
    text = '%YAML:1.0\nFile.version: "1.0"\nCamera.type: "PinHole"\nCamera.width: 752\nCamera.height: 480\n'
    for number in (0, 1):
        names = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")
        values = (*EUROC_FOCAL[number], *EUROC_RADTAN[number])
        text += "".join(f"Camera{number + 1}.{name}: {v}\n" for name, v in zip(names, values, strict=True))
    (folder / "orbslam3.yaml").write_text(text + matrix("Stereo.T_c1_c2", ORBSLAM3_T_C1_C2, 4))
    return load_rig(folder / "orbslam3.yaml")


@pytest.mark.parametrize("read", [orbslam2, orbslam3])
def test_three_published_files_of_euroc_s_rig_agree(tmp_path: Path, read) -> None:
    reference, rig = euroc(tmp_path), read(tmp_path)
    assert (rig.left, rig.right) == (reference.left, reference.right)
    np.testing.assert_allclose(rig.R_right_left, reference.R_right_left, atol=2e-5)
    np.testing.assert_allclose(rig.t_right_left, reference.t_right_left, atol=2e-5)
    assert rig.t_right_left[0] == pytest.approx(-0.110074, abs=2e-5)


@pytest.mark.parametrize("turn_deg", [0, 90, -90, 180], ids="{} degrees".format)
def test_the_pose_behind_opencv_s_rectification_is_recovered(tmp_path: Path, turn_deg: float) -> None:
    """Horizontal and vertical rigs, and one whose cameras come in the other order."""
    turn = cv2.Rodrigues(np.array([0, 0, np.radians(turn_deg)]))[0]
    R, t = turn @ R_RIGHT_LEFT @ turn.T, turn @ T_RIGHT_LEFT
    D = np.zeros(5)
    R1, R2, P1, P2 = cv2.stereoRectify(K1, D, K2, D, SIZE, R, t.reshape(3, 1), flags=0)[:4]
    for name, K, R_rect, P in (("left", K1, R1, P1), ("right", K2, R2, P2)):
        (tmp_path / f"{name}.yaml").write_text(ros_text(K, [0.0] * 5, "plumb_bob", R_rect, P))
    rig = load_rig([tmp_path / "left.yaml", tmp_path / "right.yaml"])
    np.testing.assert_allclose(rig.R_right_left, R, atol=1e-9)
    np.testing.assert_allclose(rig.t_right_left, t, atol=1e-9)


def test_two_calibrations_of_tum_vi_s_rig_agree(real_data: Path) -> None:
    """Basalt's double spheres against the Kannala-Brandt lenses that the dataset's authors give."""
    basalt = load_rig(real_data / "calib/basalt")
    stella = load_rig(real_data / "calib/stella")
    turn = cv2.Rodrigues(basalt.R_right_left @ stella.R_right_left.T)[0]
    assert np.degrees(np.linalg.norm(turn)) < 0.1
    np.testing.assert_allclose(basalt.t_right_left, stella.t_right_left, atol=5e-4)
    pixels = basalt.left.pixel_grid()[::16, ::16].reshape(-1, 2)
    for one, other in ((basalt.left, stella.left), (basalt.right, stella.right)):
        (a, known), (b, also) = one.unproject(pixels), other.unproject(pixels)
        angle = np.degrees(np.arccos(np.clip(np.sum(a * b, axis=-1), -1, 1)))
        near = known & also & (np.linalg.norm(pixels - 256, axis=-1) < 200)
        assert np.median(angle[near]) < 0.15


@pytest.mark.parametrize(
    ("source", "name", "unit"), [("pairs/mynteye", "mynteye", None), ("pairs/bumblebee2", "bumblebee2", "mm")]
)
def test_real_files_are_the_built_in_rigs(real_data: Path, source: str, name: str, unit: str | None) -> None:
    read, shipped = load_rig(real_data / source, unit=unit), load_rig(name)
    for side in ("left", "right"):
        camera, expected = getattr(read, side), getattr(shipped, side)
        assert camera.params == pytest.approx(expected.params)
    np.testing.assert_allclose(read.R_right_left, shipped.R_right_left, atol=1e-6)
    np.testing.assert_allclose(read.t_right_left, shipped.t_right_left, atol=1e-6)


def fisheye_json(stretch: list[list[float]]) -> str:
    intrinsics = {
        "MappingCoefficients": [348.35, -6.98e-4, 5.0e-8, 1.1e-10],
        "ImageSize": [800, 848],
        "DistortionCenter": [420.5, 391.25],
        "StretchMatrix": stretch,
    }
    return json.dumps({"Intrinsics": intrinsics})


@pytest.mark.parametrize("stretch", [[[1.0, 0.0], [0.0, 1.0]], [[1.002, 0.003], [-0.004, 1.0]]], ids=str)
def test_matlab_s_fisheye_by_its_documented_formula(tmp_path: Path, stretch: list[list[float]]) -> None:
    """fisheyeIntrinsics: [u; v] = S [u'; v'] + centre, ray (u', v', a0 + a2 r^2 + ...), 1-based."""
    for name in ("a.json", "b.json"):
        (tmp_path / name).write_text(fisheye_json(stretch))
    (tmp_path / "pose.yml").write_text(opencv_file(**POSE))
    camera = load_rig([tmp_path / name for name in ("a.json", "b.json", "pose.yml")]).left
    pixels = np.random.default_rng(0).uniform([60, 60], [780, 740], (50, 2))
    a, b = np.linalg.solve(stretch, (pixels + 1 - [420.5, 391.25]).T)
    r = np.hypot(a, b)
    rays = np.stack([a, b, 348.35 - 6.98e-4 * r**2 + 5.0e-8 * r**3 + 1.1e-10 * r**4], axis=-1)
    read, ok = camera.unproject(pixels)
    assert ok.all()
    np.testing.assert_allclose(read, rays / np.linalg.norm(rays, axis=-1, keepdims=True), atol=1e-12)


def test_camodocal_s_scaramuzza_by_its_formula(tmp_path: Path) -> None:
    """lift: p = [C D; E 1]^-1 (u - c), the ray is (p, -poly(|p|)); LF-VIO publishes such a camera."""
    poly = [-2.445239e02, 0.0, 1.748610e-03, -1.757770e-06, 4.475965e-09]
    text = "%YAML:1.0\n---\nmodel_type: scaramuzza\nimage_width: 1280\nimage_height: 960\npoly_parameters:\n"
    text += "".join(f"   p{place}: {value}\n" for place, value in enumerate(poly))
    text += "affine_parameters:\n   ac: 1.001\n   ad: 0.002\n   ae: -0.003\n   cx: 645.1\n   cy: 486.0\n"
    for name in ("a.yaml", "b.yaml"):
        (tmp_path / name).write_text(text)
    (tmp_path / "pose.yml").write_text(opencv_file(**POSE))
    camera = load_rig([tmp_path / name for name in ("a.yaml", "b.yaml", "pose.yml")]).right
    pixels = np.random.default_rng(0).uniform([300, 200], [980, 760], (50, 2))
    point = np.linalg.solve([[1.001, 0.002], [-0.003, 1.0]], (pixels - [645.1, 486.0]).T)
    depth = -np.polynomial.polynomial.polyval(np.linalg.norm(point, axis=0), poly)
    rays = np.stack([*point, depth], axis=-1)
    read, ok = camera.unproject(pixels)
    assert ok.all()
    np.testing.assert_allclose(read, rays / np.linalg.norm(rays, axis=-1, keepdims=True), atol=1e-12)


RAYS = np.random.default_rng(5).normal(size=(200, 3)) * [0.5, 0.5, 0] + [0, 0, 1]


def test_a_skewed_omnidirectional_camera_projects_as_opencv_does(tmp_path: Path) -> None:
    """omnidir::calibrate estimates the skew unless told not to."""
    K, D = K1 + np.array([[0, -1.7, 0], [0, 0, 0], [0, 0, 0]]), np.array([[-0.1, 0.02, 1e-4, -2e-4]])
    one = {"camera_matrix_1": K, "distortion_coefficients_1": D, "xi_1": 1.3}
    two = {"camera_matrix_2": K, "distortion_coefficients_2": D, "xi_2": 1.3}
    (tmp_path / "rig.xml").write_text(opencv_file(".xml", **one, **two, **POSE))
    camera = load_rig(tmp_path / "rig.xml", size=SIZE).left
    expected = cv2.omnidir.projectPoints(RAYS[:, None], np.zeros(3), np.zeros(3), K, 1.3, D)[0]
    np.testing.assert_allclose(camera.project(RAYS)[0], expected[:, 0], atol=1e-9)


def test_a_skewed_fisheye_projects_as_opencv_does(tmp_path: Path) -> None:
    """fisheye::calibrate writes K[0, 1] = alpha fx."""
    alpha = 0.004
    K = K1 + np.array([[0, alpha * K1[0, 0], 0], [0, 0, 0], [0, 0, 0]])
    (tmp_path / "rig.yml").write_text(opencv_file(model="fisheye", K1=K, K2=K, D1=D1, D2=D2, **POSE))
    camera = load_rig(tmp_path / "rig.yml", size=SIZE).left
    expected = cv2.fisheye.projectPoints(RAYS[:, None], np.zeros(3), np.zeros(3), K1, D1, alpha=alpha)[0]
    np.testing.assert_allclose(camera.project(RAYS)[0], expected[:, 0], atol=1e-9)


def test_matlab_s_two_ways_to_write_a_pose_agree(tmp_path: Path) -> None:
    content = json.loads(EXAMPLES["matlab"].files["stereoParams.json"])
    old = dict(content)
    content["PoseCamera2"] = {
        "Dimensionality": 3,
        "R": R_RIGHT_LEFT.tolist(),
        "Translation": old["TranslationOfCamera2"],
    }
    for key in ("RotationOfCamera2", "TranslationOfCamera2"):
        del content[key]
    (tmp_path / "new.json").write_text(json.dumps(content))
    assert_same_rig(load_rig(tmp_path / "new.json"), PINHOLES)
    content["RotationOfCamera2"] = R_RIGHT_LEFT.tolist()
    (tmp_path / "both.json").write_text(json.dumps(content))
    with pytest.raises(InvalidInput, match="RotationOfCamera2 is not the transpose of PoseCamera2"):
        load_rig(tmp_path / "both.json")


def test_any_two_cameras_of_a_chain_make_a_rig(tmp_path: Path) -> None:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    step = np.array(chain["cam1"]["T_cn_cnm1"])
    chain["cam2"] = chain["cam1"]
    (tmp_path / "chain.yaml").write_text(json.dumps(chain))
    forward = load_rig(tmp_path / "chain.yaml", cameras=["cam0", "cam2"])
    np.testing.assert_allclose(forward.R_right_left, (step @ step)[:3, :3], atol=1e-12)
    np.testing.assert_allclose(forward.t_right_left, (step @ step)[:3, 3], atol=1e-12)
    backward = load_rig(tmp_path / "chain.yaml", cameras=["cam2", "cam0"])
    np.testing.assert_allclose(backward.t_right_left, forward.centre_right_in_left, atol=1e-12)
    with pytest.raises(InvalidInput, match="has no camera 'cam7'; expected two of 'cam0', 'cam1', 'cam2'"):
        load_rig(tmp_path / "chain.yaml", cameras=["cam0", "cam7"])


@pytest.mark.parametrize("cameras", ["cam0", ["cam0"], [0, 1]])
def test_a_choice_of_cameras_is_two_names(cameras: object) -> None:
    with pytest.raises(InvalidInput, match="expected two names"):
        load_rig("t265", cameras=cameras)


def test_basalt_s_radtan8_projects_as_opencv_does(tmp_path: Path) -> None:
    names = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
    content = json.loads(EXAMPLES["basalt"].files["calibration.json"])
    numbers = dict(zip(names, [-0.1, 0.05, 1e-3, -2e-3, 0.01, 0.02, 0.01, 0.005], strict=True))
    focal = {"fx": 400.0, "fy": 401.0, "cx": 420.0, "cy": 400.0}
    camera = {"camera_type": "pinhole-radtan8", "intrinsics": {**focal, **numbers, "rpmax": 1.2}}
    content["value0"]["intrinsics"] = [camera, camera]
    (tmp_path / "calibration.json").write_text(json.dumps(content))
    left = load_rig(tmp_path / "calibration.json").left
    rays = RAYS[np.linalg.norm(RAYS[:, :2], axis=-1) < 1.0]
    K = np.array([[400.0, 0, 420], [0, 401, 400], [0, 0, 1]])
    expected = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), K, np.array(list(numbers.values())))[0]
    np.testing.assert_allclose(left.project(rays)[0], expected[:, 0], atol=1e-9)
    assert left.max_angle_deg == pytest.approx(np.degrees(np.arctan(1.2)))


def test_basalt_s_ucm_is_the_extended_one_with_beta_1(tmp_path: Path) -> None:
    content = json.loads(EXAMPLES["basalt"].files["calibration.json"])
    camera = {
        "camera_type": "ucm",
        "intrinsics": {"fx": 300.0, "fy": 301.0, "cx": 420.0, "cy": 400.0, "alpha": 0.6},
    }
    content["value0"]["intrinsics"] = [camera, camera]
    (tmp_path / "calibration.json").write_text(json.dumps(content))
    params = {"fx": 300.0, "fy": 301.0, "cx": 420.0, "cy": 400.0, "alpha": 0.6, "beta": 1.0}
    assert_same_camera(load_rig(tmp_path / "calibration.json").left, Camera("extended-unified", SIZE, params))
