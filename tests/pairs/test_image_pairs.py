"""Images are paired by their names, and what has no partner is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from rectbench.errors import InvalidInput
from rectbench.pairs.finding.image_pairs import image_pairs, masks_beside
from rectbench.pairs.finding.names import Pairing


def touched(folder: Path, *names: str) -> Path:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    return folder


def names(pairing: Pairing) -> list[tuple[str, str, str]]:
    return [(pair.name, pair.left.name, pair.right.name) for pair in pairing.pairs]


def test_two_files_are_a_pair_whatever_they_are_called(tmp_path: Path) -> None:
    touched(tmp_path, "fs1.dat", "robot.xyz")
    found = image_pairs(str(tmp_path / "fs1.dat"), str(tmp_path / "robot.xyz"))
    assert names(found) == [("fs1", "fs1.dat", "robot.xyz")]


def test_folders_are_paired_by_equal_names_and_other_files_are_passed_over(tmp_path: Path) -> None:
    touched(tmp_path, "west/000.png", "west/001.jpg", "west/times.txt", "east/000.png", "east/001.jpg")
    found = image_pairs(str(tmp_path / "west"), str(tmp_path / "east"))
    assert names(found) == [("000", "000.png", "000.png"), ("001", "001.jpg", "001.jpg")]
    assert found.left_out == ()


def test_one_folder_may_hold_both_sides(tmp_path: Path) -> None:
    touched(tmp_path, *(f"{scene}_{side}.png" for scene in ("a", "b") for side in ("left", "right")))
    found = image_pairs(str(tmp_path / "*_left.png"), str(tmp_path / "*_right.png"))
    assert names(found) == [("a", "a_left.png", "a_right.png"), ("b", "b_left.png", "b_right.png")]


def test_a_file_whose_name_looks_like_a_pattern_is_a_file(tmp_path: Path) -> None:
    touched(tmp_path, "shot[1].png", "shot[2].png")
    found = image_pairs(str(tmp_path / "shot[1].png"), str(tmp_path / "shot[2].png"))
    assert names(found) == [("shot[1]", "shot[1].png", "shot[2].png")]


def test_pairs_below_several_folders_have_names_of_their_own(tmp_path: Path) -> None:
    touched(tmp_path, *(f"{day}/{side}/1.png" for day in ("mon", "tue") for side in ("left", "right")))
    found = image_pairs(str(tmp_path / "*/left/*.png"), str(tmp_path / "*/right/*.png"))
    assert len({name for name, _, _ in names(found)}) == 2


def test_masks_are_no_images_of_a_pair_but_where_they_are_named(tmp_path: Path) -> None:
    touched(tmp_path, "left/1.png", "left/mask.png", "right/1.png", "right/mask.png", "fisheye_mask.png")
    for words in (("left", "right"), ("left/*.png", "right/*.png")):
        found = image_pairs(*(str(tmp_path / word) for word in words))
        assert names(found) == [("1", "1.png", "1.png")]
        assert found.left_out == ()
    assert len(image_pairs(str(tmp_path / "left/mask.png"), str(tmp_path / "right/mask.png")).pairs) == 1
    (tmp_path / "left/1.png").unlink()
    with pytest.raises(InvalidInput, match="holds no left image"):
        image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))


def test_masks_are_sought_beside_the_images_and_the_calibration(tmp_path: Path) -> None:
    calibrations = ("calib/rig.yaml", "calib/lens_mask.png", "calib/below/mask.png")
    touched(tmp_path, "left/1.png", "left/mask.png", "right/1.png", "right/masked.png", *calibrations)
    found = image_pairs(str(tmp_path / "left/1.png"), str(tmp_path / "right/1.png"))
    for calibration in ("calib/rig.yaml", "calib"):
        masks = masks_beside(found.pairs, [tmp_path / calibration])
        assert [mask.name for mask in masks] == ["lens_mask.png", "mask.png"]
    assert [mask.name for mask in masks_beside(found.pairs, [tmp_path / "calib/gone"])] == ["mask.png"]


def test_an_image_without_a_partner_is_left_out_and_named(tmp_path: Path) -> None:
    touched(tmp_path, "left/1.png", "left/2.png", "right/1.png")
    found = image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))
    assert names(found) == [("1", "1.png", "1.png")]
    assert [out.path.name for out in found.left_out] == ["2.png"]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (("left/10.31.png", "right/10.32.png"), "are pairs by their names"),
        (("left/1.png", "right/readme.txt"), "holds no right image"),
    ],
)
def test_where_nothing_is_a_pair_the_reason_is_told(
    tmp_path: Path, files: tuple[str, ...], message: str
) -> None:
    touched(tmp_path, *files)
    with pytest.raises(InvalidInput, match=message):
        image_pairs(str(tmp_path / "left"), str(tmp_path / "right"))
