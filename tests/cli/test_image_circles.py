"""Verbs with two images hold the lenses to the image circle that a mask or the black rim shows."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import rectbench as rb
from rectbench.warps import load_rectification
from tests.conftest import Shell
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import rig

RIG = rig("equidistant", size=(300, 300), fov_deg=200)
"""Sees its epipoles, as its calibration has it,"""
RIM_DEG, MASK_DEG = 78, 72
"""and shows nothing there."""
RIM = (
    f"image circle: the lenses are taken to show nothing beyond {RIM_DEG}° from their axes, by the black rim"
)


@pytest.fixture(scope="module")
def photographed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a rig's file and two pairs of its images, with black rims."""
    folder = tmp_path_factory.mktemp("photographed")
    RIG.save(folder / "rig.yaml", format="kalibr")  # which holds no image circle
    for seed in range(2):
        for side, image in zip("lr", pair_of(RIG.within(RIM_DEG), seed), strict=True):
            (folder / side).mkdir(exist_ok=True)
            cv2.imwrite(str(folder / side / f"{seed}.png"), image)
    return folder


@pytest.fixture(autouse=True)
def given(photographed: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A copy of it, as the working folder."""
    shutil.copytree(photographed, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)


def write_mask(name: str) -> None:
    rays, _ = RIG.left.unproject(RIG.left.pixel_grid())
    within = np.degrees(np.arccos(np.clip(rays[..., 2], -1, 1))) < MASK_DEG
    cv2.imwrite(name, 255 * within.astype(np.uint8))


def angle_deg(folder: str) -> float:
    angle = load_rectification(Path(folder, "rectified.yaml")).rig.left.max_angle_deg
    assert angle is not None
    return angle


@pytest.mark.parametrize("words", [("l/0.png", "r/0.png"), ("l", "r"), ("l/*.png", "r/*.png")])
def test_the_black_rim_of_one_pair_and_of_many_is_found_and_told(
    shell: Shell, words: tuple[str, str]
) -> None:
    code, out, err = shell("rectify", *words, "--rig", "rig.yaml", "-o", "out", "--measure", 1)
    assert (code, err) == (0, "")
    assert out.startswith(RIM)
    assert angle_deg("out") == pytest.approx(RIM_DEG, abs=1)
    assert yaml.safe_load(Path("out/rectified.yaml").read_text())["image_circle"].endswith("of its images")
    metrics = json.loads(Path("out/metrics.json").read_text())
    assert metrics["image_circle"]["max_angle_deg"] == angle_deg("out")
    assert metrics["rows"]["row_error_features_median_px"] < 0.5


def test_several_images_count_at_once(shell: Shell) -> None:
    for side in ("l", "r"):
        cv2.imwrite(f"{side}/0.png", cv2.imread(f"{side}/0.png") // 8)  # a dark room tells no rim by itself
    words = ("--rig", "rig.yaml", "-o", "out", "--measure", 0, "--tables", "none")
    assert shell("rectify", "l", "r", *words)[1].startswith(RIM)


@pytest.mark.parametrize("place", ["mask.png", "l/lens-mask.png"])
def test_a_mask_is_no_image_and_goes_before_the_rim(shell: Shell, place: str) -> None:
    write_mask(place)
    code, out, err = shell("rectify", "l", "r", "--rig", "rig.yaml", "-o", "out", "--measure", 0)
    assert (code, err) == (0, "")
    assert f"by {Path(place).name}" in out.splitlines()[0]
    assert angle_deg("out") == pytest.approx(MASK_DEG, abs=1)
    assert {file.name for file in Path("out/left").iterdir()} == {"0.png", "1.png"}


def test_a_stated_circle_stands_and_nothing_is_told(shell: Shell) -> None:
    write_mask("mask.png")
    words = ("rectify", "l/0.png", "r/0.png", "--measure", 0, "-o", "out")
    code, out, _ = shell(*words, "--rig", "rig.yaml", "--max-angle-deg", 60)
    assert code == 0
    RIG.within(60.0).save("stated.yaml")
    assert shell(*words[:-1], "other", "--rig", "stated.yaml")[0] == 0
    assert angle_deg("out") == angle_deg("other") == 60
    assert "image circle" not in out
    assert "image_circle" not in Path("out/rectified.yaml").read_text()


def test_a_second_run_in_the_same_folder_finds_the_same(shell: Shell) -> None:
    """The masks that the first one wrote are those of its images, and none of the lens."""
    words = ("rectify", "l/0.png", "r/0.png", "--rig", "rig.yaml", "--size", "300x300", "--measure", 0)
    for _ in range(2):
        assert shell(*words, "-o", ".")[1].startswith(RIM)


def test_a_mask_of_a_lens_is_never_written_over(shell: Shell) -> None:
    for side in ("left", "right"):
        write_mask(f"{side}_mask.png")
    before = Path("left_mask.png").read_bytes()
    code, out, err = shell("rectify", "l/0.png", "r/0.png", "--rig", "rig.yaml", "-o", ".")
    assert (code, out) == (2, "")
    assert "left_mask.png would be overwritten; expected another folder than ." in err
    assert Path("left_mask.png").read_bytes() == before
    assert not Path("rectified.yaml").exists()


@pytest.mark.parametrize(
    "words", ["pose", "reconstruct --nearest-baselines 8 -o out", "uncertainty --rotation-deg 0.1 -o out"]
)
def test_the_other_verbs_with_two_images_find_and_tell_it_too(shell: Shell, words: str) -> None:
    verb, *more = words.split()
    code, out, _ = shell(verb, "l/0.png", "r/0.png", "--rig", "rig.yaml", *more)
    assert code == 0
    assert out.startswith(RIM)


def test_python_finds_and_keeps_it(tmp_path: Path) -> None:
    made = rb.rectify_images("l", "r", RIG, "out", tables=[], measured_pairs=0, progress=False)
    assert made.circle is not None
    assert made.circle.angle_deg == made.rectification.rig.left.max_angle_deg == pytest.approx(RIM_DEG, abs=1)


@pytest.mark.parametrize("method", ["local-homography", "best"])
@pytest.mark.parametrize(
    ("place", "words", "told"),
    [
        (
            "t265",
            "fs1.png fs2.png --rig calib_robot_fs.yml",
            "nothing beyond 80° from their axes, by mask.png",
        ),
        (
            "mynteye",
            "left_fisheye_img_0.png right_fisheye_img_0.png "
            "--rig left_sensor_fisheye.yaml --rig right_sensor_fisheye.yaml",
            "",
        ),
    ],
)
def test_real_pairs_rectify_as_they_come(
    shell: Shell,
    real_data: Path,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    place: str,
    words: str,
    told: str,
    method: str,
) -> None:
    monkeypatch.chdir(real_data / "pairs" / place)
    words_out = ("-o", tmp_path / "out", "-m", method, "--tables", "none")
    code, out, err = shell("rectify", *words.split(), *words_out)
    assert (code, err) == (0, "")
    assert (told in out.splitlines()[0]) if told else ("image circle" not in out)
    rows = json.loads((tmp_path / "out/metrics.json").read_text())["rows"]
    assert rows["row_error_features_median_px"] < 0.4
