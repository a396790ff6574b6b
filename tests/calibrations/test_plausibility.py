"""What a calibration says twice is compared, and what is improbable is told, in one line each."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from rectbench import Camera, Rig, load_rig
from rectbench.calibrations.checks.plausibility import tell_implausible
from tests.calibrations.calibration_files import D1, D2, IMAGE, K1, K2, POSE, opencv_file
from tests.calibrations.examples import EXAMPLES, FISHEYES, PINHOLES
from tests.calibrations.test_every_format import written

FOCAL = {"fx": 1130.0, "fy": 1128.0, "cx": 960.0, "cy": 600.0}
TURNING = {"k1": -1.15, "k2": 2.9, "k3": -2.48, "k4": 0.18}


def with_left(rig: Rig, **params: float) -> Rig:
    return replace(rig, left=replace(rig.left, params={**rig.left.params, **params}))


def test_a_plausible_rig_is_passed_over(caplog: pytest.LogCaptureFixture) -> None:
    for rig in (FISHEYES, PINHOLES):
        tell_implausible(rig)
    assert caplog.messages == []


@pytest.mark.parametrize(
    ("rig", "message"),
    [
        (with_left(FISHEYES, fx=340.0), "the left camera's focal lengths are 340 and 286.759 px"),
        (with_left(FISHEYES, cx=900.0), "principal point (900, 403.394) is not on its image, 848x800"),
        (replace(FISHEYES, t_right_left=[-0.0011, 0, 0]), "the baseline is 0.0011 m, which few rigs have"),
        (replace(FISHEYES, t_right_left=[-110, 0, 0]), "the baseline is 110 m, which few rigs have"),
    ],
)
def test_what_is_improbable_is_told(rig: Rig, message: str, caplog: pytest.LogCaptureFixture) -> None:
    tell_implausible(rig)
    (told,) = caplog.messages
    assert message in told


@pytest.mark.parametrize(
    ("model", "params"),
    [
        ("kannala-brandt", TURNING | {"skew": 4.0}),
        ("pinhole", {"k1": -0.9, "p1": 0.01}),
        ("radial-tangential", {"k1": -0.9, "skew": 3.0}),
        ("tilted-pinhole", {"k1": -0.9, "tau_x": 0.05}),
    ],
)
def test_the_share_beyond_the_turn_is_that_of_the_pixels_that_see_nothing(
    model: str, params: dict[str, float], caplog: pytest.LogCaptureFixture
) -> None:
    camera = Camera(model, (1920, 1200), FOCAL | params)
    tell_implausible(Rig(camera, camera, np.eye(3), [-0.1, 0, 0]))
    left, right = caplog.messages
    u, v = np.meshgrid(np.linspace(0, 1919, 97), np.linspace(0, 1199, 97))
    unseen = 1.0 - camera.unproject(np.stack([u, v], axis=-1))[1].mean()
    share = float(left.split("the ")[-2].split("%")[0]) / 100
    assert unseen > 0.05
    assert share == pytest.approx(unseen, abs=0.02)
    assert "inside the image" in left
    assert left.replace("left", "right") == right


def test_a_lens_whose_image_circle_is_stated_is_not_told_to_turn(caplog: pytest.LogCaptureFixture) -> None:
    camera = Camera("kannala-brandt", (1920, 1200), FOCAL | TURNING, max_angle_deg=40)
    tell_implausible(Rig(camera, camera, np.eye(3), [-0.1, 0, 0]))
    assert caplog.messages == []


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"R1": np.eye(3), "R2": np.eye(3)}, "R1 turns 2.57° otherwise than R, which is kept to"),
        (
            {"P2": np.array([[300.0, 0, 4, -60], [0, 300, 5, 0], [0, 0, 1, 0]])},
            "is a baseline of 0.2, but T one",
        ),
    ],
)
def test_a_rectification_that_contradicts_the_pose_is_told(
    tmp_path: Path, more: dict[str, np.ndarray], message: str, caplog: pytest.LogCaptureFixture
) -> None:
    content = {"model": "fisheye", **IMAGE, "K1": K1, "D1": D1, "K2": K2, "D2": D2, **POSE, **more}
    (tmp_path / "rig.yml").write_text(opencv_file(**content))
    load_rig(tmp_path / "rig.yml")
    (told,) = caplog.messages
    assert message in told


def test_kalibr_s_two_poses_are_compared(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    chain = yaml.safe_load(EXAMPLES["openvins"].files["chain.yaml"].replace("%YAML:1.0", ""))
    rig = EXAMPLES["openvins"].rig
    for camera in ("cam0", "cam1"):
        key = next(key for key in chain[camera] if "imu" in key)
        T = np.array(chain[camera].pop(key))
        chain[camera]["T_cam_imu"] = (T if key == "T_cam_imu" else np.linalg.inv(T)).tolist()
    chain["cam1"]["T_cn_cnm1"] = np.vstack([np.c_[rig.R_right_left, rig.t_right_left], [0, 0, 0, 1]]).tolist()
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    load_rig(tmp_path / "chain.yaml")
    assert caplog.messages == []
    chain["cam1"]["T_cn_cnm1"][0][3] *= 1.3
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    load_rig(tmp_path / "chain.yaml")
    (told,) = caplog.messages
    assert "T_cam_imu is a baseline of 0.11" in told


def test_easymocap_s_two_rotations_are_compared(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (extrinsics,) = written(EXAMPLES["easymocap"], tmp_path)
    text = extrinsics.read_text()
    start = text.index("data:", text.index("R_2"))
    extrinsics.write_text(text[:start] + "data: [ 0.1, 0.2, 0.3 ]" + text[text.index("]", start) + 1 :])
    load_rig(extrinsics, size=(848, 800))
    (told,) = caplog.messages
    assert "otherwise than Rot_2, which is kept to" in told
