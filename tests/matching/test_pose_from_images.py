"""The pose from photographs: painted rooms and real pairs; bad images are refused with a reason."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

import rectbench as rb
from rectbench import cli
from rectbench.matching.pose.evidence import refuse_same_place
from tests.matching.box_room import pair_of, photograph
from tests.rigs_for_tests import rig

RIG = rig()
Pair = tuple[np.ndarray, np.ndarray]


@pytest.fixture(scope="module")
def pair() -> Pair:
    return pair_of(RIG)


@pytest.mark.parametrize(
    ("rig", "motion"),
    [
        (rig(), "sideways"),
        (rig("kannala-brandt", fov_deg=190.0, size=(480, 480)), "sideways"),
        (rig("double-sphere", rotation_deg=(4, -7, 9)), "sideways"),
        (rig(centre_m=(0.01, 0.02, 0.2)), "forward"),
    ],
    ids=["120 degrees", "190 degrees", "turned", "forward"],
)
@pytest.mark.parametrize("detector", ["sift", "akaze"])
def test_the_images_tell_the_pose(rig: rb.Rig, motion: str, detector: str) -> None:
    found = rb.estimate_pose(pair_of(rig), rig, detector=detector)
    rotation_deg, direction_deg = found.difference_deg(rig)
    assert rotation_deg < 0.05
    assert direction_deg < 0.5
    assert found.motion == motion
    assert found.note == ""
    assert set(found.seconds) == {"features", "consensus", "adjustment"}


def test_orb_tells_it_too(pair: Pair) -> None:
    assert rb.estimate_pose(pair, RIG, detector="orb").difference_deg(RIG)[0] < 0.1


def test_a_reduced_working_size_tells_the_same_pose() -> None:
    large = RIG.scaled(2.0)
    found = rb.estimate_pose(pair_of(large), large, working_pixels=150_000)
    assert found.difference_deg(large)[0] < 0.05


def test_the_same_seed_gives_the_same_bytes(pair: Pair) -> None:
    one, other = (rb.estimate_pose(pair, RIG, seed=5) for _ in range(2))
    assert one.R_right_left.tobytes() == other.R_right_left.tobytes()
    assert one.covariance.tobytes() == other.covariance.tobytes()


def test_a_dark_12_bit_image_is_as_good_as_its_8_bits(pair: Pair) -> None:
    dark = tuple(image.astype(np.uint16) * 4 + 64 for image in pair)
    assert rb.estimate_pose(dark, RIG).difference_deg(RIG)[0] < 0.05


def test_swapped_images_give_the_opposite_baseline_and_a_note(pair: Pair) -> None:
    found = rb.estimate_pose(pair[::-1], RIG)
    assert found.difference_deg(RIG)[1] > 170
    assert "swapped" in found.note


def refused(images: Pair, reason: str) -> None:
    with pytest.raises(rb.PoseNotFound, match=reason):
        rb.estimate_pose(images, RIG)


def test_identical_images_are_refused(pair: Pair) -> None:
    refused((pair[0], pair[0].copy()), "identical")


def test_a_second_photograph_from_the_same_place_is_refused(pair: Pair) -> None:
    again = photograph(RIG.left, np.eye(3), np.zeros(3), noise=3.0)
    refused((pair[0], again), "from the same place")


@pytest.mark.parametrize("change", ["compressed", "brighter", "noisy"])
def test_one_photograph_stored_twice_is_refused_though_the_lenses_differ(pair: Pair, change: str) -> None:
    other = rb.Camera(RIG.left.model, RIG.left.size, {**RIG.left.params, "fx": 1.02 * RIG.left.params["fx"]})
    again = {
        "compressed": lambda: cv2.imdecode(cv2.imencode(".jpg", pair[0], [1, 90])[1], cv2.IMREAD_UNCHANGED),
        "brighter": lambda: cv2.add(pair[0], 1),
        "noisy": lambda: cv2.add(
            pair[0], np.random.default_rng(0).normal(0, 2, pair[0].shape), dtype=cv2.CV_8U
        ),
    }[change]()
    with pytest.raises(rb.PoseNotFound, match="from the same place"):
        rb.estimate_pose((pair[0], again), dataclasses.replace(RIG, right=other))


@pytest.mark.parametrize("flow", ["none", "even", "outwards"])
def test_matches_that_hardly_move_are_of_one_place_only_without_order(flow: str) -> None:
    rng = np.random.default_rng(0)
    left = rng.uniform(0, 500, (400, 2))
    even = np.c_[rng.uniform(0, 0.8, 400), np.zeros(400)]
    moved = {"none": 0 * left, "even": even, "outwards": (left - 250) / 500}[flow]
    matches = rb.Matches(left, left + moved + rng.normal(0, 0.1, left.shape))
    if flow == "none":
        with pytest.raises(rb.PoseNotFound, match="from the same place"):
            refuse_same_place(matches, 1.0)
    else:
        refuse_same_place(matches, 1.0)


def test_a_camera_that_only_turned_is_refused(pair: Pair) -> None:
    refused((pair[0], photograph(RIG.right, RIG.R_right_left, np.zeros(3), noise=3.0)), "a turn alone")


def test_blank_images_are_refused(pair: Pair) -> None:
    refused((np.zeros_like(pair[0]), pair[1]), "0 matches")


def test_images_of_different_rooms_are_refused(pair: Pair) -> None:
    refused((pair[0], pair_of(RIG, seed=3)[1]), r"overlap|matches")


def test_tiny_images_are_refused() -> None:
    tiny = RIG.scaled(4 / RIG.left.width)
    with pytest.raises(rb.PoseNotFound, match="0 matches"):
        rb.estimate_pose(pair_of(tiny), tiny)


def test_images_of_another_size_are_refused_by_their_sizes(pair: Pair) -> None:
    with pytest.raises(rb.InvalidInput, match=r"240x160.*480x320"):
        rb.estimate_pose((pair[0], pair[1][::2, ::2]), RIG)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"detector": "surfer"}, "surf"),
        ({"detector": None}, "unknown detector 'None'"),
        ({"detector": ["sift"]}, "unknown detector"),
        ({"ratio": 0}, "ratio"),
        ({"seed": -1}, "seed"),
        ({"farthest": "far"}, "farthest"),
    ],
)
def test_wrong_options_are_told(pair: Pair, options: dict[str, object], reason: str) -> None:
    with pytest.raises(rb.InvalidInput, match=reason):
        rb.estimate_pose(pair, RIG, **options)


def run_pose(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr(sys, "argv", ["rectbench", "pose", *map(str, arguments)])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    return int(stop.value.code or 0)


@pytest.fixture
def files(tmp_path: Path, pair: Pair) -> Path:
    """left.png, right.png and calib.yaml, whose pose is not the true one."""
    for name, image in zip(("left", "right"), pair, strict=True):
        cv2.imwrite(str(tmp_path / f"{name}.png"), image.astype(np.uint16) * 200)
    dataclasses.replace(RIG, R_right_left=np.eye(3)).save(tmp_path / "calib.yaml")
    return tmp_path


def test_the_command_prints_the_pose_and_writes_the_rig(
    files: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    images = files / "left.png", files / "right.png"
    assert run_pose(monkeypatch, "--rig", files / "calib.yaml", *images, "-o", files / "rig.yaml") == 0
    printed = capsys.readouterr().out
    assert all(word in printed for word in ("rotation", "direction", "±", "fit", "calibration", "features"))
    placed = rb.load_rig(files / "rig.yaml")
    assert np.degrees(np.linalg.norm(placed.R_right_left - RIG.R_right_left)) < 0.1
    assert placed.baseline_m == pytest.approx(RIG.baseline_m)


def test_the_command_warns_of_swapped_images(
    files: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_pose(monkeypatch, "--rig", files / "calib.yaml", files / "right.png", files / "left.png") == 0
    assert "warning: the images look swapped" in capsys.readouterr().out


def test_the_command_ends_with_one_line_where_there_is_no_pose(
    files: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_pose(monkeypatch, "--rig", files / "calib.yaml", files / "left.png", files / "left.png") == 2
    assert capsys.readouterr().err == (
        "rectbench: the two images are identical; expected photographs from two places\n"
    )
