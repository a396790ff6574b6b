"""What a file says of a lens or a pose and rectbench does not hold is refused in one line, or told."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rectbench import InvalidInput, load_rig
from tests.calibrations.examples import EXAMPLES

Change = Callable[[Any], Any]


def loaded(name: str, change: Change, folder: Path, **options: Any) -> Any:
    """The rig of an example whose first file, JSON or text, is changed."""
    example = EXAMPLES[name]
    for number, (file, text) in enumerate(example.files.items()):
        path = folder / file
        if number == 0 and file.endswith(".json"):
            content = json.loads(text)
            content = change(content) or content
            text = json.dumps(content)
        elif number == 0:
            text = change(text)
        path.write_text(str(text))
    paths = [folder / file for file in example.paths or example.files]
    return load_rig(paths, **{**example.options, **options})


def set_at(*keys: Any, value: Any) -> Change:
    """Put a value in a nested place."""

    def change(content: Any) -> None:
        for key in keys[:-1]:
            content = content[key]
        content[keys[-1]] = value

    return change


def put(old: str, new: str, count: int = -1) -> Change:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, count)

    return change


FIRST_CAMERA = ("CameraCalibrations", 2)
NUREC = ("camera_calibrations", "camera_left@clip", "camera_model")
ALICE = ("intrinsics", 0)
REFUSED: list[tuple[str, Change, str]] = [
    ("left-right", put("T:", "T_cam_imu:"), "no calibration known here"),
    ("left-right", put("radtan", "fisheye"), "distortion_model is 'fisheye'; expected none, radtan"),
    ("left-right", put("distortion_coeffs:", "D:"), "unknown key 'D'"),
    ("simplestereo", set_at("lens", value="fisheye"), "unknown key 'lens'"),
    ("simplestereo", set_at("intrinsic1", 0, 1, value=3.0), "intrinsic1 has skew"),
    ("multical", set_at("cameras", "cam1", "model", value="omni"), "model is 'omni'; expected standard"),
    ("multical", set_at("cameras", "cam1", "xi", value=1.0), "unknown key 'xi'"),
    (
        "multical",
        set_at("camera_poses", "cam1", "R", value=[[1, 0, 0]] * 3),
        "camera_poses.cam1.R: it is no rotation",
    ),
    ("multical", set_at("camera_poses", value={"cam1_to_a": {}, "cam2_to_b": {}}), "in 2 cameras' frames"),
    (
        "realsense",
        put("Kannala Brandt4", "Panorama"),
        "Distortion is 'Panorama'; expected None, Brown Conrady",
    ),
    (
        "realsense",
        put("Kannala Brandt4", "Inverse Brown Conrady"),
        "Inverse Brown Conrady with .*a lens that",
    ),
    ("realsense", put("Kannala Brandt4", "Modified Brown Conrady"), "Modified Brown Conrady with"),
    ("realsense", put("Coeffs:", "Coefficients:"), "Coeffs is missing; expected five distortion"),
    ("realsense", put('from "Fisheye 2"', 'from "Pose"'), 'has no Extrinsic from "Fisheye 1" to "Fisheye 2"'),
    ("realsense", put("PPX:", "CX:"), "PPX is missing; expected pixels"),
    (
        "realsense-json",
        set_at("extrinsics", value={}),
        "has no extrinsics of fisheye_1 and fisheye_2; expected",
    ),
    (
        "realsense-json",
        set_at("intrinsics", "fisheye_1", "model", value="omni"),
        "model is 'omni'; expected None",
    ),
    ("realsense-json", set_at("intrinsics", "fisheye_1", "coeffs", value=[0.1]), "expected five distortion"),
    (
        "realsense-json-plain",
        set_at("left", "intrinsics", "model", value="distortion.inverse_brown_conrady"),
        "is Inverse Brown Conrady with",
    ),
    ("aria", set_at(*FIRST_CAMERA, "Projection", "Name", value="Spherical"), "Name is 'Spherical'; expected"),
    (
        "aria",
        set_at(*FIRST_CAMERA, "Projection", "Params", value=[1.0] * 8),
        r"expected 15 finite numbers \(f cx",
    ),
    ("aria", set_at(*FIRST_CAMERA, "Calibrated", value=False), "Calibrated is False; expected true"),
    (
        "aria",
        set_at(*FIRST_CAMERA, "T_Device_Camera", "UnitQuaternion", value=[2.0, [0, 0, 0]]),
        "UnitQuaternion is a quaternion of length 2; expected 1",
    ),
    ("facebook360", set_at("cameras", 0, "type", value="STEREOGRAPHIC"), "type is 'STEREOGRAPHIC'; expected"),
    (
        "facebook360",
        set_at("cameras", 0, "type", value="EQUISOLID"),
        "distortion is on a lens that rectbench",
    ),
    ("facebook360", set_at("cameras", 0, "focal", value=[285, 285]), "focal is .*expected .fx, -fy."),
    ("facebook360", set_at("cameras", 0, "up", value=[1.0, 0, 0]), "right, up, forward: it is no rotation"),
    ("facebook360", set_at("cameras", 0, "skew", value=1.0), "unknown key 'skew'"),
    ("metashape-fisheye", put("<p1>", "<b2>0.5</b2><p1>"), "is a fisheye with b2 = 0.5, .*p1 = 0.001"),
    ("metashape", put("<p1>", "<p3>0.1</p3><p1>"), "p3 is '0.1'; expected 0"),
    ("metashape", put("<p1>", "<k5>0.1</k5><p1>"), "unknown key 'k5'"),
    ("metashape", put('type="frame"', 'type="spherical"'), "type is 'spherical'; expected frame, fisheye"),
    (
        "metashape",
        put('<sensor id="0" label="lens 0" type="frame"', '<sensor id="0" type="fisheye"'),
        "as the sensor",
    ),
    ("metashape", put('sensor_id="0"', 'sensor_id="9"'), "sensor_id is no sensor of the file"),
    ("metashape", put('component_id="0"', 'component_id="1"', 1), "different components; expected one"),
    (
        "metashape",
        put('label="not aligned"', 'master_id="0" label="slave"'),
        "camera 'slave' is a slave of a multi-camera system and has no transform of its own",
    ),
    ("metashape", put("<scale>2.5", "<scale>-1"), "scale is '-1'; expected a number above 0"),
    ("metashape", put("<document ", "<!DOCTYPE a [<!ENTITY b 'c'>]><document "), "declares a document type"),
    (
        "transforms",
        set_at("camera_model", value="EQUIRECTANGULAR"),
        "camera_model is 'EQUIRECTANGULAR'; expected",
    ),
    (
        "transforms",
        set_at("is_fisheye", value=False),
        "is_fisheye is False; expected true or false, as camera",
    ),
    (
        "transforms",
        set_at("frames", 0, "p1", value=0.01),
        "p1 is 0.01; expected 0, as kannala-brandt has no p1",
    ),
    ("transforms", set_at("fl_x", value=300.0), "fl_x is 285.7.*; expected 300.0, as at the top of the file"),
    ("transforms", set_at("latlong", value=True), "latlong is no lens"),
    ("transforms-ngp", set_at("k4", value=0.1), "k4 is 0.1; expected 0, as pinhole has no k4 here"),
    ("transforms-ngp", set_at("k6", value=0.1), "k6 is 0.1; expected 0, as these programs have no such"),
    ("transforms-f-theta", set_at("ftheta_p0", value=0.1), "ftheta_p0 is 0.1; expected 0, the angle at the"),
    (
        "openmvg",
        set_at("intrinsics", 0, "value", "polymorphic_name", value="spherical"),
        "is 'spherical'; expected",
    ),
    (
        "openmvg",
        set_at("intrinsics", 0, "value", "ptr_wrapper", "data", "disto_k3", value=[0.1, 0, 0]),
        "unknown key 'disto_k3'",
    ),
    ("alicevision", set_at(*ALICE, "type", value="equidistant"), "type is 'equidistant'; expected pinhole"),
    ("alicevision", set_at(*ALICE, "distortionType", value="3deradial4"), "distortionType is '3deradial4'"),
    ("alicevision", set_at(*ALICE, "distortionParams", value=["0.1"]), r"expected 5 coefficients \(k1 k2 k3"),
    (
        "alicevision",
        set_at(*ALICE, "undistortionParams", value=["1"]),
        "expected none, as rectbench has no such",
    ),
    (
        "drive",
        set_at("rig", "sensors", 1, "properties", "Model", value="pinhole"),
        "Model is 'pinhole'; expected",
    ),
    (
        "drive",
        set_at("rig", "sensors", 1, "properties", "bw-poly", value="0.1 0.2"),
        "polynomial of 0.1 at its",
    ),
    (
        "drive",
        set_at("rig", "sensors", 2, "properties", "polynomial-type", value="x"),
        "polynomial-type is 'x'",
    ),
    ("nurec", set_at(*NUREC, "type", value="opencv-fisheye"), "type is 'opencv-fisheye'; expected ftheta"),
    ("nurec", set_at(*NUREC, "parameters", "k1", value=0.1), "unknown key 'k1'"),
    (
        "nurec",
        set_at(*NUREC, "parameters", "external_distortion_parameters", value={"a": 1}),
        "expected none, as a windscreen's are no lens here",
    ),
    ("isaac", set_at("cameraModel", value="fisheyeSpherical"), "cameraModel is 'fisheyeSpherical'; expected"),
    ("isaac", set_at("cameraFisheyeNominalHeight", value=900), "expected the proportions of the image"),
    ("woodscape", set_at("intrinsic", "model", value="pinhole"), "model is 'pinhole'; expected radial_poly"),
    ("woodscape", set_at("intrinsic", "k5", value=1.0), "unknown key 'k5'"),
    (
        "woodscape",
        set_at("extrinsic", "quaternion", value=[0, 0, 0, 2.0]),
        "quaternion of length 2; expected 1",
    ),
    ("nuscenes", set_at(1, "camera_intrinsic", 0, 1, value=2.0), "camera_intrinsic has skew"),
    ("nuscenes", set_at(1, "rotation", value=[0.5, 0, 0, 0]), "rotation is a quaternion of length 0.5"),
    ("argoverse", set_at("camera_data_", 1, "value", "skew_", value=1.0), "skew_ is 1.0; expected 0"),
    ("argoverse-two", set_at(0, "sensor_name", value="nobody"), "has no sensor nobody; expected its pose"),
]


@pytest.mark.parametrize(("name", "change", "reason"), REFUSED, ids=[f"{c[0]}: {c[2]}" for c in REFUSED])
def test_what_a_reader_has_no_lens_or_pose_for_is_one_line(
    tmp_path: Path, name: str, change: Change, reason: str
) -> None:
    with pytest.raises(InvalidInput, match=reason) as caught:
        loaded(name, change, tmp_path)
    assert caught.value.has_lines or str(caught.value).isprintable()  # what is unknown has several
    assert str(tmp_path) in str(caught.value)


def test_a_realsense_of_several_sizes_asks_for_one(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match='"Infrared 1" has 2 intrinsics; expected `size` one of 424x400'):
        loaded("realsense-d400", lambda text: text, tmp_path, size=None)
    assert loaded("realsense-d400", lambda text: text, tmp_path, size=(424, 400)).left.width == 424


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

    with pytest.raises(InvalidInput, match=r"holds 3 cameras; .*third(\.png)? \(baseline 0\.5 m, 100 %"):
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
