"""What people's files have beside the letter of their format: aliases, headers, zeros, repeated messages."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from rectbench import InvalidInput, load_rig
from tests.calibrations.examples import EXAMPLES, SIZE
from tests.calibrations.test_every_format import assert_same_rig, written


def test_what_two_cameras_share_may_be_an_alias(tmp_path: Path) -> None:
    chain = yaml.safe_load(EXAMPLES["kalibr"].files["camchain.yaml"])
    chain["cam0"]["resolution"] = chain["cam1"]["resolution"]
    text = yaml.safe_dump(chain)
    assert "*id001" in text
    (tmp_path / "chain.yaml").write_text(text)
    assert_same_rig(load_rig(tmp_path / "chain.yaml"), EXAMPLES["kalibr"].rig)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("cam0: *camera\n", "an alias of nothing before it"),
        ("cam0: &camera [*camera]\n", "an alias of nothing before it"),
        ("cam0: &camera {model: 1}\ncam1:\n  <<: *camera\n", "merges mappings with <<"),
        (
            "a: &a " + "[" * 30 + "]" * 30 + "\nb: " + "[" * 30 + "*a" + "]" * 30 + "\n",
            "is nested too deeply",
        ),
        ("[a]\n" + "b." * 9 + "c = 1\n", "has a key of over 8 parts"),
        ("[a]\nb = \n", "is no TOML"),
        ("[a]\nb = " + "9" * 5000 + "\n", "is no TOML"),
        ("[a]\nb = " + "[" * 50 + "]" * 50 + "\n", "is nested too deeply"),
    ],
)
def test_what_is_amiss_is_said(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text)
    with pytest.raises(InvalidInput) as caught:
        load_rig(path)
    assert message in str(caught.value)


def test_a_message_that_is_echoed_again_is_the_same_one(tmp_path: Path) -> None:
    for path in (paths := written(EXAMPLES["ros-message"], tmp_path)):
        text = path.read_text()
        path.write_text(f"{text}---\n{text.replace('frame_id: camera', 'frame_id: again')}---\n")
    assert_same_rig(load_rig(paths), EXAMPLES["ros-message"].rig)
    paths[0].write_text(f"{text}---\n{text.replace('848', '847')}---\n")
    with pytest.raises(InvalidInput, match="holds several YAML documents"):
        load_rig(paths)


def test_a_fisheye_s_coefficients_may_be_filled_up_with_zeros(tmp_path: Path) -> None:
    paths = written(EXAMPLES["ros-message"], tmp_path)
    for path in paths:
        message = yaml.safe_load(path.read_text())
        message["d"].append(0.0)
        path.write_text(yaml.safe_dump(message))
    assert_same_rig(load_rig(paths), EXAMPLES["ros-message"].rig)
    message["d"][-1] = 0.1
    path.write_text(yaml.safe_dump(message))
    with pytest.raises(InvalidInput, match="expected 4 distortion coefficients \\(fisheye\\)"):
        load_rig(paths)


def test_a_projection_of_zeros_is_that_of_no_pair(tmp_path: Path) -> None:
    paths = written(EXAMPLES["ros-message"], tmp_path)
    for path in paths:
        message = yaml.safe_load(path.read_text())
        message["p"] = [0.0] * 12
        path.write_text(yaml.safe_dump(message))
    with pytest.raises(InvalidInput, match="does not say where its camera stands"):
        load_rig(paths)


def test_rtabmap_s_pose_goes_with_two_cameras(tmp_path: Path) -> None:
    left, right, pose = written(EXAMPLES["ocamcalib"], tmp_path)
    text = pose.read_text().replace("R: ", "rotation_matrix: ").replace("T: ", "translation_matrix: ")
    pose.write_text(text)
    assert_same_rig(load_rig([left, right, pose]), EXAMPLES["ocamcalib"].rig)


def test_a_camera_without_a_model_in_a_chain_is_a_pinhole(tmp_path: Path) -> None:
    chain = {
        "cam0": {"intrinsics": [805.0, 806, 424, 400], "distortion_model": "rational_polynomial"},
        "cam1": {"intrinsics": [799.0, 800, 426, 398], "distortion_model": "plumb_bob"},
    }
    chain["cam0"]["distortion_coeffs"] = [0.1, 0.2, 1e-4, 2e-4, 0.3, 0.4, 0.5, 0.6]
    chain["cam1"] |= {"distortion_coeffs": [0.1, 0.2, 1e-4, 2e-4, 0.3]}
    chain["cam1"]["T_cn_cnm1"] = [[1, 0, 0, -0.07], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    (tmp_path / "stereo_calib.yaml").write_text(yaml.safe_dump(chain))
    rig = load_rig(tmp_path / "stereo_calib.yaml", size=SIZE)
    assert (rig.left.params["k6"], rig.right.params["k3"]) == (0.6, 0.3)


def test_settings_of_an_rgb_d_camera_are_no_rig(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["orbslam2-rectified"], tmp_path)
    path.write_text(path.read_text() + "DepthMapFactor: 5000.0\n")
    with pytest.raises(InvalidInput):
        load_rig(path)


def test_a_lens_that_nobody_undoes_is_no_rectified_pair(tmp_path: Path) -> None:
    (path,) = written(EXAMPLES["orbslam2-rectified"], tmp_path)
    path.write_text(path.read_text().replace("k2: 0.0", "k2: 0.1"))
    with pytest.raises(InvalidInput, match=r"Camera\.k2 is '0.1'; expected 0 of rectified images"):
        load_rig(path)


def test_four_coefficients_in_an_ost_are_a_fisheye_s_and_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """camera_calibration writes five or eight of a pinhole, and names no model there."""
    files = {}
    for side, path in zip(("left", "right"), written(EXAMPLES["ost"], tmp_path), strict=True):
        lines = path.read_text().splitlines()
        place = lines.index("distortion") + 1
        lines[place] = " ".join(lines[place].split()[:4])
        path.write_text("\n".join(lines) + "\n")
        files[side] = path
    rig = load_rig([files["left"], files["right"]])
    assert (rig.left.model, rig.left.params["k3"]) == ("kannala-brandt", 2e-4)
    assert "as camera_calibration writes of a fisheye alone" in caplog.text


def test_a_fisheye_s_coefficients_of_no_model_are_no_pinhole_s(tmp_path: Path) -> None:
    for path in (paths := written(EXAMPLES["ros-camera-model"], tmp_path)):
        path.write_text(path.read_text().replace("camera_model: equidistant\n", ""))
    with pytest.raises(InvalidInput, match="expected `distortion_model: equidistant` or plumb_bob"):
        load_rig(paths)


def test_coefficients_that_airslam_does_not_use_are_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (path,) = written(EXAMPLES["airslam"], tmp_path)
    path.write_text(path.read_text().replace("distortion_type: 2", "distortion_type: 0"))
    assert load_rig(path).left.model == "pinhole"
    assert "cam0.distortion_coeffs is not used, since distortion_type is 0" in caplog.text
