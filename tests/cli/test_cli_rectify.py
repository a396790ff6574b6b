"""`rectbench rectify`: images of one's own become rectified ones, tables, and numbers that can be checked."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

import rectbench as rb
from rectbench.plugins.defaults import CONTENDERS
from rectbench.warps import load_rectification
from tests.conftest import Shell
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import rig

RIG = rig("kannala-brandt", size=(320, 240))
FILES = {
    "rectified.yaml",
    "left_mask.png",
    "right_mask.png",
    "maps.npz",
    "maps.yml.gz",
    "maps_fixed.yml.gz",
    "preview.png",
    "left.png",
    "right.png",
    "metrics.json",
}


@pytest.fixture(scope="module")
def photographed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a rig's file and three pairs of its images."""
    folder = tmp_path_factory.mktemp("photographed")
    RIG.save(folder / "rig.yaml")
    for seed in range(3):
        for side, image in zip("lr", pair_of(RIG, seed), strict=True):
            (folder / side).mkdir(exist_ok=True)
            cv2.imwrite(str(folder / side / f"{seed}_{side}.png"), image)
    return folder


@pytest.fixture(autouse=True)
def given(photographed: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A copy of it, as the working folder."""
    shutil.copytree(photographed, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)


def read(path: str) -> np.ndarray:
    image = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    assert image is not None
    return image


def test_a_pair_becomes_images_masks_tables_and_numbers(shell: Shell) -> None:
    code, out, err = shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out")
    assert (code, err) == (0, "")
    assert {file.name for file in Path("out").iterdir()} == FILES
    assert {Path(line).name for line in out.splitlines() if line.startswith("out/")} == FILES
    assert "source pixels kept" in out
    assert "rows, features" in out

    rect = load_rectification("out/rectified.yaml")
    maps = np.load("out/maps.npz", allow_pickle=False)
    for side in ("left", "right"):
        ours = rect.maps(side)  # type: ignore[arg-type]
        np.testing.assert_array_equal(maps[f"map_x_{side}"], ours[0])
        np.testing.assert_array_equal(maps[f"map_y_{side}"], ours[1])
        mask = read(f"out/{side}_mask.png")
        np.testing.assert_array_equal(mask > 0, rect.valid(side))  # type: ignore[arg-type]
        assert set(np.unique(mask)) <= {0, 255}
    metrics = json.loads(Path("out/metrics.json").read_text())
    assert metrics["method"] == "local-homography"
    assert metrics["frame"]["coverage_pixels"] == 1.0
    assert metrics["rows"]["row_error_features_median_px"] < 0.2


def test_the_tables_run_in_a_plain_opencv_program(shell: Shell) -> None:
    assert (
        shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out", "--measure", 0)[0] == 0
    )
    for side in ("left", "right"):
        source, rectified = read(f"{side[0]}/0_{side[0]}.png"), read(f"out/{side}.png")
        storage = cv2.FileStorage("out/maps.yml.gz", cv2.FILE_STORAGE_READ)
        map_x, map_y = (storage.getNode(f"map_{axis}_{side}").mat() for axis in "xy")
        np.testing.assert_array_equal(cv2.remap(source, map_x, map_y, cv2.INTER_LINEAR), rectified)
        fixed = cv2.FileStorage("out/maps_fixed.yml.gz", cv2.FILE_STORAGE_READ)
        map1, map2 = (fixed.getNode(f"map{i}_{side}").mat() for i in (1, 2))
        assert (map1.dtype, map2.dtype) == (np.int16, np.uint16)
        coarse = cv2.remap(source, map1, map2, cv2.INTER_LINEAR)
        # Positions to 1/32 px: a grey level or two where the image is steep.
        assert np.abs(coarse.astype(int) - rectified).mean() < 0.6


def test_a_perspective_pair_has_opencvs_matrices(shell: Shell) -> None:
    words = ["-m", "conventional", "--fov", "90x70", "--size", "400x300"]
    assert (
        shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out", "--measure", 0, *words)[
            0
        ]
        == 0
    )
    storage = cv2.FileStorage("out/opencv.yml", cv2.FILE_STORAGE_READ)
    P1, R1 = storage.getNode("P1").mat(), storage.getNode("R1").mat()
    assert (storage.getNode("image_width").real(), storage.getNode("image_height").real()) == (400, 300)
    p = RIG.left.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
    D = np.array([p[f"k{i}"] for i in range(1, 5)])
    theirs = cv2.fisheye.initUndistortRectifyMap(K, D, R1, P1[:, :3], (400, 300), cv2.CV_32FC1)
    ours, shown = np.load("out/maps.npz"), read("out/left_mask.png") > 0
    np.testing.assert_allclose(ours["map_x_left"][shown], theirs[0][shown], atol=2e-3)
    assert "opencv: opencv.yml" in Path("out/rectified.yaml").read_text()


def test_what_opencv_has_no_form_for_says_so(shell: Shell) -> None:
    assert (
        shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out", "--measure", 0)[0] == 0
    )
    assert not Path("out/opencv.yml").exists()
    described = yaml.safe_load(Path("out/rectified.yaml").read_text())
    assert "no perspective" in described["opencv"]


@pytest.mark.parametrize("words", [("l", "r"), ("l/*.png", "r/*.png")])
def test_folders_and_patterns_are_many_pairs_of_one_rig(shell: Shell, words: tuple[str, str]) -> None:
    code, _, err = shell("rectify", *words, "--rig", "rig.yaml", "-o", "out", "--measure", 2)
    assert (code, err) == (0, "")
    for side in ("left", "right"):
        assert {file.name for file in Path("out", side).iterdir()} == {f"{i}.png" for i in range(3)}
    rows = list(csv.DictReader(Path("out/pairs.csv").read_text().splitlines()))
    assert [row["pair"] for row in rows] == ["0", "1", "2"]
    assert [bool(row["row_error_features_mean_px"]) for row in rows] == [True, False, True]
    one = shell("rectify", "l/1_l.png", "r/1_r.png", "--rig", "rig.yaml", "-o", "one", "--tables", "none")
    assert one[0] == 0
    assert Path("one/left.png").read_bytes() == Path("out/left/1.png").read_bytes()
    assert not list(Path("one").glob("maps*"))


def test_an_unreadable_image_is_named_skipped_and_ends_in_3(shell: Shell) -> None:
    Path("l/1_l.png").write_bytes(b"no image")
    cv2.imwrite("r/2_r.png", np.zeros((10, 12), np.uint8))
    code, out, err = shell("rectify", "l", "r", "--rig", "rig.yaml", "-o", "out")
    assert code == 3
    assert "left out: l/1_l.png: not an image that OpenCV can read" in out
    assert "left out: r/2_r.png: is 12x10 px; expected 320x240" in out
    assert err == ""
    assert [file.name for file in Path("out/left").iterdir()] == ["0.png"]
    rows = list(csv.DictReader(Path("out/pairs.csv").read_text().splitlines()))
    assert [row["status"] for row in rows] == ["ok", "left out", "left out"]


@pytest.mark.parametrize(
    ("dtype", "channels", "suffix"),
    [
        ("uint8", 3, ".png"),
        ("uint16", 1, ".png"),
        ("uint16", 3, ".png"),
        ("uint8", 4, ".png"),
        ("float32", 1, ".tiff"),
        ("int16", 1, ".tiff"),
        ("float64", 3, ".tiff"),
    ],
)
def test_depth_and_channels_stay_what_they_are(shell: Shell, dtype: str, channels: int, suffix: str) -> None:
    rng = np.random.default_rng(0)
    shape = (240, 320, channels) if channels > 1 else (240, 320)
    image = (rng.uniform(0, 200, shape) * (100 if dtype != "uint8" else 1)).astype(dtype)
    for side in ("left", "right"):
        assert cv2.imwrite(side + suffix, image)
    words = ("rectify", f"left{suffix}", f"right{suffix}", "--rig", "rig.yaml", "-o", "out", "--measure", 0)
    assert shell(*words)[0] == 0
    rectified = read(f"out/left{suffix}")
    assert (rectified.dtype, rectified.ndim) == (image.dtype, image.ndim)
    maps = np.load("out/maps.npz")
    expected = cv2.remap(image, maps["map_x_left"], maps["map_y_left"], cv2.INTER_LINEAR)
    np.testing.assert_array_equal(rectified, expected)


def test_the_best_method_is_chosen_and_the_choice_explained(shell: Shell) -> None:
    words = ("--rig", "rig.yaml", "-o", "out", "-m", "best", "--coverage", 0.8)
    code, out, _ = shell("rectify", "l/0_l.png", "r/0_r.png", *words)
    assert code == 0
    assert "has the least log distortion" in out
    metrics = json.loads(Path("out/metrics.json").read_text())
    rectify = [row for row in metrics["choice"]["methods"] if not row["reason"]]
    by_method = {row["method"]: row["log_distortion_kept"] for row in rectify}
    assert set(by_method) == set(CONTENDERS)
    assert metrics["method"] == min(by_method, key=by_method.__getitem__)
    assert metrics["frame"]["coverage_pixels"] == pytest.approx(0.8, abs=0.01)
    assert yaml.safe_load(Path("out/rectified.yaml").read_text())["method"] == metrics["method"]


def test_without_a_calibration_rows_agree_all_the_same(shell: Shell) -> None:
    pinhole = rb.Camera("pinhole", (480, 360), {"fx": 400, "fy": 400, "cx": 240, "cy": 181})
    other = rb.Rig(pinhole, pinhole, RIG.R_right_left, RIG.t_right_left)
    for side, image in zip(("left", "right"), pair_of(other, 1), strict=True):
        cv2.imwrite(f"{side}.png", image)
    for method in ("hartley", "fusiello", "best"):
        code, out, err = shell("rectify", "left.png", "right.png", "-o", method, "-m", method)
        assert (code, err) == (0, ""), out
        rows = json.loads(Path(method, "metrics.json").read_text())["rows"]
        assert rows["row_error_features_median_px"] < 0.4


def test_the_frame_that_is_asked_for_stands_beside_the_methods_own(shell: Shell) -> None:
    words = ["--crop", "valid", "--pixels", 20000, "--measure", 0]
    code, out, _ = shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out", *words)
    assert code == 0
    assert "the method's own frame" in out
    assert (read("out/left_mask.png") > 0).all()
    assert 19000 < read("out/left.png").size < 21000
    metrics = json.loads(Path("out/metrics.json").read_text())
    assert metrics["frame_of_the_method"]["coverage_pixels"] == 1.0
    assert metrics["frame"]["coverage_pixels"] < 0.9


def test_antialiasing_changes_what_shrinks_and_says_how_much(shell: Shell) -> None:
    words = ("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "--size", "100x60", "--measure", 0)
    assert shell(*words, "-o", "plain")[0] == 0
    code, out, _ = shell(*words, "-o", "smooth", "--antialias")
    assert code == 0
    assert "averaged over several source pixels" in out
    metrics = json.loads(Path("smooth/metrics.json").read_text())
    assert metrics["frame"]["averaged_share"] > 0.9
    assert metrics["frame"]["longest_footprint_px"] > 2
    plain, smooth = (read(f"{name}/left.png").astype(float) for name in ("plain", "smooth"))
    assert np.abs(np.diff(smooth)).mean() < 0.85 * np.abs(np.diff(plain)).mean()


def test_images_of_another_rig_are_told_by_their_rows(shell: Shell) -> None:
    turned = rb.Rig(
        RIG.left, RIG.right, RIG.R_right_left @ cv2.Rodrigues(np.array([0.08, 0.0, 0.0]))[0], RIG.t_right_left
    )
    turned.save("other.yaml")
    code, out, _ = shell("rectify", "l/0_l.png", "r/0_r.png", "--rig", "other.yaml", "-o", "out")
    assert code == 0
    assert "warning: rows are" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--rig rig.yaml -m abrahm", "unknown method 'abrahm'; did you mean abraham"),
        ("--rig rig.yaml --option law=flat", "unknown option of local-homography 'law'"),
        (
            "--rig rig.yaml -m best --option law=flat",
            "--option is given beside --method best; expected it beside a method by its name",
        ),
        ("--rig rig.yaml -m best --crop valid", "not in the crop valid; expected --coverage or --fov"),
        ("--rig rig.yaml --crop 1,2,3", "--crop is 1,2,3; expected valid, or x,y,width,height"),
        ("--rig rig.yaml --crop valid --coverage 0.5", "--crop and --coverage both say what is shown"),
        ("--rig rig.yaml --coverage 95", "--coverage is 95.0; expected a share"),
        ("--rig rig.yaml --fov wide", "--fov is wide; expected two angles such as 100x80"),
        ("--rig rig.yaml --fov 170x200", "does not reach 170x200°"),
        ("--rig rig.yaml --size 10", "--size is 10; expected width and height"),
        ("--rig rig.yaml --size 10.5x20", "--size is 10.5x20; expected whole pixels"),
        ("--rig rig.yaml --focal near", "--focal is near; expected a number of pixels, or source"),
        ("--rig rig.yaml --focal 99999", "megapixels"),
        ("--rig rig.yaml --tables npy", "unknown kind of tables 'npy'"),
        ("--rig t265", "l/0_l.png: is 320x240 px; expected 848x800"),
        ("-m local-homography", "local-homography needs a calibrated rig; expected one, or"),
    ],
)
def test_wrong_usage_is_one_line_and_writes_nothing(shell: Shell, words: str, message: str) -> None:
    code, out, err = shell("rectify", "l/0_l.png", "r/0_r.png", "-o", "out", *words.split())
    assert (code, out) == (2, "")
    assert err.startswith("rectbench: ")
    assert len(err.splitlines()) == 1
    assert message in err
    assert not Path("out").exists()


def test_nothing_of_another_rectification_stays_in_the_folder(shell: Shell) -> None:
    words = ("rectify", "l/0_l.png", "r/0_r.png", "--rig", "rig.yaml", "-o", "out", "--measure", 0)
    assert shell(*words, "-m", "conventional")[0] == 0
    assert Path("out/opencv.yml").exists()
    assert shell(*words, "--tables", "none")[0] == 0
    assert {file.name for file in Path("out").iterdir()} == FILES - {
        "maps.npz",
        "maps.yml.gz",
        "maps_fixed.yml.gz",
    }


def test_rows_that_nobody_could_measure_raise_no_alarm(shell: Shell) -> None:
    """The frame shows a corner of the image, in which no match lies in both."""
    words = ("--rig", "rig.yaml", "-o", "out", "--crop", "150,100,2,2")
    code, out, _ = shell("rectify", "l/0_l.png", "r/0_r.png", *words)
    assert code == 0
    assert "nan px" not in out
    assert "warning" not in out


def test_photographs_are_never_written_over(shell: Shell) -> None:
    for words in (("l/0_l.png", "r/0_r.png"), ("l", "r")):
        shutil.rmtree("left", ignore_errors=True)
        shutil.rmtree("right", ignore_errors=True)
        single = "." in words[0]
        for side, name in zip(("left", "right"), words, strict=True):
            shutil.copy(name, f"{side}.png") if single else shutil.copytree(name, side)
            for file in Path(side).glob("*_*.png"):
                file.rename(Path(side) / f"{file.stem[0]}.png")
        given = ("left.png", "right.png") if single else ("left", "right")
        code, _, err = shell("rectify", *given, "--rig", "rig.yaml", "-o", ".")
        assert code == 2
        assert "would be overwritten" in err
        assert not Path("rectified.yaml").exists()


def test_of_many_cameras_none_is_guessed(shell: Shell) -> None:
    RIG.save("chain.yaml", format="kalibr")
    for number, side in ((2, "l"), (3, "r")):
        shutil.copytree(side, f"image_0{number}")
        for file in Path(f"image_0{number}").iterdir():
            file.rename(file.with_name(f"{file.stem[0]}.png"))
    given = ("rectify", "image_02", "image_03", "--rig", "chain.yaml", "-o", "out", "--measure", 0)
    code, _, err = shell(*given)
    assert code == 2
    assert "is of camera 2" in err
    assert not Path("out").exists()
    assert shell(*given, "--cameras", "cam0,cam1")[0] == 0


def test_two_cameras_may_differ_in_size(shell: Shell) -> None:
    other = rb.Rig(RIG.left.scaled(0.5), RIG.right, RIG.R_right_left, RIG.t_right_left)
    other.save("mixed.yaml", format="kalibr")
    cv2.imwrite("half.png", cv2.resize(read("l/0_l.png"), (160, 120), interpolation=cv2.INTER_AREA))
    code, out, err = shell("rectify", "half.png", "r/0_r.png", "--rig", "mixed.yaml", "-o", "out")
    assert (code, err) == (0, "")
    assert json.loads(Path("out/metrics.json").read_text())["rows"]["row_error_features_median_px"] < 0.3
    assert "warning" not in out


def test_the_same_command_writes_the_same_bytes(shell: Shell) -> None:
    for out in ("a", "b"):
        words = ("--rig", "rig.yaml", "-m", "best", "--measure", 1, "--tables", "fixed")
        assert shell("rectify", "l", "r", *words, "-o", out)[0] == 0
    for file in sorted(Path("a").rglob("*.*")):
        assert file.read_bytes() == (Path("b") / file.relative_to("a")).read_bytes(), file
