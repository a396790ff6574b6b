"""`rectbench rectify --rig CALIB` without images: all but the images, the same as with them."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench.warps import load_rectification
from tests.cli.test_cli_rectify import FILES
from tests.conftest import Shell
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import rig

RIG = rig("kannala-brandt", size=(320, 240))
WITHOUT_IMAGES = FILES - {"left.png", "right.png"}
NEEDS_IMAGES = """
import rectbench as rb


class Looking(rb.Rectifier):
    '''Looks at the images.'''

    name = "looking"
    needs = frozenset({"pose", "images"})

    def fit(self, problem, options):
        raise AssertionError(problem.images.left.shape)
"""


@pytest.fixture(autouse=True)
def given(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A working folder with a rig's file, and a method that looks at images."""
    monkeypatch.chdir(tmp_path)
    RIG.save("rig.yaml")
    Path("looking.py").write_text(NEEDS_IMAGES)


def written(folder: str) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in Path(folder).iterdir()}


@pytest.mark.parametrize(
    "words",
    [
        "-m local-homography",
        "-m abraham --fov 80x60 --focal source",
        "-m conventional --crop valid --size 300x200",
        "-m hartley",
        "-m best --coverage 0.9",
    ],
)
def test_all_but_the_images_is_written_and_is_the_same_as_with_images(shell: Shell, words: str) -> None:
    for side, image in zip(("left", "right"), pair_of(RIG), strict=True):
        cv2.imwrite(f"{side}.png", image)
    code, out, err = shell("rectify", "--rig", "rig.yaml", "-o", "alone", *words.split())
    assert (code, err) == (0, "")
    assert {Path(line).name for line in out.splitlines() if line.startswith("alone/")} == set(
        written("alone")
    )
    with_images = ("rectify", "left.png", "right.png", "--rig", "rig.yaml", "-o", "pair", "--measure", 0)
    assert shell(*with_images, *words.split())[0] == 0
    alone, pair = written("alone"), written("pair")
    assert pair.keys() - alone.keys() == {"left.png", "right.png"}
    differing = {name for name, content in alone.items() if content != pair[name]}
    assert differing == {"preview.png", "metrics.json"}
    numbers = [json.loads(files["metrics.json"]) for files in (alone, pair)]
    assert numbers[0]["frame"] == numbers[1]["frame"]
    assert (numbers[0]["rows"], numbers[0]["pairs"]) == ({}, [])


def test_a_rig_s_name_and_its_files_will_do_and_tables_are_those_of_python(shell: Shell) -> None:
    assert shell("rectify", "--rig", "mynteye", "-o", "out", "--tables", "npz", "-m", "hartley")[0] == 0
    assert set(written("out")) == WITHOUT_IMAGES - {"maps.yml.gz", "maps_fixed.yml.gz"}
    maps = np.load("out/maps.npz")
    for side in ("left", "right"):
        expected = rb.rectify(rb.load_rig("mynteye"), "hartley").maps(side)  # type: ignore[arg-type]
        for axis, table in zip("xy", expected, strict=True):
            np.testing.assert_array_equal(maps[f"map_{axis}_{side}"], table)


def test_python_writes_the_same_files(shell: Shell) -> None:
    framing = rb.Framing(coverage=0.9, pixels=3e4)
    made = rb.write_tables("rig.yaml", "python", method="best", framing=framing)
    words = ("-m", "best", "--coverage", 0.9, "--pixels", 3e4)
    assert shell("rectify", "--rig", "rig.yaml", "-o", "shell", *words)[0] == 0
    assert written("python") == written("shell")
    assert made.pairs == made.left_out == ()
    assert made.choice is not None


def test_a_size_that_the_calibration_leaves_out_is_asked_for_and_taken(shell: Shell) -> None:
    file = cv2.FileStorage("stereo.yml", cv2.FILE_STORAGE_WRITE)
    K = np.array([[200.0, 0, 159.5], [0, 200, 119.5], [0, 0, 1]])
    for name, value in {"M1": K, "D1": np.zeros((1, 5)), "M2": K, "D2": np.zeros((1, 5))}.items():
        file.write(name, value)
    file.write("R", np.eye(3))
    file.write("T", np.array([[-0.1], [0.0], [0.0]]))
    file.release()
    code, out, err = shell("rectify", "--rig", "stereo.yml", "-o", "out", "--size", "100x80")
    assert (code, out) == (2, "")
    assert "or `--image-size` beside the file" in err
    assert not Path("out").exists()
    with pytest.raises(rb.InvalidInput, match="or `image_size` beside the file"):
        rb.write_tables("stereo.yml", "out")
    words = ("--image-size", "320x240", "--size", "100x80", "-m", "conventional")
    assert shell("rectify", "--rig", "stereo.yml", "-o", "out", *words)[0] == 0
    rect = load_rectification("out/rectified.yaml")
    assert (rect.rig.left.size, rect.size) == ((320, 240), (100, 80))
    code, _, err = shell("rectify", "--rig", "rig.yaml", "-o", "other", "--image-size", "640x480")
    assert code == 2
    assert len(err.splitlines()) == 1
    assert "640" in err


def test_nothing_of_an_earlier_rectification_is_left_beside_the_new_tables(shell: Shell) -> None:
    assert shell("rectify", "--rig", "rig.yaml", "-o", "out", "-m", "conventional")[0] == 0
    assert "opencv.yml" in written("out")
    assert shell("rectify", "--rig", "rig.yaml", "-o", "out", "--tables", "none")[0] == 0
    assert set(written("out")) == {name for name in WITHOUT_IMAGES if not name.startswith("maps")}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "there are no images and no calibration; expected LEFT and RIGHT, or --rig"),
        ("-m hartley", "there are no images and no calibration"),
        ("a.png", "one image was given, a.png; expected LEFT and RIGHT, or none and a calibration as --rig"),
        ("a.png --rig rig.yaml", "one image was given, a.png; expected LEFT and RIGHT"),
        (
            "--rig rig.yaml --antialias",
            "--antialias is given without images; expected LEFT and RIGHT beside it",
        ),
        (
            "a b --rig rig.yaml --image-size 9x9",
            "images tell their size themselves; expected no --image-size",
        ),
        ("--rig rig.yaml --image-size 9", "--image-size is 9; expected width and height such as 1280x800"),
        ("--rig rig.yaml -m looking.py", "looking works from images, and there are none"),
        ("--rig rig.yaml -m abrahm", "unknown method 'abrahm'"),
        ("--rig rig.yaml --fov 170x200", "does not reach 170x200°; expected a smaller --fov"),
        ("--rig rig.yaml --tables npy", "unknown kind of tables 'npy'"),
        ("--rig gone.yaml", "gone.yaml"),
        ("--rig rig.yaml --max-angle-deg 0", "--max-angle-deg is 0.0; expected an angle above 0"),
    ],
)
def test_wrong_usage_is_one_line_and_writes_nothing(shell: Shell, words: str, message: str) -> None:
    code, out, err = shell("rectify", "-o", "out", *words.split())
    assert (code, out) == (2, "")
    assert err.startswith("rectbench: ")
    assert len(err.splitlines()) == 1
    assert message in err
    assert not Path("out").exists()


def test_a_method_that_looks_at_images_is_told_apart_where_the_best_is_sought() -> None:
    """It is no candidate, and keeps no other from being one."""
    choice = rb.best_method(RIG, methods=["looking.py", "abraham"])
    by_method = choice.table.set_index("method")
    assert by_method.loc["looking", "status"] == "unsupported"
    assert by_method.loc["looking", "reason"] == "looking works from images, and there are none"
    with pytest.raises(rb.Unsupported, match="looking works from images"):
        rb.rectify(RIG, "looking.py")
