"""A calibration that no format recognises: what it looks like, the nearest formats, where all are listed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from rectbench import load_rig
from rectbench.calibrations.checks.unknown import UnknownFormat
from tests.calibrations.examples import EXAMPLES
from tests.conftest import Shell


def lines_of(path: Path) -> list[str]:
    with pytest.raises(UnknownFormat) as caught:
        load_rig(path)
    lines = str(caught.value).split("\n")
    assert len(lines) == 3
    assert all(line.isprintable() and len(line) < 500 for line in lines)
    assert lines[2].endswith("rectbench list formats")
    return lines


def test_the_nearest_formats_say_what_they_would_need(tmp_path: Path) -> None:
    content = json.loads(EXAMPLES["basalt"].files["calibration.json"])["value0"]
    path = tmp_path / "calibration.json"
    path.write_text(json.dumps({"T_i_c": content.pop("T_imu_cam"), **content}))
    looks, nearest, _ = lines_of(path)
    assert looks.startswith(f"{path}: is no calibration known here but has the keys T_i_c, intrinsics, ")
    assert "basalt: T_imu_cam is missing; expected a list with a pose" in nearest


def test_a_camera_without_its_pose_is_near_to_its_format(tmp_path: Path) -> None:
    left, _ = (yaml.safe_load(text) for text in EXAMPLES["euroc"].files.values())
    (tmp_path / "left.yaml").write_text(yaml.safe_dump({k: v for k, v in left.items() if k != "T_BS"}))
    _, nearest, _ = lines_of(tmp_path / "left.yaml")
    assert "euroc: T_BS is missing; expected the pose from sensor to body, metres" in nearest


def test_what_is_near_to_none_says_so(tmp_path: Path) -> None:
    (tmp_path / "shopping.yaml").write_text("apples: 3\npears: 4\n")
    looks, nearest, _ = lines_of(tmp_path / "shopping.yaml")
    assert looks.endswith("has the keys apples, pears")
    assert nearest == "nearest: none, no format has keys like these"


def test_many_keys_are_cut_short(tmp_path: Path) -> None:
    (tmp_path / "many.yaml").write_text("".join(f"key{'x' * 90}{place}: 1\n" for place in range(40)))
    looks, *_ = lines_of(tmp_path / "many.yaml")
    assert looks.endswith(" and 32 more")


def test_the_command_line_prints_three_lines(tmp_path: Path, shell: Shell) -> None:
    (tmp_path / "shopping.yaml").write_text("apples: 3\npears: 4\n")
    code, out, err = shell("convert", tmp_path / "shopping.yaml", "-o", tmp_path / "rig.yaml")
    assert (code, out, err.count("\n")) == (2, "", 3)
    assert not (tmp_path / "rig.yaml").exists()
