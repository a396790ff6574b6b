"""Nothing in a file is left unread without a word, whatever reader reads it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from rectbench import InvalidInput, load_rig
from rectbench.calibrations import telling, told_already
from rectbench.calibrations.checks.unread import tell_unread
from rectbench.calibrations.documents.sources import Source
from tests.calibrations.examples import EXAMPLES, FISHEYES
from tests.calibrations.test_every_format import assert_same_rig, written

FOUR = "taken for a pinhole's k1 k2 p1 p2"
SCALE = "its scale is arbitrary unless something fixed it; taken to be in metres"
UNDISTORTED = "left out, as Argoverse's images are undistorted"
TOLD = {
    "opencv-sections": (FOUR, FOUR),
    "opencv-samples": (FOUR, FOUR),
    "opencv-left-right": (FOUR, FOUR),
    "ros-fisheye-today": ("P has each camera's own K R",),
    "ros-fisheye-own-focal": ("P has each camera's own focal length",),
    "kitti-rectified": ("holds 3 cameras; 0 and 1 are taken, others by `cameras`",),
    "left-right": ("right.T: taken to take points of the frame that both share",),
    "simplestereo": ("too long for metres; taken to be in mm (`unit` says otherwise)",),
    "multical-master": ("taken for those of MultiCal's fisheye",) * 2,
    "realsense-json-plain": ("extrinsics: taken to lead from left to right",),
    "metashape-fisheye": (SCALE,),
    "transforms": (SCALE,),
    "transforms-ngp": (SCALE,),
    "transforms-f-theta": (SCALE,),
    "openmvg": (SCALE,),
    "alicevision": (SCALE,),
    "alicevision-rig": (SCALE,),
    "drive": ("linear-e: missing", "correction_sensor_R_FLU, correction_rig_T: missing", "linear-e: missing"),
    "argoverse": (UNDISTORTED,) * 2,
    "argoverse-two": (UNDISTORTED,) * 2,
}
"""Of which examples something is assumed, and what, line by line."""


@pytest.mark.parametrize("name", TOLD)
def test_what_is_assumed_is_told(tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture) -> None:
    load_rig(written(EXAMPLES[name], tmp_path), **EXAMPLES[name].options)
    assert len(caplog.messages) == len(TOLD[name])
    assert all(text in line for text, line in zip(TOLD[name], caplog.messages, strict=True))


@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in TOLD])
def test_of_a_file_that_is_understood_nothing_is_told(
    tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    load_rig(written(EXAMPLES[name], tmp_path), **EXAMPLES[name].options)
    assert caplog.messages == []


def changed_chain(folder: Path, **left: object) -> Path:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    chain["cam0"] |= left
    path = folder / "chain.yaml"
    path.write_text(yaml.safe_dump(chain))
    return path


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("distortion_type", 1),
        ("radial_tangential", {"radial": [0.1, 0.2]}),
        ("lens", "fisheye"),
        ("P", [[1.0, 2.0, 3.0]]),
        ("camera_type", "equidistant"),
        ("T_cam_body", {"rows": 1, "cols": 1, "data": [7.0]}),
        ("k1", 0.1),
    ],
)
def test_what_looks_like_a_lens_or_a_pose_and_is_not_read_is_told(
    tmp_path: Path, key: str, value: object, caplog: pytest.LogCaptureFixture
) -> None:
    rig = load_rig(changed_chain(tmp_path, **{key: value}))
    (told,) = caplog.messages
    assert f"cam0.{key}: looks like part of a lens or a pose, but is not read" in told
    assert_same_rig(rig, EXAMPLES["kalibr"].rig)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rostopic", "/cam0/image_raw"),
        ("distortion_offset", [0.0, 0.0]),
        ("R", ""),
        ("T_cam_imu_std", [1.0, 2.0]),
        ("camera_type", "gray"),
        ("imu", {"R": [1.0]}),
        ("name", "cam"),
    ],
)
def test_what_says_nothing_of_lens_or_pose_is_not_told(
    tmp_path: Path, key: str, value: object, caplog: pytest.LogCaptureFixture
) -> None:
    load_rig(changed_chain(tmp_path, **{key: value}))
    assert caplog.messages == []


def test_a_camera_that_was_not_asked_for_is_no_unread_part(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    content = json.loads(EXAMPLES["basalt"].files["calibration.json"])
    for values in content["value0"].values():
        if isinstance(values, list) and len(values) == 2:
            values.append(values[0])
    (tmp_path / "three.json").write_text(json.dumps(content))
    load_rig(tmp_path / "three.json", cameras=("cam0", "cam1"))
    assert caplog.messages == []


def test_a_distortion_left_unread_beside_perfect_pinholes_is_refused(tmp_path: Path) -> None:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    for camera in ("cam0", "cam1"):
        chain[camera] |= {"camera_model": "pinhole", "distortion_model": "none", "distortion_coeffs": []}
        chain[camera] |= {"intrinsics": [300.0, 300, 424, 400], "distortion_k": [-0.01, 0.02, 0, 0]}
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    with pytest.raises(InvalidInput, match=r"cam0\.distortion_k.*: looks like a distortion, which is not"):
        load_rig(tmp_path / "chain.yaml")


def test_a_file_that_a_file_leads_to_is_looked_at_too(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (path,) = written(EXAMPLES["openvins-estimator"], tmp_path)
    chain = tmp_path / "chain.yaml"
    chain.write_text(chain.read_text() + "lens_model: a new one\n")
    load_rig(path)
    (told,) = caplog.messages
    assert told.startswith(f"{chain}: lens_model: looks like part")


def test_what_cannot_be_read_tells_nothing_else(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    paths = written(EXAMPLES["ros"], tmp_path)
    for path in paths:
        path.write_text(path.read_text().replace("distortion_model: rational_polynomial\n", ""))
    with pytest.raises(InvalidInput):
        load_rig(paths, size=(3, 3))
    assert caplog.messages == []
    load_rig(paths)
    assert len(caplog.messages) == 2
    assert caplog.messages[0].endswith("left.yaml: distortion_model is missing; taken to be plumb_bob")


def test_a_reader_need_do_nothing_for_it(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "lab.json"
    path.write_text('{"baseline": 0.1, "lens": {"focal": 300, "tilt_tau": [0.01, 0.02], "focal_note": ""}}')
    source = Source.read(path)
    source.document.number("baseline", "metres")
    source.document.section("lens", "a lens").number("focal", "pixels")
    tell_unread([source], FISHEYES)
    assert caplog.messages == [
        f"{path}: lens.tilt_tau: looks like part of a lens or a pose, but is not read; left out"
    ]


def test_a_rectification_that_contradicts_the_pose_is_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    content = json.loads(EXAMPLES["depthai"].files["calib.json"])
    content["stereoRectificationData"]["rectifiedRotationRight"] = np.eye(3).tolist()
    (tmp_path / "oak.json").write_text(json.dumps(content))
    load_rig(tmp_path / "oak.json")
    (told,) = caplog.messages
    assert "turns 2.57° otherwise than the cameras' extrinsics" in told


def test_a_baseline_that_contradicts_the_projection_is_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (path,) = written(EXAMPLES["orbslam2"], tmp_path)
    path.write_text(path.read_text().replace("Camera.bf: 33.0", "Camera.bf: 47.9"))
    load_rig(path)
    (told,) = caplog.messages
    assert "Camera.bf is 47.9, but 33.00" in told


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("baseline", 0.1100, None),
        ("baseline_mm", 110.0, None),
        ("Baseline", 0.25, "Baseline is 0.25, but it is 0.110019 m by the pose, which is kept to"),
        ("hfov", 160.0, "hfov is 160, but it is"),
    ],
)
def test_a_length_or_an_angle_that_is_said_again_is_compared(
    tmp_path: Path, key: str, value: float, message: str | None, caplog: pytest.LogCaptureFixture
) -> None:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain | {key: value}))
    load_rig(tmp_path / "chain.yaml")
    assert [message in told for told in caplog.messages] == [True] if message else caplog.messages == []


def test_a_file_of_which_nothing_was_read_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A second configuration in a folder, which nobody asks."""
    written(EXAMPLES["vins"], tmp_path)
    (tmp_path / "other.yaml").write_text(next(iter(EXAMPLES["euroc"].files.values())))
    load_rig(tmp_path)
    (told,) = caplog.messages
    assert told.startswith(f"{tmp_path / 'other.yaml'}: ")
    assert "T_BS" in told


def test_what_was_told_of_files_already_is_not_told_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = changed_chain(tmp_path, lens="fisheye")
    with told_already() as lines:
        load_rig(path)
    assert caplog.messages == []
    assert len(lines) == 1
    with telling():
        load_rig(path)
        load_rig(path)
        assert caplog.messages == []
    assert caplog.messages == lines


@pytest.mark.parametrize(
    ("name", "more"),
    [
        ("stella", "Tracking:\n  baseline_dist_thr: 0.1\nMapping:\n  baseline_dist_thr_ratio: 0.02\n"),
        ("openvins-estimator", "calib_cam_extrinsics: true\ncalib_cam_intrinsics: true\n"),
        ("vins", "loop_closure: 1\nimu_topic: /imu0\n"),
        ("camodocal-vins-mono", "fisheye: 1\nfisheye_mask: mask.jpg\nestimate_extrinsic: 1\n"),
        ("orbslam3", "IMU.T_b_c1: [1.0]\nViewer.ViewpointF: 500.0\n"),
        ("okvis", "camera_extrinsics:\n  sigma_absolute_translation: 0.1\n"),
        ("ros", "binning_x: 1\nroi: {x_offset: 3, do_rectify: false}\n"),
        ("basalt", "T_mocap_world: [1.0]\n"),
    ],
)
def test_what_programs_keep_beside_their_cameras_is_not_told(
    tmp_path: Path, name: str, more: str, caplog: pytest.LogCaptureFixture
) -> None:
    """Lines that real configurations of these programs have."""
    path, *others = written(EXAMPLES[name], tmp_path)
    if path.suffix == ".json":
        path.write_text(json.dumps(json.loads(path.read_text()) | yaml.safe_load(more)))
    else:
        path.write_text(path.read_text() + more)
    load_rig([path, *others], **EXAMPLES[name].options)
    assert caplog.messages == []


def test_a_mapping_beside_a_list_that_was_read_is_no_other_camera(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    content = json.loads(EXAMPLES["transforms-ngp"].files["transforms.json"])
    (tmp_path / "transforms.json").write_text(json.dumps({**content, "more": {"k1": 0.1}}))
    load_rig(tmp_path / "transforms.json")
    assert "more: looks like part of a lens or a pose, but is not read" in caplog.text


LEFT_OUT = {
    "transforms": (
        "transforms.json",
        {"fl_y": "fl_y: missing; taken to be fl_x", "k4": "k4: missing; taken to be 0"},
    ),
    "transforms-ngp": (
        "transforms.json",
        {"cx": "cx: missing; taken to be the image's centre", "p1": "p1: missing; taken to be 0"},
    ),
    "nurec": (
        "rig_trajectories.json",
        {"max_angle": "max_angle: missing", "linear_cde": "linear_cde: missing"},
    ),
    "alicevision": ("cameras.sfm.json", {"pixelRatio": "taken to be 1", "sensorWidth": "taken to be 36"}),
    "drive": ("rig.json", {"correction_rig_T": "correction_rig_T: missing; taken to be 0"}),
    "isaac": (
        "camera_params_right.json",
        {"metersPerSceneUnit": "taken to be 1, metres", "cameraApertureOffset": "taken to be [0, 0]"},
    ),
}


@pytest.mark.parametrize(
    ("name", "key", "told"),
    [(name, key, told) for name, (_, keys) in LEFT_OUT.items() for key, told in keys.items()],
)
def test_what_is_taken_for_a_key_that_is_left_out_is_told(
    tmp_path: Path, name: str, key: str, told: str, caplog: pytest.LogCaptureFixture
) -> None:
    paths = written(EXAMPLES[name], tmp_path)
    path = tmp_path / LEFT_OUT[name][0]
    path.write_text(json.dumps(without(json.loads(path.read_text()), key)))
    unit = {"unit": "m"} if key == "metersPerSceneUnit" else {}  # or else eleven metres are refused
    load_rig(paths, **{**EXAMPLES[name].options, **unit})
    assert told in caplog.text


def without(content: object, key: str) -> object:
    """The same content, at any depth without a key."""
    if isinstance(content, dict):
        return {name: without(value, key) for name, value in content.items() if name != key}
    return [without(item, key) for item in content] if isinstance(content, list) else content


def test_a_baseline_of_metres_is_told_where_no_unit_is_stated(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (path,) = written(EXAMPLES["boofcv"], tmp_path)
    content = yaml.safe_load(path.read_text())
    content["rightToLeft"] |= {"x": 4.2, "y": 0.0, "z": 0.0}
    path.write_text(yaml.safe_dump(content))
    assert load_rig(path, unit="m").baseline_m == pytest.approx(4.2)
    assert caplog.messages == []
    load_rig(path)
    assert "the baseline is taken to be 4.2 m; `unit` says otherwise" in caplog.text
