"""Of a file with more than two cameras any two make a rig, in the order in which they are asked for."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from rectbench import InvalidInput, load_rig
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
    "kitti": ("01", "00"),
    "kitti-rectified": ("P1", "P0"),
}


@pytest.mark.parametrize("name", RIGHT_AND_LEFT)
def test_cameras_asked_for_the_other_way_round_are_swapped_with_their_pose(tmp_path: Path, name: str) -> None:
    example = EXAMPLES[name]
    rig = load_rig(written(example, tmp_path), **{**example.options, "cameras": RIGHT_AND_LEFT[name]})
    assert (rig.left.size, rig.right.size) == (example.rig.right.size, example.rig.left.size)
    assert rig.left.params["fx"] == pytest.approx(example.rig.right.params["fx"])
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
