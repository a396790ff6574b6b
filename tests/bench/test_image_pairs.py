"""Images are paired by their names, and what has no partner is named."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from rectbench.bench.image_pairs import image_pairs
from rectbench.errors import InvalidInput


def touched(folder: Path, *names: str) -> Path:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    return folder


def names(pairs: object) -> list[tuple[str, str, str]]:
    return [(pair.name, pair.left.name, pair.right.name) for pair in pairs]  # type: ignore[attr-defined]


def test_two_files_are_a_pair_whatever_they_are_called(tmp_path: Path) -> None:
    touched(tmp_path, "fs1.dat", "robot.xyz")
    found = image_pairs(str(tmp_path / "fs1.dat"), str(tmp_path / "robot.xyz"))
    assert names(found) == [("fs1", "fs1.dat", "robot.xyz")]


def test_folders_are_paired_by_equal_names_and_other_files_are_passed_over(tmp_path: Path) -> None:
    touched(tmp_path, "left/000.png", "left/001.jpg", "left/times.txt", "right/000.png", "right/001.tiff")
    found = image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))
    assert names(found) == [("000", "000.png", "000.png"), ("001", "001.jpg", "001.tiff")]


@pytest.mark.parametrize(
    ("left", "right", "name"),
    [
        ("garden01_left.jpg", "garden01_right.jpg", "garden01"),
        ("left_0007.png", "right_0007.png", "0007"),
        ("L-12.png", "R-12.png", "12"),
        ("frame3l.png", "frame3r.png", "frame3"),
        ("cam0_17.png", "cam1_17.png", "17"),
        ("Image_02 x.png", "image_03 x.png", "x"),
        ("Left.png", "Right.png", "Left"),
    ],
)
def test_words_for_the_camera_are_no_part_of_a_pairs_name(
    tmp_path: Path, left: str, right: str, name: str
) -> None:
    touched(tmp_path, f"a/{left}", f"b/{right}", "a/same.png", "b/same.png")
    found = image_pairs(str(tmp_path / "a" / "*"), str(tmp_path / "b" / "*"))
    assert sorted(names(found)) == sorted([(name, left, right), ("same", "same.png", "same.png")])


@pytest.mark.parametrize("stem", ["flower", "bright", "lamp_post", "collar"])
def test_letters_within_a_word_say_nothing_of_a_camera(tmp_path: Path, stem: str) -> None:
    touched(tmp_path, f"left/{stem}.png", f"right/{stem}.png", "left/x.png", "right/x.png")
    assert names(image_pairs(str(tmp_path / "left"), str(tmp_path / "right")))[0][0] == stem


def test_one_folder_may_hold_both_sides(tmp_path: Path) -> None:
    touched(tmp_path, *(f"{scene}_{side}.png" for scene in ("a", "b") for side in ("left", "right")))
    found = image_pairs(str(tmp_path / "*_left.png"), str(tmp_path / "*_right.png"))
    assert names(found) == [("a", "a_left.png", "a_right.png"), ("b", "b_left.png", "b_right.png")]


def test_names_that_do_not_correspond_at_all_are_paired_in_order_and_that_is_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    touched(tmp_path, "left/10.01.png", "left/10.09.png", "right/10.02.png", "right/10.10.png")
    with caplog.at_level(logging.WARNING):
        found = image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))
    assert [pair.right.name for pair in found] == ["10.02.png", "10.10.png"]
    assert "paired in their order" in caplog.text


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (("left/1.png", "left/2.png", "right/1.png"), "2.png: has no partner"),
        (("left/1.png", "right/1.png", "right/2.png", "right/3.png"), "nor have 1 more files"),
        (("left/a.png", "left/a.jpg", "right/a.png", "right/b.png"), "cannot be told from"),
        (("left/1.png", "right/readme.txt"), "holds no right image"),
    ],
)
def test_what_has_no_partner_is_refused_by_name(tmp_path: Path, files: tuple[str, ...], message: str) -> None:
    touched(tmp_path, *files)
    with pytest.raises(InvalidInput, match=message):
        image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))
