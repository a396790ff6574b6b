"""Images pair up by a side in their names, and where two pairings are possible neither is taken."""

from __future__ import annotations

from pathlib import Path

import pytest

from rectbench.pairs.finding.names import paired_files, paired_folders

ROOT = Path("/data")


def paired(*names: str) -> dict[str, tuple[str, str]]:
    """Pairs by name: the left and the right file below the root."""
    pairing = paired_files([ROOT / name for name in names], ROOT)
    listed = [file for pair in pairing.pairs for file in (pair.left, pair.right)]
    assert sorted([*listed, *(out.path for out in pairing.left_out)]) == sorted(ROOT / name for name in names)
    return {
        pair.name: (str(pair.left.relative_to(ROOT)), str(pair.right.relative_to(ROOT)))
        for pair in pairing.pairs
    }


@pytest.mark.parametrize(
    ("name", "left", "right"),
    [
        ("01", "left01.jpg", "right01.jpg"),
        ("garden01", "garden01_left.jpg", "garden01_right.jpg"),
        ("fisheye-img0", "left_fisheye_img_0.png", "right_fisheye_img_0.png"),
        ("x", "x_l.png", "x_r.png"),
        ("img0001", "imgL0001.png", "imgR0001.png"),
        ("7", "leftImg8bit/7.png", "rightImg8bit/7.png"),
        ("fs", "fs1.png", "fs2.png"),
        ("im", "im0.png", "im1.png"),
        ("17", "cam0/data/17.png", "cam1/data/17.png"),
        ("image0001", "cam0/image_0001.png", "cam1/image_0001.png"),
        ("0", "image_02/data/0.png", "image_03/data/0.png"),
        ("b", "left/left_b.png", "right/right_b.png"),
        ("1", "right_wing/left/1.png", "right_wing/right/1.png"),
        ("", "LEFT.PNG", "right.png"),
    ],
)
def test_the_usual_names_pair_up(name: str, left: str, right: str) -> None:
    assert paired(right, left) == {name: (left, right)}


def test_a_sequence_of_one_camera_is_no_pair_nor_are_three_cameras() -> None:
    assert paired("img1.png", "img2.png", "img3.png") == {}
    assert paired("img3.png", "img4.png", "img5.png") == {}
    assert paired("20240101.png", "20240102.png") == {}
    assert paired("cam0/1.png", "cam1/1.png", "cam2/1.png") == {}
    assert paired("left.png", "left.jpg", "right.bmp") == {}


def test_pairs_of_a_sequence_are_told_by_their_side_not_their_number() -> None:
    names = [f"cam{side}/image_{i:04}.png" for i in range(4) for side in (0, 1)]
    assert len(paired(*names)) == 4
    assert len(paired(*(f"{side}{i}.png" for i in range(4) for side in ("left", "right")))) == 4


def test_what_is_left_out_says_why() -> None:
    pairing = paired_files([ROOT / name for name in ("im1.png", "im2.png", "im3.png", "map.png")], ROOT)
    reasons = {out.path.name: out.reason for out in pairing.left_out}
    assert "more than one pair is possible" in reasons["im2.png"]
    assert "data/im1.png, data/im3.png" in reasons["im2.png"]
    assert reasons["map.png"] == "no other image's name differs from its own in the side alone"


def test_two_folders_pair_by_equal_names_or_by_their_sides() -> None:
    left, right = Path("/a"), Path("/b/deep")
    files_left = [left / "1.png", left / "x_left.png", left / "lonely.png"]
    files_right = [right / "1.png", right / "x_right.png"]
    pairing = paired_folders(left, right, files_left, files_right)
    assert [(p.left.name, p.right.name) for p in pairing.pairs] == [
        ("1.png", "1.png"),
        ("x_left.png", "x_right.png"),
    ]
    assert [out.path for out in pairing.left_out] == [left / "lonely.png"]
