"""Every format tells the same rig: cameras and pose, whatever its direction, order and unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rectbench import Camera, InvalidInput, Rig, load_rig
from rectbench.calibrations import calibration_formats
from tests.calibrations.examples import EXAMPLES, Example


def written(example: Example, folder: Path) -> list[Path]:
    """The example's files in `folder`, and the paths of it that `load_rig` takes."""
    for name, content in example.files.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return [folder / name for name in example.paths or example.files]


def assert_same_camera(read: Camera, expected: Camera) -> None:
    assert (read.model, read.size) == (expected.model, expected.size)
    rays = np.random.default_rng(1).normal(size=(300, 3)) * [1, 1, 0.6]
    (pixels, ok), (expected_pixels, expected_ok) = read.project(rays), expected.project(rays)
    np.testing.assert_array_equal(ok, expected_ok)
    np.testing.assert_allclose(pixels[ok], expected_pixels[ok], atol=1e-8)
    assert ok.sum() > 30


def assert_same_rig(read: Rig, expected: Rig) -> None:
    assert_same_camera(read.left, expected.left)
    assert_same_camera(read.right, expected.right)
    np.testing.assert_allclose(read.R_right_left, expected.R_right_left, atol=1e-12)
    np.testing.assert_allclose(read.t_right_left, expected.t_right_left, atol=1e-12)


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_format_tells_the_same_rig(tmp_path: Path, name: str) -> None:
    example = EXAMPLES[name]
    assert_same_rig(load_rig(written(example, tmp_path), **example.options), example.rig)


@pytest.mark.parametrize("name", [name for name in EXAMPLES if name != "opencv-samples"])
def test_a_folder_is_read_as_its_files_are(tmp_path: Path, name: str) -> None:
    example = EXAMPLES[name]
    written(example, tmp_path)
    (tmp_path / "README.md").write_text("What the pictures show.")
    (tmp_path / "notes.txt").write_text("Taken on a sunny day: a street.\n")
    rig = load_rig(tmp_path, **example.options)
    assert_same_rig(rig, example.rig)
    assert rig.name == tmp_path.name


def test_each_format_has_an_example() -> None:
    owned_elsewhere = {"native", "colmap", "mrcal", "matlab-camera"}
    for format in set(calibration_formats()) - owned_elsewhere:
        assert any(name.startswith(format) for name in EXAMPLES), format


@pytest.mark.parametrize("name", ["ocamcalib", "camodocal", "matlab-fisheye"])
def test_two_cameras_without_a_pose_ask_for_it(tmp_path: Path, name: str) -> None:
    left, right, _ = written(EXAMPLES[name], tmp_path)
    with pytest.raises(InvalidInput, match="does not say where its camera stands") as caught:
        load_rig([left, right])
    assert "R_right_left" in str(caught.value)


def test_cameras_come_in_the_order_given(tmp_path: Path) -> None:
    left, right = written(EXAMPLES["euroc"], tmp_path)
    rig, swapped = load_rig([left, right]), load_rig([right, left])
    assert (swapped.left, swapped.right) == (rig.right, rig.left)
    np.testing.assert_allclose(swapped.R_right_left, rig.R_right_left.T, atol=1e-15)
    np.testing.assert_allclose(swapped.t_right_left, rig.centre_right_in_left, atol=1e-15)


def test_a_right_camera_on_the_left_is_told_and_kept(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    left, right = written(EXAMPLES["euroc"], tmp_path)
    load_rig([left, right])
    assert not caplog.records
    assert load_rig([right, left]).t_right_left[0] > 0
    assert "the right camera stands 0.11 m to the left of the left one; kept" in caplog.text


def test_orb_slam3_s_rectified_pair(tmp_path: Path) -> None:
    (tmp_path / "EuRoC.yaml").write_text(
        '%YAML:1.0\nCamera.type: "Rectified"\nCamera1.fx: 435.2\nCamera1.fy: 435.2\nCamera1.cx: 367.5\n'
        "Camera1.cy: 252.2\nCamera.width: 752\nCamera.height: 480\nStereo.b: 0.11007\n"
    )
    rig = load_rig(tmp_path / "EuRoC.yaml")
    assert rig.left == rig.right
    np.testing.assert_array_equal(rig.t_right_left, [-0.11007, 0, 0])


def test_one_camera_is_no_rig(tmp_path: Path) -> None:
    left, _ = written(EXAMPLES["ros"], tmp_path)
    with pytest.raises(InvalidInput, match="is a file with one camera; expected two"):
        load_rig(left)


def test_cameras_of_different_formats_make_a_rig(tmp_path: Path) -> None:
    fisheye, _, pose = written(EXAMPLES["ocamcalib"], tmp_path)
    _, pinhole = written(EXAMPLES["ros"], tmp_path)
    rig = load_rig([fisheye, pinhole, pose])
    assert (rig.left.model, rig.right.model) == ("ocam", "pinhole")
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES["ros"].rig.t_right_left)


def test_a_long_baseline_wants_its_unit_stated(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["boofcv"], tmp_path)
    with pytest.raises(
        InvalidInput, match=r"the baseline is 110.0\d+ m; expected at most 10 m, or unit='mm'"
    ):
        load_rig(path)
    assert load_rig(path, unit="mm").baseline_m == pytest.approx(0.11, rel=1e-3)
    assert load_rig(path, unit="m").baseline_m == pytest.approx(110, rel=1e-3)


def test_a_unit_that_the_file_contradicts_is_refused(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["matlab"], tmp_path)
    with pytest.raises(InvalidInput, match="is in mm; expected unit='m' as given beside the file"):
        load_rig(path, unit="m")


def test_an_unknown_unit_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="unknown unit 'furlong'"):
        load_rig("t265", unit="furlong")
