from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from rectbench import InvalidInput, Rig, load_rig
from tests.calibrations.calibration_files import (
    D1,
    D2,
    IMAGE,
    INTRINSICS,
    K1,
    K2,
    POSE,
    R_RIGHT_LEFT,
    T_RIGHT_LEFT,
    WHOLE_RIG,
    opencv_file,
)


def load(tmp_path: Path, *contents: str, suffix: str = ".yml", size: tuple[int, int] | None = None) -> Rig:
    paths = [tmp_path / f"{number}{suffix}" for number in range(len(contents))]
    for path, content in zip(paths, contents, strict=True):
        path.write_text(content)
    return load_rig(paths if len(paths) > 1 else paths[0], size=size)


SKEWED = np.array([[285.722, 1, 420.135], [0, 286.759, 403.394], [0, 0, 1]])
POINTS = np.random.default_rng(3).uniform([-1, -1, 1], [1, 1, 4], (40, 3))


@pytest.mark.parametrize("suffix", [".yml", ".xml", ".json"])
def test_fisheye_rig_projects_as_opencv_does(tmp_path: Path, suffix: str) -> None:
    rig = load(tmp_path, opencv_file(suffix, **WHOLE_RIG), suffix=suffix)
    expected, _ = cv2.fisheye.projectPoints(
        POINTS[:, None], cv2.Rodrigues(R_RIGHT_LEFT)[0], T_RIGHT_LEFT, K2, D2.ravel()
    )
    pixels, ok = rig.right.project(rig.right_from_left(POINTS))
    assert ok.all()
    np.testing.assert_allclose(pixels, expected[:, 0], atol=1e-9)
    assert rig.left.size == (848, 800)


@pytest.mark.parametrize("count", [4, 5, 8, 12, 14])
def test_pinhole_rig_projects_as_opencv_does_with_any_length_of_distortion(
    tmp_path: Path, count: int
) -> None:
    distortion = np.zeros(count)
    distortion[: min(count, 12)] = [-0.2, 0.05, 1e-3, -2e-3, 0.01, 0.02, 0.01, 0.005, 1e-3, 1e-4, 2e-3, 1e-4][
        :count
    ]
    rig = load(tmp_path, opencv_file(M1=K1, D1=distortion, M2=K2, D2=distortion, **POSE), size=(848, 800))
    points = POINTS * [0.3, 0.3, 1]
    expected, _ = cv2.projectPoints(points, cv2.Rodrigues(R_RIGHT_LEFT)[0], T_RIGHT_LEFT, K2, distortion)
    pixels, ok = rig.right.project(rig.right_from_left(points))
    assert ok.all()
    np.testing.assert_allclose(pixels, expected[:, 0], atol=1e-9)


def test_omnidirectional_rig_projects_as_opencv_does(tmp_path: Path) -> None:
    rvec, tvec = np.array([0.01, -0.02, 0.03]), np.array([-0.2, 0.01, 0.0])
    distortion = np.array([[-0.1, 0.02, 1e-4, -2e-4]])
    content = opencv_file(
        camera_matrix_1=K1,
        distortion_coefficients_1=distortion,
        xi_1=0.9,
        camera_matrix_2=K2,
        distortion_coefficients_2=distortion,
        xi_2=1.1,
        rvec=rvec,
        tvec=tvec,
    )
    rig = load(tmp_path, content, size=(848, 800))
    expected, _ = cv2.omnidir.projectPoints(POINTS[None], rvec, tvec, K2, 1.1, distortion)
    pixels, ok = rig.right.project(rig.right_from_left(POINTS))
    assert ok.all()
    np.testing.assert_allclose(pixels, expected[0], atol=1e-9)


def test_intrinsics_and_extrinsics_in_two_files_make_a_rig(tmp_path: Path) -> None:
    intrinsics = opencv_file(**INTRINSICS, model="fisheye")
    extrinsics = opencv_file(**POSE, R1=np.eye(3), Q=np.eye(4))
    assert load(tmp_path, intrinsics, extrinsics, size=(848, 800)) == load(tmp_path, opencv_file(**WHOLE_RIG))


def test_a_file_for_each_camera_and_one_for_the_pose_make_a_rig(tmp_path: Path) -> None:
    left = opencv_file(**IMAGE, camera_matrix=K1, distortion_coefficients=D1, fisheye_model=1)
    right = opencv_file(image_width=640, image_height=480, camera_matrix=K2, distortion_coefficients=D2)
    rig = load(tmp_path, left, right, opencv_file(**POSE))
    assert (rig.left.size, rig.right.size) == ((848, 800), (640, 480))
    assert (rig.left.params["cx"], rig.right.params["cx"]) == (K1[0, 2], K2[0, 2])


RADTAN = {"D1": np.array([[-0.28, 0.07, 2e-4, 1.8e-5]]), "D2": np.array([[-0.27, 0.06, -1e-4, 3e-5]])}
UNTOLD = {key: value for key, value in WHOLE_RIG.items() if key != "model"}


def test_four_coefficients_of_no_lens_stated_are_a_pinhole_s_and_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    rig = load(tmp_path, opencv_file(**UNTOLD | RADTAN))
    assert (rig.left.model, rig.left.params["p1"]) == ("pinhole", 2e-4)
    assert "D1: taken for a pinhole's k1 k2 p1 p2" in caplog.text
    caplog.clear()
    assert load(tmp_path, opencv_file(**UNTOLD | RADTAN, model="pinhole")).left == rig.left
    assert not caplog.records


@pytest.mark.parametrize("key", ["distortion_model", "lens", "camera_type", "lens_type"])
def test_a_lens_may_be_named_by_another_key(
    tmp_path: Path, key: str, caplog: pytest.LogCaptureFixture
) -> None:
    rig = load(tmp_path, opencv_file(**UNTOLD, **{key: "equidistant"}))
    assert (rig.left.model, rig.right.model) == ("kannala-brandt", "kannala-brandt")
    assert caplog.messages == []
    assert load(tmp_path, opencv_file(**WHOLE_RIG, **{key: "gray"})).left == rig.left


def test_four_and_zeros_are_as_untold_as_four(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    five = {key: np.array([[*D[0], 0.0]]) for key, D in RADTAN.items()}
    rig = load(tmp_path, opencv_file(**UNTOLD | five))
    assert "D1: taken for a pinhole's k1 k2 p1 p2" in caplog.text
    assert rig.left.model == "pinhole"
    caplog.clear()
    five = {key: np.array([[*D[0], 0.01]]) for key, D in RADTAN.items()}
    load(tmp_path, opencv_file(**UNTOLD | five))
    assert caplog.messages == []
    with pytest.raises(InvalidInput, match="more of a fisheye's than a pinhole's"):
        load(tmp_path, opencv_file(**UNTOLD | {"D1": np.array([[*D1[0], 0.0]])}))


def test_four_coefficients_that_are_hardly_a_pinhole_s_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="more of a fisheye's than a pinhole's; expected `model: fisheye`"):
        load(tmp_path, opencv_file(**UNTOLD))
    rig = load(tmp_path, opencv_file(**UNTOLD), opencv_file(model="fisheye"))
    assert (rig.left.model, rig.left.params["k3"]) == ("kannala-brandt", -0.0458)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"K1": None}, "M1 or K1 or cameraMatrix1 is missing; expected a 3x3 camera matrix"),
        (
            {"D2": None},
            "D2 or distCoeffs2 or dist_coeffs2 is missing; expected 4 distortion coefficients (fisheye)",
        ),
        ({"R": None}, "R or rvec or om is missing; expected a 3x3 rotation"),
        ({"T": None}, "T or tvec or t is missing; expected three metres"),
        ({"image_width": None}, "image_width is missing; expected whole pixels"),
        (
            {"image_width": None, "image_height": None},
            "image_width is missing; expected it and image_height, or",
        ),
        ({"image_height": "tall"}, "image_height is 'tall'; expected whole pixels"),
        ({"image_width": 0}, "image_width and image_height: size is [0.0, 800.0]; expected (width, height)"),
        ({"K1": np.eye(2)}, "K1 is ['1.', '0.', '0.', '1.']; expected a 3x3 camera matrix"),
        ({"K1": "matrix"}, "K1 is 'matrix'; expected a 3x3 camera matrix"),
        ({"K1": SKEWED, "model": "pinhole"}, "K1 has skew"),
        ({"K1": np.full((3, 3), np.nan)}, "K1 is ['.Nan', "),
        ({"K1": -np.diag([1.0, 1, -1])}, "K1, D1: "),
        (
            {"D1": np.ones((1, 5))},
            "D1 is ['1.', '1.', '1.', '1.', '1.']; expected 4 distortion coefficients (fisheye)",
        ),
        ({"R": np.eye(3) * 2}, "R, T: R_right_left is no rotation"),
        ({"T": np.zeros(3)}, "R, T: the baseline is zero"),
        ({"model": "lightfield"}, "model is 'lightfield'; expected pinhole, fisheye or omnidir"),
        ({"model": "omnidir"}, "xi1 is missing; expected Mei's xi, a number"),
    ],
)
def test_a_fault_names_file_key_and_expectation(tmp_path: Path, change: dict, message: str) -> None:
    entries = {key: value for key, value in (WHOLE_RIG | change).items() if value is not None}
    with pytest.raises(InvalidInput) as caught:
        load(tmp_path, opencv_file(**entries))
    assert str(caught.value).startswith(str(tmp_path / "0.yml"))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_tilted_sensor_projects_as_opencv_s_does(tmp_path: Path) -> None:
    distortion = np.linspace(-0.03, 0.04, 14)
    content = opencv_file(M1=K1, D1=distortion, M2=K2, D2=distortion[:12], **POSE)
    rig = load(tmp_path, content, size=(848, 800))
    assert (rig.left.model, rig.right.model) == ("tilted-pinhole", "pinhole")
    points = np.array([[0.3, -0.2, 1.0], [-0.5, 0.1, 1.2], [0.0, 0.0, 2.0]])
    expected = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K1, distortion)[0].reshape(-1, 2)
    np.testing.assert_allclose(rig.left.project(points)[0], expected, atol=1e-9)


def test_the_t265_s_own_file_is_the_built_in_rig(real_data: Path) -> None:
    read, shipped = load_rig(real_data / "pairs/t265/calib_robot_fs.yml"), load_rig("t265")
    assert read.left.params == shipped.left.params
    assert read.right.params == shipped.right.params
    np.testing.assert_array_equal(read.R_right_left, shipped.R_right_left)
    np.testing.assert_array_equal(read.t_right_left, shipped.t_right_left)


def test_opencv_s_sample_asks_for_what_it_lacks(real_data: Path) -> None:
    sample = real_data / "calib/opencv/intrinsics.yml"
    with pytest.raises(InvalidInput, match="image_width is missing"):
        load_rig(sample)
    with pytest.raises(InvalidInput, match="R or rvec or om is missing"):
        load_rig(sample, size=(640, 480))
