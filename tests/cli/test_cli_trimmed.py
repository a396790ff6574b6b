"""Rigs that see their epipoles, on the command line."""

import json
from pathlib import Path

import cv2
import pytest

import rectbench as rb
from tests.conftest import Shell
from tests.matching.box_room import pair_of
from tests.rigs_for_tests import rig

FORWARD = rig("kannala-brandt", rotation_deg=(2, -3, 1), centre_m=(0.03, 0.01, 0.3), size=(320, 240))


@pytest.fixture
def pair(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The words that name a calibration and two images, in the working folder."""
    monkeypatch.chdir(tmp_path)
    FORWARD.save("rig.yaml")
    for name, image in zip(("l.png", "r.png"), pair_of(FORWARD, 0), strict=True):
        assert cv2.imwrite(name, image)
    return ["rectify", "--rig", "rig.yaml", "l.png", "r.png", "--tables", "none"]


def test_a_rig_that_sees_its_epipoles_is_rectified_without_a_flag(shell: Shell, pair: list[str]) -> None:
    code, out, _ = shell(*pair)
    assert code == 0
    frame = json.loads(Path("rectified/metrics.json").read_text())["frame"]
    assert 0 < frame["trimmed"] < 0.1
    assert frame["coverage_pixels"] == pytest.approx(1 - frame["trimmed"], abs=0.01)
    assert f"trimmed: {100 * frame['trimmed']:.2g} % of the source pixels, within 7° of the epipoles" in out


def test_the_margin_is_the_users(shell: Shell, pair: list[str]) -> None:
    code, out, _ = shell(*pair, "--margin-deg", "12")
    assert code == 0
    assert "within 12° of the epipoles" in out


def test_a_seam_is_wrapped_where_there_is_one(shell: Shell, pair: list[str]) -> None:
    assert shell(*pair, "-m", "abraham")[0] == 0
    cut = rb.load_rectification("rectified/rectified.yaml")
    assert shell(*pair, "-m", "abraham", "--seam", "wrap")[0] == 0
    wrapped = rb.load_rectification("rectified/rectified.yaml")
    assert wrapped.size[1] > 1.05 * cut.size[1]
    assert wrapped.size[0] == cut.size[0]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--margin-deg", "0"), "--margin-deg is 0.0; expected degrees above 0, at most 45"),
        (("--margin-deg", "nan"), "--margin-deg is nan; expected degrees above 0, at most 45"),
        (("--margin-deg", "50"), "--margin-deg is 50.0; expected degrees above 0, at most 45"),
        (("--seam", "wrap", "-m", "conventional"), "a perspective image has none"),
        (("--seam", "sewn"), "seam is 'sewn'"),
    ],
)
def test_what_cannot_be_is_one_line_and_leaves_nothing(
    shell: Shell, pair: list[str], words: tuple[str, ...], told: str
) -> None:
    code, out, err = shell(*pair, *words)
    assert (code, out) == (2, "")
    assert told in err
    assert len(err.strip().splitlines()) == 1
    assert not Path("rectified").exists()


@pytest.mark.parametrize("verb", [("run", "quick"), ("export", "street", "t265")])
def test_other_verbs_refuse_a_margin_out_of_range_too(shell: Shell, verb: tuple[str, ...]) -> None:
    code, _, err = shell(*verb, "--margin-deg", "-3")
    assert code == 2
    assert "--margin-deg is -3.0; expected degrees above 0, at most 45" in err


def test_a_pair_given_right_camera_first_is_told_of_its_disparities(shell: Shell, pair: list[str]) -> None:
    rig("kannala-brandt", centre_m=(-0.3, 0.0, 0.0), size=(320, 240)).save("rig.yaml")
    _, out, _ = shell(*pair)
    assert "disparities are negative" in out
