"""What a file says of a lens or a pose and rectbench does not hold is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from rectbench import InvalidInput
from tests.calibrations.changed_examples import Change, loaded, put, set_at

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
