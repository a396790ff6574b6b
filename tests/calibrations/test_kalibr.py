from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from rectbench import Camera, InvalidInput, load_rig

FOCAL = {"fx": 461.0, "fy": 460.0, "cx": 362.0, "cy": 246.0}
KALIBR_FOCAL = [461.0, 460.0, 362.0, 246.0]


@pytest.fixture
def path(tmp_path: Path, camchain: str) -> Path:
    path = tmp_path / "camchain.yaml"
    path.write_text(camchain)
    return path


def test_pose_takes_cam0_to_cam1(path: Path) -> None:
    rig = load_rig(path)
    T = np.array(yaml.safe_load(path.read_text())["cam1"]["T_cn_cnm1"], dtype=float)
    point = np.array([0.3, -0.2, 2.0, 1.0])
    np.testing.assert_allclose(rig.right_from_left(point[:3]), (T @ point)[:3], atol=1e-15)
    assert rig.name == "camchain"


@pytest.mark.parametrize(
    ("camera_model", "distortion_model", "intrinsics", "coefficients", "expected"),
    [
        ("pinhole", "none", [], [], Camera("pinhole", (752, 480), FOCAL)),
        (
            "pinhole",
            "radtan",
            [],
            [-0.27, 0.07, 0.001, 0.0001],
            Camera("pinhole", (752, 480), dict(**FOCAL, k1=-0.27, k2=0.07, p1=0.001, p2=0.0001)),
        ),
        (
            "pinhole",
            "equi",
            [],
            [-0.01, 0.05, -0.08, 0.04],
            Camera("kannala-brandt", (752, 480), dict(**FOCAL, k1=-0.01, k2=0.05, k3=-0.08, k4=0.04)),
        ),
        (
            "pinhole",
            "equidistant",
            [],
            [-0.01, 0.05, -0.08, 0.04],
            Camera("kannala-brandt", (752, 480), dict(**FOCAL, k1=-0.01, k2=0.05, k3=-0.08, k4=0.04)),
        ),
        ("pinhole", "fov", [], [0.9], Camera("field-of-view", (752, 480), dict(**FOCAL, omega=0.9))),
        ("omni", "none", [0.8], [], Camera("unified", (752, 480), dict(**FOCAL, xi=0.8))),
        (
            "omni",
            "radtan",
            [0.8],
            [-0.3, 0.1, 0.001, 0.0001],
            Camera("unified", (752, 480), dict(**FOCAL, xi=0.8, k1=-0.3, k2=0.1, p1=0.001, p2=0.0001)),
        ),
        (
            "ds",
            "none",
            [-0.2, 0.6],
            [],
            Camera("double-sphere", (752, 480), dict(**FOCAL, xi=-0.2, alpha=0.6)),
        ),
        (
            "eucm",
            "none",
            [0.6, 1.1],
            [],
            Camera("extended-unified", (752, 480), dict(**FOCAL, alpha=0.6, beta=1.1)),
        ),
    ],
)
def test_every_projection_of_kalibr_becomes_its_camera(
    path: Path,
    camera_model: str,
    distortion_model: str,
    intrinsics: list,
    coefficients: list,
    expected: Camera,
) -> None:
    chain = yaml.safe_load(path.read_text())
    chain["cam0"] |= {
        "camera_model": camera_model,
        "distortion_model": distortion_model,
        "intrinsics": intrinsics + KALIBR_FOCAL,
        "distortion_coeffs": coefficients,
    }
    path.write_text(yaml.safe_dump(chain))
    assert load_rig(path).left == expected


def test_a_camera_that_cannot_be_read_is_in_no_pair_that_is_listed(path: Path) -> None:
    two = load_rig(path)
    path.write_text(path.read_text() + "cam2:\n  camera_model: unheard of\n")
    with pytest.raises(InvalidInput, match=r"holds 3 cameras; .* with two of them.*\ncam0,cam1: [^\n]*$"):
        load_rig(path)
    assert load_rig(path, cameras=("cam0", "cam1")) == two


def test_opencv_s_yaml_header_is_no_hindrance(path: Path) -> None:
    plain = load_rig(path)
    path.write_text("%YAML:1.0\n---\n" + path.read_text())
    assert load_rig(path) == plain


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("cam1", None, "cam1 is missing; expected the second camera; a rig takes two"),
        (
            "cam1.T_cn_cnm1",
            None,
            "cam1.T_cn_cnm1 is missing; expected the pose from the camera before to this one, metres, a 4x4",
        ),
        ("cam1.T_cn_cnm1", np.eye(3).tolist(), "cam1.T_cn_cnm1 is [['1.0', "),
        ("cam1.T_cn_cnm1", np.eye(4).tolist(), "cam1.T_cn_cnm1: the baseline is zero"),
        (
            "cam1.T_cn_cnm1",
            (2 * np.eye(4)).tolist(),
            "cam1.T_cn_cnm1 has the last row [0.0, 0.0, 0.0, 2.0]; expected [0, 0, 0, 1]",
        ),
        ("cam1.T_cn_cnm1", np.diag([1.0, 1, 2, 1]).tolist(), "cam1.T_cn_cnm1: its 3x3 part is no rotation"),
        (
            "cam0.camera_model",
            "fisheye",
            "cam0.camera_model is 'fisheye'; expected pinhole, omni, ds or eucm",
        ),
        ("cam0.distortion_model", "fov5", "cam0.distortion_model is 'fov5'; expected none, radtan"),
        (
            "cam0.intrinsics",
            [1.0, 2.0],
            "cam0.intrinsics is ['1.0', '2.0']; expected 4 finite numbers (fx fy cx cy)",
        ),
        ("cam0.distortion_coeffs", [float("nan")] * 4, "expected 4 finite numbers (k1 k2 p1 p2)"),
        (
            "cam0.resolution",
            None,
            "cam0.resolution is missing; expected [width, height] in whole pixels, or `size`",
        ),
        ("cam0", "none", "cam0 is 'none'; expected the first camera, the left one"),
    ],
)
def test_a_fault_names_file_key_and_expectation(path: Path, key: str, value: object, message: str) -> None:
    chain = yaml.safe_load(path.read_text())
    *sections, last = key.split(".")
    holder = chain[sections[0]] if sections else chain
    holder.pop(last) if value is None else holder.update({last: value})
    path.write_text(yaml.safe_dump(chain))
    with pytest.raises(InvalidInput) as caught:
        load_rig(path)
    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_kalibr_s_own_files_are_read(real_data: Path) -> None:
    folder = real_data / "calib/kalibr"
    assert load_rig(folder / "camchain-ds-tiscamera-2020-08-05.yaml").left.model == "double-sphere"
    mixed = load_rig(folder / "camchain-omni-wiki-example.yaml")
    assert (mixed.left.model, mixed.right.model) == ("pinhole", "unified")
