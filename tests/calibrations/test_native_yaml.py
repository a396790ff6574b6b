from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from rectbench import Camera, InvalidInput, Rig, load_rig

FOCAL = {"fx": 500.1, "fy": 501.2, "cx": 319.5, "cy": 239.5}
OCAM = {"cx": 798.2, "cy": 794.3, "c": 1.0003, "d": -2.8e-4, "e": -9e-4}
ANY_MODEL = [
    Camera("pinhole", (640, 480), {**FOCAL, "k1": -0.1, "s4": 1e-7}),
    Camera("double-sphere", (640, 480), {**FOCAL, "xi": -0.17, "alpha": 0.59}, max_angle_deg=97.5),
    Camera("ocam", (1600, 1600), {**OCAM, "poly": (-471.4, 0, 7.4e-4), "inverse_poly": (772.4, 504.8)}, 85),
]


@pytest.mark.parametrize("camera", ANY_MODEL, ids=lambda camera: camera.model)
def test_every_sort_of_camera_survives_a_round_trip(rig: Rig, camera: Camera, tmp_path: Path) -> None:
    rig = dataclasses.replace(rig, left=camera)
    rig.save(tmp_path / "rig.yaml")
    assert load_rig(tmp_path / "rig.yaml") == rig


finite = st.floats(allow_nan=False, allow_infinity=False)
printable = st.text(st.characters(codec="utf-8"), min_size=1).filter(str.isprintable)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    name=printable,
    source=st.text(),
    angles=st.tuples(*[st.floats(-180, 180)] * 3),
    t=st.tuples(*[st.floats(-1e6, 1e6)] * 3).filter(lambda t: np.linalg.norm(t) > 0),
    cx=finite,
)
def test_round_trip_is_exact(
    rig: Rig, tmp_path: Path, name: str, source: str, angles: tuple, t: tuple, cx: float
) -> None:
    left = dataclasses.replace(rig.left, params={**rig.left.params, "cx": cx})
    R = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
    written = Rig(left, rig.right, R, t, name=name, source=source)
    written.save(tmp_path / "rig.yaml")
    read = load_rig(tmp_path / "rig.yaml")
    assert read == written
    assert (read.name, read.source) == (name, source)


def test_a_write_that_fails_leaves_the_old_file(
    rig: Rig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "rig.yaml"
    rig.save(path)
    before = path.read_bytes()

    def full_disk(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full_disk)
    with pytest.raises(InvalidInput, match="No space left"):
        dataclasses.replace(rig, name="other").save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_writing_into_no_folder_says_so(rig: Rig, tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="cannot be written"):
        rig.save(tmp_path / "none" / "rig.yaml")


VALID = """\
rectbench_rig: 1
cameras:
  left: &LEFT
    model: equidistant
    size: [640, 480]
    params: {fx: 200, fy: 200, cx: 319.5, cy: 239.5}
  right:
    model: equidistant
    size: [640, 480]
    params: {fx: 200, fy: 200, cx: 319.5, cy: 239.5}
R_right_left: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
t_right_left: [-1e-1, 0, 0]
""".replace(" &LEFT", "")


def test_a_file_written_by_hand_is_read(tmp_path: Path) -> None:
    path = tmp_path / "by-hand.yaml"
    path.write_text(VALID)
    rig = load_rig(path)
    assert rig.name == "by-hand"
    assert rig.baseline_m == 0.1


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("rectbench_rig: 1", "rectbench_rig: 2", "rectbench_rig is '2'; expected the format's version, 1"),
        ("[-1e-1, 0, 0]", "[0, 0, 0]", "baseline is zero"),
        ("[-1e-1, 0, 0]", "[0, 0]", "t_right_left is ['0', '0']; expected three metres"),
        ("[-1e-1, 0, 0]", "[.nan, 0, 0]", "t_right_left is ['.nan', '0', '0']; expected three metres"),
        ("t_right_left: [-1e-1, 0, 0]", "", "t_right_left is missing; expected three metres"),
        ("[[1, 0, 0]", "[[2, 0, 0]", "R_right_left is no rotation"),
        ("[[1, 0, 0]", "[[1, 0]", "R_right_left.0 is ['1', '0']; expected 3 finite numbers"),
        ("[[1, 0, 0]", "[3", "R_right_left.0 is '3'; expected 3 finite numbers"),
        ("  right:", "  wrong:", "unknown key 'wrong'; did you mean right?"),
        ("fx: 200", "fx: wide", "cameras.left.params.fx is 'wide'; expected a number"),
        ("fx: 200", "fx: -200", "cameras.left: "),
        ("fx: 200", "focal: 200", "cameras.left: unknown parameter of equidistant 'focal'"),
        (
            "equidistant",
            "equidistand",
            "cameras.left: unknown projection model 'equidistand'; did you mean equidistant",
        ),
        ("[640, 480]", "[640.5, 480]", "cameras.left.size is ['640.5', '480']; expected [width, height]"),
        ("[640, 480]", "640", "cameras.left.size is '640'; expected [width, height]"),
        (
            "    size: [640, 480]\n",
            "    max_angle: 3\n",
            "unknown key 'max_angle'; did you mean max_angle_deg?",
        ),
        ("    size: [640, 480]\n", "", "cameras.left.size is missing"),
        ("    size: [640, 480]\n", "    size: [640, 480]\n    size: [640, 480]\n", "the key size twice"),
        (
            "rectbench_rig: 1",
            "rectbench_rig: 1\nname: !!python/name:os.system ''",
            "the tag tag:yaml.org,2002:python",
        ),
        ("  right:", "  right: *LEFT\n  other:", "an alias"),
        ("[[1, 0, 0]", "[[1, 0, 0", "is no YAML at line"),
    ],
)
def test_a_fault_names_file_key_and_expectation(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "rig.yaml"
    assert old in VALID
    path.write_text(VALID.replace(old, new, 1))
    with pytest.raises(InvalidInput) as caught:
        load_rig(path)
    assert str(caught.value).startswith(str(path))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_size_given_beside_the_file_fills_in_and_may_not_contradict(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(VALID.replace("    size: [640, 480]\n", ""))
    assert load_rig(path, size=(640, 480)).left.size == (640, 480)
    path.write_text(VALID)
    with pytest.raises(InvalidInput, match="expected the size 64x48 given"):
        load_rig(path, size=(64, 48))
