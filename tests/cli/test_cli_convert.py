"""Calibrations converted from the command line."""

from __future__ import annotations

from pathlib import Path

import yaml

from rectbench import load_rig
from tests.calibrations.examples import EXAMPLES, FISHEYES
from tests.conftest import Shell
from tests.rigs_for_tests import assert_same_pose


def test_it_names_the_files_that_it_writes(tmp_path: Path, shell: Shell) -> None:
    FISHEYES.save(tmp_path / "rig.yaml")
    code, out, _ = shell("convert", tmp_path / "rig.yaml", "-o", tmp_path / "info", "--to", "ros")
    assert code == 0
    assert out.split() == [str(tmp_path / "info" / name) for name in ("left.yaml", "right.yaml")]
    code, out, _ = shell("convert", *out.split(), "-o", tmp_path / "rig.json", "--to", "opencv")
    assert code == 0
    assert_same_pose(load_rig(tmp_path / "rig.json"), FISHEYES)


def test_it_picks_cameras_and_limits_their_view(tmp_path: Path, shell: Shell) -> None:
    FISHEYES.save(tmp_path / "chain.yaml", "kalibr")
    options = ("--cameras", "cam1,cam0", "--max-angle-deg", "80")
    code, _, _ = shell("convert", tmp_path / "chain.yaml", "-o", tmp_path / "out.yaml", *options)
    assert code == 0
    assert load_rig(tmp_path / "out.yaml").left == FISHEYES.within(80).right


def test_of_three_cameras_it_lists_the_pairs(tmp_path: Path, shell: Shell) -> None:
    FISHEYES.save(tmp_path / "chain.yaml", "kalibr")
    chain = yaml.safe_load((tmp_path / "chain.yaml").read_text())
    (tmp_path / "chain.yaml").write_text(yaml.safe_dump(chain | {"cam2": chain["cam1"]}))
    code, out, err = shell("convert", tmp_path / "chain.yaml", "-o", tmp_path / "out.yaml")
    assert (code, out) == (2, "")
    question, *pairs = err.splitlines()
    assert "expected `--cameras` with two of them, such as cam0,cam1" in question
    assert "cam0,cam1: baseline 0.11 m" in pairs[0]
    code, *_ = shell(
        "convert", tmp_path / "chain.yaml", "-o", tmp_path / "out.yaml", "--cameras", "cam0,cam1"
    )
    assert code == 0
    assert load_rig(tmp_path / "out.yaml") == load_rig(tmp_path / "chain.yaml", cameras=("cam0", "cam1"))


def test_it_takes_the_size_and_unit_that_a_file_lacks(tmp_path: Path, shell: Shell) -> None:
    example = EXAMPLES["opencv-samples"]
    for name, text in example.files.items():
        (tmp_path / name).write_text(text)
    files = [tmp_path / name for name in example.files]
    code, _, err = shell("convert", *files, "-o", tmp_path / "out.yaml")
    assert code == 2
    assert "image_width is missing" in err
    code, *_ = shell("convert", *files, "-o", tmp_path / "out.yaml", "--size", "848x800", "--unit", "mm")
    assert code == 0
    assert_same_pose(load_rig(tmp_path / "out.yaml"), example.rig)


def test_it_says_what_cannot_be_written(tmp_path: Path, shell: Shell) -> None:
    code, out, err = shell("convert", "t265", "-o", tmp_path / "model", "--to", "mrcal")
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert "mrcal has no place for the left camera, kannala-brandt; expected one of" in err


def test_the_list_of_formats_says_which_are_written(shell: Shell) -> None:
    _, out, _ = shell("list", "formats")
    lines = {line.split()[0]: line for line in out.splitlines() if line.strip()}
    assert "read and written, as a folder" in lines["colmap"]
    assert "written" in lines["kalibr"]
    assert "written" not in lines["kitti360"]
