"""Of a file with more than two cameras any two make a rig, in the order in which they are asked for."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from rectbench import InvalidInput, load_rig
from rectbench.calibrations import CamerasNotChosen
from tests.calibrations.examples import EXAMPLES
from tests.calibrations.test_every_format import written

RIGHT_AND_LEFT = {
    "kalibr": ("cam1", "cam0"),
    "basalt": ("cam1", "cam0"),
    "ncamera": ("cam1", "cam0"),
    "ncamera-maplab": ("cam1", "cam0"),
    "okvis": ("cam1", "cam0"),
    "depthai": ("CAM_C", "CAM_B"),
    "anipose": ("B", "A"),
    "anipose-caliscope": ("1", "0"),
    "mccalib": ("camera_1", "camera_0"),
    "easymocap": ("2", "1"),
    "multical": ("cam2", "cam1"),
    "multical-master": ("cam2", "cam1"),
    "realsense": ("Fisheye 2", "Fisheye 1"),
    "realsense-d400": ("Infrared 2", "Infrared 1"),
    "realsense-json": ("fisheye_2", "fisheye_1"),
    "realsense-json-plain": ("right", "left"),
    "aria": ("camera-slam-right", "camera-slam-left"),
    "facebook360": ("cam1", "cam0"),
    "metashape-fisheye": ("right", "left"),
    "transforms": ("images/right.png", "left.png"),
    "openmvg": ("right.jpg", "left.jpg"),
    "alicevision": ("right.jpg", "/images/left.jpg"),
    "alicevision-rig": ("b.png", "a.png"),
    "drive": ("camera:right", "camera:left"),
    "nurec": ("camera_right", "camera_left"),
    "nuscenes": ("CAM_RIGHT", "CAM_LEFT"),
    "argoverse": ("stereo_front_right", "stereo_front_left"),
    "argoverse-two": ("ring_front_left", "ring_side_left"),
    "kitti": ("01", "00"),
    "kitti-rectified": ("P1", "P0"),
}


@pytest.mark.parametrize("name", RIGHT_AND_LEFT)
def test_cameras_asked_for_the_other_way_round_are_swapped_with_their_pose(tmp_path: Path, name: str) -> None:
    example = EXAMPLES[name]
    rig = load_rig(written(example, tmp_path), **{**example.options, "cameras": RIGHT_AND_LEFT[name]})
    assert (rig.left.size, rig.right.size) == (example.rig.right.size, example.rig.left.size)
    assert rig.left.params["cx"] == pytest.approx(example.rig.right.params["cx"])
    np.testing.assert_allclose(rig.R_right_left, example.rig.R_right_left.T, atol=1e-12)
    np.testing.assert_allclose(rig.t_right_left, example.rig.centre_right_in_left, atol=1e-12)


@pytest.mark.parametrize("name", RIGHT_AND_LEFT)
def test_a_camera_that_is_not_there_is_named(tmp_path: Path, name: str) -> None:
    example = EXAMPLES[name]
    with pytest.raises(InvalidInput, match=r"nobody|cam0, cam1 and so on"):
        load_rig(written(example, tmp_path), **{**example.options, "cameras": ("nobody", "no one")})


def test_cameras_beyond_the_tenth_follow_the_ninth(tmp_path: Path) -> None:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    chain |= {f"cam{number}": chain["cam1"] for number in range(2, 12)}
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    rig = load_rig(tmp_path / "chain.yaml", cameras=("cam9", "cam11"))
    step = np.array(chain["cam1"]["T_cn_cnm1"])
    np.testing.assert_allclose(rig.t_right_left, (step @ step)[:3, 3], atol=1e-12)


def with_a_third(name: str, folder: Path) -> list[Path]:
    """An example whose second camera is there a second time, under a name of its own."""
    paths = written(EXAMPLES[name], folder)
    for path in paths:
        text = path.read_text()
        content = (
            json.loads(text) if path.suffix == ".json" else yaml.safe_load(text.replace("%YAML:1.0", ""))
        )
        for holder in (content, content.get("value0", {}), *content.get("sensors", [])):
            for key in ("cameras", "intrinsics", "resolution", "T_imu_cam", "cameraData"):
                if isinstance(holder.get(key), list):
                    holder[key].append(json.loads(json.dumps(holder[key][1])))
        if name == "kalibr":
            content["cam2"] = {**content["cam1"], "T_cn_cnm1": np.diag([1.0, 1, 1, 1]).tolist()}
            content["cam2"]["T_cn_cnm1"][0][3] = -0.05
        path.write_text(json.dumps(content))
    return paths


@pytest.mark.parametrize("name", ["kalibr", "basalt", "ncamera", "ncamera-maplab", "okvis"])
def test_of_three_cameras_the_pairs_are_listed_and_none_is_taken(
    tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    paths = with_a_third(name, tmp_path)
    with pytest.raises(CamerasNotChosen, match="holds 3 cameras; expected `cameras`") as caught:
        load_rig(paths)
    assert caught.value.names == ("cam0", "cam1", "cam2")
    asked, *pairs = str(caught.value).splitlines()
    assert any(pair.startswith("cam0,cam1: baseline 0.11 m, ") for pair in pairs)
    assert asked.endswith(f"two of them, such as {pairs[0].partition(':')[0]}, which see the most in common")
    caplog.clear()
    rig = load_rig(paths, cameras=("cam0", "cam1"))
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES[name].rig.t_right_left, atol=1e-12)
    assert load_rig(paths, cameras=("cam0", "cam2")).baseline_m > 0
    assert caplog.messages == []


def test_the_pairs_that_see_most_in_common_come_first_and_left_is_left(tmp_path: Path) -> None:
    chain = yaml.safe_load(EXAMPLES["openvins"].files["chain.yaml"].replace("%YAML:1.0", ""))
    for name, turn_deg, x in (("cam0", 0, 0.0), ("cam1", 0, 0.1), ("cam2", 120, 0.2)):
        chain[name] = {**chain["cam0"], "T_cam_imu": np.eye(4).tolist()}
        R = Rotation.from_euler("y", -turn_deg, degrees=True).as_matrix()
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, R @ [x, 0, 0]
        chain[name]["T_cam_imu"] = T.tolist()
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain))
    with pytest.raises(CamerasNotChosen) as caught:
        load_rig(tmp_path / "chain.yaml")
    listed = re.findall(r"(?m)^(cam\d,cam\d): baseline ([\d.]+) m, (\d+) %", str(caught.value))
    assert listed[0] == ("cam1,cam0", "0.1", "100")
    assert [float(share) for *_, share in listed[1:]] == sorted(
        (float(share) for *_, share in listed[1:]), reverse=True
    )
    assert max(float(share) for *_, share in listed[1:]) < 60


def changed_oak(change: Callable[[Any], None], folder: Path) -> Path:
    content = json.loads(EXAMPLES["depthai"].files["calib.json"])
    change(content)
    path = folder / "calib.json"
    path.write_text(json.dumps(content))
    return path


def test_a_chain_of_cameras_without_end_is_refused(tmp_path: Path) -> None:
    def circle(content: Any) -> None:
        content["cameraData"][1][1]["extrinsics"]["toCameraSocket"] = 1

    with pytest.raises(InvalidInput, match="leads back to its own camera; expected an end, -1"):
        load_rig(changed_oak(circle, tmp_path))


def test_cameras_of_two_chains_are_no_rig(tmp_path: Path) -> None:
    def apart(content: Any) -> None:
        content["cameraData"][2][1]["extrinsics"]["toCameraSocket"] = -1

    with pytest.raises(InvalidInput, match="end at different cameras; expected one chain of both"):
        load_rig(changed_oak(apart, tmp_path))


def test_the_cameras_of_two_groups_are_no_rig(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["mccalib"], tmp_path)
    before, _, after = path.read_text().rpartition("camera_group: 0")
    path.write_text(f"{before}camera_group: 1{after}")
    with pytest.raises(InvalidInput, match=r"camera_1\.camera_group is not that of the other camera"):
        load_rig(path)


def test_a_zed_s_resolution_is_chosen_by_the_size(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["zed"], tmp_path)
    assert (
        load_rig(path, size=(2208, 1242)).left.params["fx"]
        == 2 * load_rig(path, size=(1280, 720)).left.params["fx"]
    )
    with pytest.raises(InvalidInput, match="holds 2 resolutions; expected `size` 1280x720 or 2208x1242"):
        load_rig(path)
    with pytest.raises(InvalidInput, match="holds no cameras of \\(640, 480\\); expected `size` 1280x720"):
        load_rig(path, size=(640, 480))
