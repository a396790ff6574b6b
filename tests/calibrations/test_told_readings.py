"""What newer formats say in several ways, or leave open, is read as it is meant; what is taken is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rectbench import InvalidInput
from tests.calibrations.changed_examples import Change, loaded, put, set_at
from tests.calibrations.examples import EXAMPLES

FIRST_CAMERA = ("CameraCalibrations", 2)
ALICE = ("intrinsics", 0)


def test_a_colour_camera_without_coefficients_is_a_pinhole(tmp_path: Path) -> None:
    rig = loaded("realsense-d400", lambda text: text, tmp_path, cameras=("Infrared 1", "Color"))
    assert rig.right.model == "pinhole"
    assert rig.right.params["k1"] == 0


def test_centimetres_and_millimetres_are_told_where_metres_cannot_be(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def in_centimetres(content: Any) -> None:
        for camera in content["cameras"]:
            camera["origin"] = [100 * number for number in camera["origin"]]

    rig = loaded("facebook360", in_centimetres, tmp_path)
    assert "origin: the baseline is 11, too long for metres; taken to be in cm" in caplog.text
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES["facebook360"].rig.t_right_left, atol=1e-12)
    caplog.clear()
    assert loaded("facebook360", lambda _: None, tmp_path, unit="ft").baseline_m == pytest.approx(
        EXAMPLES["facebook360"].rig.baseline_m * 0.3048
    )
    assert "too long for metres" not in caplog.text


@pytest.mark.parametrize("name", ["transforms", "openmvg", "alicevision", "metashape-fisheye"])
def test_a_scale_that_nothing_fixed_is_told_unless_it_is_stated(
    tmp_path: Path, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    rig = loaded(name, lambda content: content, tmp_path)
    assert "its scale is arbitrary unless something fixed it; taken to be in metres" in caplog.text
    caplog.clear()
    assert loaded(name, lambda content: content, tmp_path, unit="ft").baseline_m == pytest.approx(
        rig.baseline_m * 0.3048
    )
    assert "its scale is arbitrary" not in caplog.text


def test_metashape_s_own_scale_is_metres(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    loaded("metashape", lambda text: text, tmp_path)
    assert "its scale is arbitrary" not in caplog.text
    with pytest.raises(InvalidInput, match="is in m; expected unit='mm' as given beside the file"):
        loaded("metashape", lambda text: text, tmp_path, unit="mm")


def test_a_multi_camera_system_s_cameras_with_a_transform_are_read_where_they_are_asked_for(
    tmp_path: Path,
) -> None:
    enslaved = put('label="not aligned"', 'master_id="0" label="slave"')
    rig = loaded("metashape", enslaved, tmp_path, cameras=("left", "right"))
    assert rig.left == EXAMPLES["metashape"].rig.left
    with pytest.raises(InvalidInput, match="camera 'slave' is a slave"):
        loaded("metashape", enslaved, tmp_path, cameras=("left", "slave"))


def test_an_applied_scale_is_taken_back(tmp_path: Path) -> None:
    plain = loaded("transforms", lambda _: None, tmp_path)
    scaled = loaded("transforms", set_at("applied_scale", value=0.25), tmp_path)
    np.testing.assert_allclose(scaled.t_right_left, 4 * plain.t_right_left, atol=1e-12)


def test_a_field_of_view_that_the_focal_length_contradicts_is_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    rig = loaded("transforms-ngp", set_at("camera_angle_x", value=1.0), tmp_path)
    assert "fl_x is 285.722 px, where the field of view makes it 776.127 px; the former counts" in caplog.text
    assert rig.left == EXAMPLES["transforms-ngp"].rig.left


def test_a_field_of_view_alone_is_a_focal_length(tmp_path: Path) -> None:
    def bare(content: Any) -> None:
        for key in ("fl_x", "fl_y", "cx", "cy", "camera_angle_y", "is_fisheye"):
            del content[key]

    rig = loaded("transforms-ngp", bare, tmp_path)
    fx = EXAMPLES["transforms-ngp"].rig.left.params["fx"]
    assert [rig.left.params[key] for key in ("fx", "fy", "cx", "cy")] == pytest.approx([fx, fx, 423.5, 399.5])


def test_a_radial_distortion_by_its_sum_is_a_shorter_focal_length(tmp_path: Path) -> None:
    """radialk3pt divides by 1 + k1 + k2 + k3."""

    def normalised(content: Any) -> None:
        for intrinsic in content["intrinsics"]:
            intrinsic |= {"distortionType": "radialk3pt", "distortionParams": ["0.1", "-0.02", "0.005"]}

    left = loaded("alicevision", normalised, tmp_path).left
    x, y = 0.3, -0.2
    r2 = x * x + y * y
    bent = (1 + 0.1 * r2 - 0.02 * r2**2 + 0.005 * r2**3) / (1 + 0.1 - 0.02 + 0.005)
    fx, fy = (EXAMPLES["alicevision"].rig.left.params[key] for key in ("fx", "fy"))
    (pixel,), _ = left.project([[x, y, 1.0]])
    expected = [fx * x * bent + left.params["cx"], fy * y * bent + left.params["cy"]]
    np.testing.assert_allclose(pixel, expected, atol=1e-9)


@pytest.mark.parametrize(
    ("version", "lens", "expected"),
    [
        ([1, 2, 0], {"pxFocalLength": [300, 303], "principalPoint": [420, 400]}, (300, 303, 420, 400)),
        ([1, 2, 1], {"pxFocalLength": [300, 303], "principalPoint": [-4, 0]}, (300, 303, 420, 400)),
        (
            [1, 2, 2],
            {"focalLength": 12.0, "sensorWidth": 33.92, "pixelRatio": 0.99},
            (300, 303.030303, 424, 400),
        ),
        ([1, 2, 5], {"focalLength": 12.0, "sensorWidth": 33.92, "pixelRatio": 1.01}, (300, 303, 424, 400)),
    ],
)
def test_alicevision_s_versions_say_the_focal_length_each_in_its_way(
    tmp_path: Path, version: list[int], lens: dict[str, Any], expected: tuple[float, ...]
) -> None:
    def of_version(content: Any) -> None:
        content["version"] = version
        for intrinsic in content["intrinsics"]:
            for key in ("pxFocalLength", "focalLength", "sensorWidth", "pixelRatio"):
                intrinsic.pop(key, None)
            intrinsic |= {"principalPoint": [0, 0], **lens}

    left = loaded("alicevision", of_version, tmp_path).left
    assert [left.params[key] for key in ("fx", "fy", "cx", "cy")] == pytest.approx(expected)


@pytest.mark.parametrize(
    "sizes",
    [
        set_at("ImageSizes", value=[[1408, 1408], [640, 480], [640, 480]]),
        lambda content: (
            [
                camera.update(ConfigData={"ImageWidth": 640, "ImageHeight": 480})
                for camera in content["CameraCalibrations"]
            ]
            and content
        ),
    ],
)
def test_aria_s_image_size_is_the_file_s_where_it_has_one(tmp_path: Path, sizes: Change) -> None:
    rig = loaded("aria", sizes, tmp_path, size=None)
    assert rig.left.size == rig.right.size == (640, 480)
    with pytest.raises(InvalidInput, match="ImageWidth is missing; expected it and ImageHeight, or `size`"):
        loaded("aria", lambda content: content, tmp_path, size=None)


def test_aria_s_fisheye62_is_fisheye624_without_prism(tmp_path: Path) -> None:
    def without_prism(content: Any) -> None:
        for camera in content["CameraCalibrations"]:
            projection = camera["Projection"]
            projection |= {"Name": "Fisheye62", "Params": projection["Params"][:11]}

    expected = {**EXAMPLES["aria"].rig.left.params, "s0": 0.0, "s1": 0.0, "s2": 0.0, "s3": 0.0}
    assert dict(loaded("aria", without_prism, tmp_path).left.params) == expected


def test_nuscenes_cameras_of_several_logs_go_by_their_tokens(tmp_path: Path) -> None:
    def twice(content: Any) -> Any:
        again = json.loads(json.dumps(content))
        for record in again:
            record["token"] += "b"
        return content + again

    rig = loaded("nuscenes", twice, tmp_path, cameras=("c1b", "c2b"))
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES["nuscenes"].rig.t_right_left, atol=1e-12)


@pytest.mark.parametrize(("name", "key"), [("facebook360", "cameras"), ("transforms", "frames")])
def test_of_three_cameras_the_pairs_are_listed_and_two_are_read_as_before(
    tmp_path: Path, name: str, key: str
) -> None:
    def third(content: Any) -> None:
        one = json.loads(json.dumps(content[key][0]))
        if key == "frames":
            one["file_path"] = "images/third.png"
            one["transform_matrix"][0][3] += 0.5
        else:
            one["id"] = "third"
            one["origin"][0] += 0.5
        content[key].append(one)

    with pytest.raises(InvalidInput, match=r"(?s)holds 3 cameras; .*third(\.png)?: baseline 0\.5 m, 100 %"):
        loaded(name, third, tmp_path)
    asked = ("left.png", "right.png") if key == "frames" else ("cam0", "cam1")
    rig = loaded(name, third, tmp_path, cameras=asked)
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES[name].rig.t_right_left, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("aria", lambda content: content["CameraCalibrations"].reverse()),
        ("argoverse", lambda content: content["camera_data_"].reverse()),
    ],
)
def test_a_device_s_own_stereo_pair_is_left_and_right(tmp_path: Path, name: str, change: Change) -> None:
    rig = loaded(name, change, tmp_path)
    np.testing.assert_allclose(rig.t_right_left, EXAMPLES[name].rig.t_right_left, atol=1e-12)
