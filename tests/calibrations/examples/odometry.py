"""Examples of what odometry reads: Kalibr, OpenVINS, Basalt, VINS, ORB-SLAM, stella, OKVIS and maplab."""

from __future__ import annotations

import json

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from tests.calibrations.calibration_files import D1, D2, K1, K2
from tests.calibrations.examples.made_up import (
    DOUBLE_SPHERES,
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    KB,
    KITTI_RECTIFIED,
    PINHOLES,
    POSE_FILE,
    RADTAN,
    RADTAN1,
    RADTAN2,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    T_RL,
    UNIFIEDS,
    XI1,
    XI2,
    Example,
    matrix_block,
    rectification,
)


def quaternion(T: np.ndarray) -> dict[str, float]:
    x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat()
    px, py, pz = T[:3, 3]
    return {"px": px, "py": py, "pz": pz, "qx": x, "qy": y, "qz": z, "qw": w}


def kalibr_camera(model: str, distortion: str, intrinsics: list[float], coefficients: list[float]) -> dict:
    return {
        "camera_model": model,
        "distortion_model": distortion,
        "intrinsics": intrinsics,
        "distortion_coeffs": coefficients,
        "resolution": list(SIZE),
    }


def kalibr() -> Example:
    left = kalibr_camera("omni", "radtan", [XI1, *FOCAL1], RADTAN1)
    right = kalibr_camera("omni", "radtan", [XI2, *FOCAL2], RADTAN2)
    right["T_cn_cnm1"] = T_RL.tolist()
    return Example({"camchain.yaml": yaml.safe_dump({"cam0": left, "cam1": right})}, UNIFIEDS)


def openvins() -> Example:
    left = kalibr_camera("pinhole", "equidistant", FOCAL1, D1[0].tolist())
    right = kalibr_camera("pinhole", "equidistant", FOCAL2, D2[0].tolist())
    left["T_cam_imu"] = np.linalg.inv(T_BODY_LEFT).tolist()
    right["T_imu_cam"] = T_BODY_RIGHT.tolist()
    text = "%YAML:1.0 # need to specify the file type at the top!\n\n"
    return Example({"chain.yaml": text + yaml.safe_dump({"cam0": left, "cam1": right})}, FISHEYES)


def basalt() -> Example:
    cameras = [
        {
            "camera_type": "ds",
            "intrinsics": dict(zip((*FOCAL, "xi", "alpha"), (*focal, *numbers), strict=True)),
        }
        for focal, numbers in ((FOCAL1, (-0.2, 0.59)), (FOCAL2, (-0.19, 0.6)))
    ]
    content = {
        "T_imu_cam": [quaternion(T_BODY_LEFT), quaternion(T_BODY_RIGHT)],
        "intrinsics": cameras,
        "resolution": [list(SIZE), list(SIZE)],
        "calib_accel_bias": [0.0] * 9,
        "vignette": [],
    }
    return Example({"calibration.json": json.dumps({"value0": content}, indent=4)}, DOUBLE_SPHERES)


def camodocal_mei(xi: float, focal: list[float], radtan: list[float]) -> str:
    return (
        "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: camera\n"
        f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\nmirror_parameters:\n   xi: {xi!r}\n"
        "distortion_parameters:\n"
        + "".join(f"   {name}: {value!r}\n" for name, value in zip(RADTAN, radtan, strict=True))
        + "projection_parameters:\n"
        + "".join(
            f"   {name}: {value!r}\n"
            for name, value in zip(("gamma1", "gamma2", "u0", "v0"), map(float, focal), strict=True)
        )
    )


def camodocal_kannala_brandt(focal: list[float], radial: list[float]) -> str:
    names = ("k2", "k3", "k4", "k5", "mu", "mv", "u0", "v0")
    return (
        "%YAML:1.0\n---\nmodel_type: KANNALA_BRANDT\ncamera_name: camera\n"
        f"image_width: {SIZE[0]}\nimage_height: {SIZE[1]}\nprojection_parameters:\n"
        + "".join(
            f"   {name}: {float(value)!r}\n" for name, value in zip(names, (*radial, *focal), strict=True)
        )
    )


def vins() -> Example:
    config = (
        '%YAML:1.0\n\n#common parameters\nnum_of_cam: 2\nimage0_topic: "/left/image_raw"\n'
        'cam0_calib: "left.yaml"\ncam1_calib: "right.yaml"\n'
        "estimate_extrinsic: 0   # 0  Have an accurate extrinsic parameters.\n"
        + matrix_block("body_T_cam0", T_BODY_LEFT)
        + matrix_block("body_T_cam1", T_BODY_RIGHT)
    )
    files = {
        "config.yaml": config,
        "left.yaml": camodocal_kannala_brandt(FOCAL1, D1[0].tolist()),
        "right.yaml": camodocal_kannala_brandt(FOCAL2, D2[0].tolist()),
    }
    return Example(files, FISHEYES, ("config.yaml",))


def camodocal() -> Example:
    files = {
        "0.yaml": camodocal_mei(XI1, FOCAL1, RADTAN1),
        "1.yaml": camodocal_mei(XI2, FOCAL2, RADTAN2),
        "pose.yaml": POSE_FILE,
    }
    return Example(files, UNIFIEDS, tuple(files))


def euroc() -> Example:
    def text(focal: list[float], radtan: list[float], T: np.ndarray) -> str:
        data = ", ".join(map(repr, T.ravel().tolist()))
        return (
            "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
            f"T_BS:\n  cols: 4\n  rows: 4\n  data: [{data}]\n\nrate_hz: 20\n"
            f"resolution: {list(SIZE)}\ncamera_model: pinhole\nintrinsics: {focal} #fu, fv, cu, cv\n"
            f"distortion_model: radial-tangential\ndistortion_coefficients: {radtan}\n"
        )

    files = {
        "cam0/sensor.yaml": text(FOCAL1, RADTAN1, T_BODY_LEFT),
        "cam1/sensor.yaml": text(FOCAL2, RADTAN2, T_BODY_RIGHT),
    }
    return Example(files, PINHOLES, tuple(files))


def orbslam3() -> Example:
    lines = ['%YAML:1.0\nFile.version: "1.0"\nCamera.type: "KannalaBrandt8"']
    for number, focal, radial in ((1, FOCAL1, D1[0]), (2, FOCAL2, D2[0])):
        lines += [
            f"Camera{number}.{name}: {float(value)!r}"
            for name, value in zip((*FOCAL, *KB), (*focal, *radial), strict=True)
        ]
    lines += [f"Camera.width: {SIZE[0]}", f"Camera.height: {SIZE[1]}", "Stereo.ThDepth: 40.0"]
    pose = matrix_block("Stereo.T_c1_c2", np.linalg.inv(T_RL))
    return Example({"TUM-VI.yaml": "\n".join(lines) + "\n" + pose}, FISHEYES)


def orbslam2() -> Example:
    R1, R2, P1, P2 = rectification()
    text = "%YAML:1.0\nCamera.fx: 300.0\nCamera.bf: 33.0\n"
    for side, K, D, R, P in (("LEFT", K1, RADTAN1, R1, P1), ("RIGHT", K2, RADTAN2, R2, P2)):
        text += f"{side}.height: {SIZE[1]}\n{side}.width: {SIZE[0]}\n"
        text += matrix_block(f"{side}.D", np.array([[*D, 0.0]])).replace("data: [", "data:[")
        text += matrix_block(f"{side}.K", K) + matrix_block(f"{side}.R", R) + matrix_block(f"{side}.P", P)
    return Example({"EuRoC.yaml": text}, PINHOLES)


def stella() -> Example:
    R1, R2, _, P2 = rectification()
    content = {
        "Camera": {
            "name": "TUM VI stereo",
            "setup": "stereo",
            "model": "perspective",
            "fx": 300.0,
            "cols": SIZE[0],
            "rows": SIZE[1],
            "focal_x_baseline": float(-P2[0, 3]),
        },
        "StereoRectifier": {
            "model": "fisheye",
            **{f"K_{side}": K.ravel().tolist() for side, K in (("left", K1), ("right", K2))},
            **{f"D_{side}": D.ravel().tolist() for side, D in (("left", D1), ("right", D2))},
            **{f"R_{side}": R.ravel().tolist() for side, R in (("left", R1), ("right", R2))},
        },
    }
    return Example({"stereo.yaml": yaml.safe_dump(content)}, FISHEYES)


def ncamera_entry(focal: list[float], radial: list[float], T_body_camera: np.ndarray) -> dict:
    def column(numbers: list[float]) -> dict:
        return {"cols": 1, "rows": len(numbers), "data": numbers}

    return {
        "camera": {
            "label": "/cam",
            "image_height": SIZE[1],
            "image_width": SIZE[0],
            "type": "pinhole",
            "intrinsics": column(focal),
            "distortion": {"type": "equidistant", "parameters": column(radial)},
        },
        "T_B_C": {"cols": 4, "rows": 4, "data": T_body_camera.ravel().tolist()},
    }


def ncamera() -> Example:
    """As in svo_ros/param/calib/t265_stereo.yaml of rpg_svo_pro_open."""
    cameras = [
        ncamera_entry(FOCAL1, D1[0].tolist(), T_BODY_LEFT),
        ncamera_entry(FOCAL2, D2[0].tolist(), T_BODY_RIGHT),
    ]
    content = {"label": "rig", "cameras": cameras, "imu_params": {"g": 9.8082}}
    return Example({"stereo.yaml": yaml.safe_dump(content)}, FISHEYES)


def maplab() -> Example:
    """As in applications/rovioli/share/tumvi-stereo.yaml of maplab, the pose here the other way round."""
    cameras = [
        ncamera_entry(FOCAL1, D1[0].tolist(), T_BODY_LEFT),
        ncamera_entry(FOCAL2, D2[0].tolist(), T_BODY_RIGHT),
    ]
    for camera, T in zip(cameras, (T_BODY_LEFT, T_BODY_RIGHT), strict=True):
        del camera["T_B_C"]
        camera["T_C_B"] = np.linalg.inv(T).tolist()
    sensors = [{"sensor_type": "IMU", "id": "c63a"}, {"sensor_type": "NCAMERA", "cameras": cameras}]
    return Example({"sensors.yaml": yaml.safe_dump({"sensors": sensors})}, FISHEYES)


def okvis() -> Example:
    """As in config/hilti_challenge_2022.yaml of OKVIS2."""

    def entry(focal: list[float], radial: list[float], T_imu_camera: np.ndarray) -> str:
        return (
            f"     - {{T_SC:\n        {T_imu_camera.ravel().tolist()},\n"
            f"        image_dimension: {list(SIZE)},\n        distortion_coefficients: {radial},\n"
            f"        distortion_type: equidistant,\n        focal_length: {focal[:2]},\n"
            f"        principal_point: {focal[2:]},\n        camera_type: gray, #gray, rgb\n"
            "        slam_use: okvis}\n\n"
        )

    left, right = (
        entry(focal, radial[0].tolist(), T)
        for focal, radial, T in ((FOCAL1, D1, T_BODY_LEFT), (FOCAL2, D2, T_BODY_RIGHT))
    )
    text = f"%YAML:1.0\ncameras:\n{left}{right}imu_parameters:\n    use: true\n    g: 9.81007\n"
    return Example({"okvis.yaml": text}, FISHEYES)


def openvins_estimator() -> Example:
    """As in config/euroc_mav/estimator_config.yaml of OpenVINS, which leads to the chain."""
    text = (
        "%YAML:1.0 # need to specify the file type at the top!\n\nuse_stereo: true\nmax_cameras: 2\n"
        'relative_config_imu: "kalibr_imu_chain.yaml"\nrelative_config_imucam: "chain.yaml"\n'
    )
    return Example({"estimator_config.yaml": text, **openvins().files}, FISHEYES, ("estimator_config.yaml",))


def vins_mono() -> Example:
    """Two configurations of VINS-Mono, a camera each."""
    files = {
        name: camodocal_mei(xi, focal, radtan)
        + matrix_block("extrinsicRotation", T[:3, :3])
        + matrix_block("extrinsicTranslation", T[:3, 3:])
        for name, xi, focal, radtan, T in (
            ("0.yaml", XI1, FOCAL1, RADTAN1, T_BODY_LEFT),
            ("1.yaml", XI2, FOCAL2, RADTAN2, T_BODY_RIGHT),
        )
    }
    return Example(files, UNIFIEDS, tuple(files))


def orbslam2_rectified() -> Example:
    """As ORB-SLAM2's KITTI00-02.yaml."""
    text = (
        "%YAML:1.0\nCamera.fx: 718.856\nCamera.fy: 718.856\nCamera.cx: 607.1928\nCamera.cy: 185.2157\n"
        "Camera.k1: 0.0\nCamera.k2: 0.0\nCamera.p1: 0.0\nCamera.p2: 0.0\n"
        "Camera.width: 1241\nCamera.height: 376\nCamera.bf: 386.1448\n"
    )
    return Example({"KITTI00-02.yaml": text}, KITTI_RECTIFIED)


def stella_rectified() -> Example:
    """As KITTI_stereo_00-02.yaml of stella_vslam."""
    camera = {
        "setup": "stereo",
        "model": "perspective",
        "fx": 718.856,
        "fy": 718.856,
        "cx": 607.1928,
        "cy": 185.2157,
    }
    camera |= {"k1": 0.0, "k2": 0.0, "p1": 0.0, "p2": 0.0, "k3": 0.0}
    camera |= {"cols": 1241, "rows": 376, "focal_x_baseline": 386.1448}
    return Example({"KITTI_stereo.yaml": yaml.safe_dump({"Camera": camera})}, KITTI_RECTIFIED)


EXAMPLES: dict[str, Example] = {
    "kalibr": kalibr(),
    "openvins": openvins(),
    "openvins-estimator": openvins_estimator(),
    "basalt": basalt(),
    "vins": vins(),
    "camodocal": camodocal(),
    "camodocal-vins-mono": vins_mono(),
    "euroc": euroc(),
    "orbslam3": orbslam3(),
    "orbslam2": orbslam2(),
    "orbslam2-rectified": orbslam2_rectified(),
    "stella": stella(),
    "stella-rectified": stella_rectified(),
    "ncamera": ncamera(),
    "ncamera-maplab": maplab(),
    "okvis": okvis(),
}
