from __future__ import annotations

from pathlib import Path

import pytest

from rectbench import InvalidInput, Rig, UnknownName, load_rig
from rectbench.calibrations import rig_names
from tests.calibrations.calibration_files import WHOLE_RIG, opencv_file


def test_the_content_tells_the_kind_whatever_the_suffix(tmp_path: Path, rig: Rig, camchain: str) -> None:
    rig.save(tmp_path / "native.xml")
    (tmp_path / "kalibr.yml").write_text(camchain)
    (tmp_path / "opencv.txt").write_text(opencv_file(".json", **WHOLE_RIG))
    models = [load_rig(path).left.model for path in sorted(tmp_path.iterdir())]
    assert models == ["pinhole", "kannala-brandt", "kannala-brandt"]


def test_a_built_in_rig_goes_by_its_name() -> None:
    assert load_rig("t265").name == "t265"
    assert "t265" in rig_names()


def test_an_unknown_name_gets_the_nearest_ones() -> None:
    with pytest.raises(UnknownName, match="unknown rig 't256'; did you mean t265"):
        load_rig("t256")


def test_a_folder_of_a_rig_s_name_does_not_hide_the_rig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "t265").mkdir()
    monkeypatch.chdir(tmp_path)
    assert load_rig("t265").name == "t265"


def test_a_file_without_suffix_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    rig.save(tmp_path / "calibration")
    monkeypatch.chdir(tmp_path)
    assert load_rig("calibration") == rig


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("none.yaml", "none.yaml: cannot be read \\(No such file"),
        ("tests/rigs", "holds no calibration known here"),
        ("", "cannot be read"),
        ("a/\0b", "cannot be read"),
        ([], "expected a list of paths"),
        ([3], "expected a list of paths"),
    ],
)
def test_no_file_is_said(source: object, message: str) -> None:
    with pytest.raises(InvalidInput, match=message):
        load_rig(source)


def test_a_format_of_one_file_takes_no_second(tmp_path: Path, rig: Rig) -> None:
    paths = [tmp_path / "a.yaml", tmp_path / "b.yaml"]
    for path in paths:
        rig.save(path)
    with pytest.raises(InvalidInput, match="is read together with"):
        load_rig(paths)


@pytest.mark.parametrize("size", [(640,), (640, 0), (640, 480.5), "640x480", (float("nan"), 3)])
def test_a_size_that_is_none_is_refused(size: object) -> None:
    with pytest.raises(InvalidInput, match="expected \\(width, height\\)"):
        load_rig("t265", size=size)
