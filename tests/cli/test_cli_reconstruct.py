"""`rectbench reconstruct`: what it writes, and how it refuses."""

from __future__ import annotations

import inspect
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh

import rectbench as rb
from rectbench.cli import photographs
from tests.conftest import Shell
from tests.matching.sphere_room import CENTRE_BASELINES, RADIUS_BASELINES, sphere_pair
from tests.rigs_for_tests import rig

FILES = {"cloud.ply", "depth.npz", "depth_mm.png", "left.png", "picture.png"}
ROOM = rig("kannala-brandt", size=(200, 140))


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def given(tmp_path: Path) -> tuple[object, ...]:
    """The words that name a rig and its two images, on disk."""
    sphere_pair(ROOM).save(tmp_path)
    ROOM.save(tmp_path / "rig.yaml")
    return "reconstruct", "left.png", "right.png", "--rig", "rig.yaml"


@pytest.mark.parametrize("words", ["", "-m conventional --option focal=fov --option fov_deg=90 --matcher bm"])
def test_a_pair_becomes_a_cloud_depth_and_a_picture(
    shell: Shell, given: tuple[object, ...], tmp_path: Path, words: str
) -> None:
    code, out, err = shell(*given, "-o", "out", *words.split())
    assert (code, err) == (0, "")
    assert {Path(line).name for line in out.split()} == FILES == {f.name for f in Path("out").iterdir()}
    cloud = trimesh.load(tmp_path / "out" / "cloud.ply")
    from_centre = np.linalg.norm(cloud.vertices - CENTRE_BASELINES * ROOM.baseline_m, axis=1)
    assert np.median(np.abs(from_centre / (RADIUS_BASELINES * ROOM.baseline_m) - 1)) < 0.04

    arrays = np.load(tmp_path / "out" / "depth.npz", allow_pickle=False)
    depth = arrays["depth_m"]
    assert depth.dtype == arrays["disparity_px"].dtype == np.float32
    assert np.isfinite(depth).sum() == len(cloud.vertices)
    millimetres = cv2.imread("out/depth_mm.png", cv2.IMREAD_UNCHANGED)
    assert millimetres.dtype == np.uint16
    np.testing.assert_allclose(millimetres, np.nan_to_num(depth) * 1000, atol=0.51)
    assert cv2.imread("out/left.png").shape[:2] == depth.shape
    assert min(cv2.imread("out/picture.png").shape[:2]) > 500


def test_depth_beyond_what_16_bits_hold_is_none(
    shell: Shell, given: tuple[object, ...], tmp_path: Path
) -> None:
    far = rb.Rig(ROOM.left, ROOM.right, ROOM.R_right_left, ROOM.t_right_left * 40, name="far")
    far.save(tmp_path / "rig.yaml")
    assert shell(*given, "-o", "out")[0] == 0
    depth = np.load(tmp_path / "out" / "depth.npz")["depth_m"]
    millimetres = cv2.imread("out/depth_mm.png", cv2.IMREAD_UNCHANGED)
    assert (depth > 65.6).any()
    assert (millimetres[depth > 65.6] == 0).all()
    np.testing.assert_allclose(millimetres[depth < 65.5], depth[depth < 65.5] * 1000, atol=0.51)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--matcher sgmb", "unknown matcher 'sgmb'; did you mean"),
        ("-m abrahm", "unknown method 'abrahm'; did you mean abraham"),
        ("--option alpha=1", "unknown option of local-homography 'alpha'"),
        ("--rig t265", "expected 848x800"),
        ("--rig absent.yaml", "absent.yaml"),
        ("--nearest-baselines 0", "--nearest-baselines is 0"),
        ("--pixels -5", "pixels is -5"),
    ],
)
def test_wrong_usage_is_one_line_and_writes_nothing(
    shell: Shell, given: tuple[object, ...], words: str, message: str
) -> None:
    images = given[: given.index("--rig")]
    code, out, err = shell(*(images if "--rig" in words else given), "-o", "out", *words.split())
    assert (code, out) == (2, "")
    assert err.startswith("rectbench: ")
    assert len(err.splitlines()) == 1
    assert message in err
    assert not Path("out").exists()


def test_a_pair_that_shares_nothing_is_one_line(shell: Shell, tmp_path: Path) -> None:
    narrow = rb.Camera("pinhole", (120, 80), {"fx": 200, "fy": 200, "cx": 59.5, "cy": 39.5})
    R = cv2.Rodrigues(np.array([0, np.pi / 3, 0]))[0]
    rb.Rig(narrow, narrow, R, np.array([-0.1, 0, 0])).save(tmp_path / "rig.yaml")
    noise = np.random.default_rng(0).integers(0, 255, (2, 80, 120, 3), np.uint8)
    rb.StereoPair(*noise).save(tmp_path)
    code, _, err = shell("reconstruct", "left.png", "right.png", "--rig", "rig.yaml", "-o", "out")
    assert code == 2
    assert "no pixel of the pair has a depth" in err
    assert len(err.splitlines()) == 1
    assert not Path("out").exists()


def test_the_defaults_are_those_of_python() -> None:
    ours, theirs = (inspect.signature(call).parameters for call in (photographs.reconstruct, rb.reconstruct))
    for name in ("matcher", "nearest_baselines", "pixels"):
        assert ours[name].default == theirs[name].default


def test_the_verb_has_help(shell: Shell) -> None:
    code, out, _ = shell("reconstruct", "--help")
    assert code == 0
    assert "point cloud" in out
