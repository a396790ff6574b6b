"""Examples of what devices come with: RealSense, Project Aria, Facebook's camera rigs."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench import Camera
from tests.calibrations.calibration_files import D1, D2
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    KB,
    PINHOLES,
    RADTAN1,
    RADTAN2,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    T_RL,
    Example,
    rig,
)


def realsense_intrinsic(
    name: str, size: tuple[int, int], formats: str, focal: list[float], distortion: str, numbers: list[float]
) -> str:
    fx, fy, cx, cy = focal
    coefficients = "".join(f"\t{number!r}  " for number in numbers)
    return (
        f' Intrinsic of "{name}" / {size[0]}x{size[1]} / {{{formats}}}\n'
        f"  Width:      \t{size[0]}\n  Height:     \t{size[1]}\n  PPX:        \t{cx!r}\n"
        f"  PPY:        \t{cy!r}\n  Fx:         \t{fx!r}\n  Fy:         \t{fy!r}\n"
        f"  Distortion: \t{distortion}\n  Coeffs:     {coefficients}\n  FOV (deg):  \t111.9 x 108.7\n\n"
    )


def realsense_extrinsic(left: str, right: str, T: np.ndarray) -> str:
    rows = "".join("".join(f"  {number!r} " for number in row) + "\n" for row in T[:3, :3].tolist())
    shift = "  ".join(map(repr, T[:3, 3].tolist()))
    return (
        f'Extrinsic from "{left}"\t  To\t  "{right}" :\n Rotation Matrix:\n{rows}\n'
        f" Translation Vector: {shift}  \n\n"
    )


REALSENSE_HEAD = (
    "Device info: \n    Name                          : \tIntel RealSense T265\n\n"
    "Stream Profiles supported by Tracking Module\n Supported modes:\n"
    "    stream       resolution      fps       format   \n    Fisheye 1      848x800\t@ 30Hz\t   Y8\n\n"
    "Intrinsic Parameters:\n\n"
)
MOTION = (
    'Motion Intrinsic Parameters:\n\nMotion Intrinsic of "Gyro"\t  MOTION_XYZ32F\nBias Variances: \t'
    "0.0001  0.0001  0.0001  \nNoise Variances: \t0.0  0.0  0.0  \nSensitivity : \n    1.0  0.0  0.0\n\n\n"
)


def realsense() -> Example:
    """A T265, as `rs-enumerate-devices -c` prints it, with its gyroscope among the extrinsics."""
    text = REALSENSE_HEAD
    for number, focal, D in ((1, FOCAL1, D1), (2, FOCAL2, D2)):
        coefficients = [*D[0].tolist(), 0]
        text += realsense_intrinsic(f"Fisheye {number}", SIZE, "Y8", focal, "Kannala Brandt4", coefficients)
    text += MOTION + "\nExtrinsic Parameters:\n"
    text += realsense_extrinsic("Fisheye 1", "Fisheye 1", np.eye(4))
    text += realsense_extrinsic("Fisheye 1", "Gyro", T_BODY_LEFT)
    text += realsense_extrinsic("Fisheye 2", "Fisheye 1", np.linalg.inv(T_RL))
    return Example({"t265.txt": text}, FISHEYES)


def realsense_d400() -> Example:
    """A D435's colour and infrared cameras in two sizes, of which one is asked for."""
    text = REALSENSE_HEAD.replace("T265", "D435")
    for size, scale in (((424, 400), 0.5), (SIZE, 1.0)):
        for name, focal, radtan in (
            ("Color", FOCAL2, [0.0] * 4),
            ("Infrared 1", FOCAL1, RADTAN1),
            ("Infrared 2", FOCAL2, RADTAN2),
        ):
            kind = "Inverse Brown Conrady" if name == "Color" else "Brown Conrady"
            numbers = [scale * number for number in focal]
            text += realsense_intrinsic(name, size, "Y8/Y16", numbers, kind, [*radtan, 0.0])
    text += ' Intrinsic of "Depth" / 848x800 / {Z16}\nIntrinsic NOT available!\n\n\nExtrinsic Parameters:\n'
    text += realsense_extrinsic("Infrared 1", "Color", T_BODY_LEFT)
    text += realsense_extrinsic("Infrared 1", "Infrared 2", T_RL)
    asked = {"size": SIZE, "cameras": ["Infrared 1", "Infrared 2"]}
    return Example({"d435.txt": text}, PINHOLES, options=asked)


def rs2_stream(focal: list[float], model: str, numbers: list[float]) -> dict[str, Any]:
    fx, fy, ppx, ppy = focal
    return {
        **{"width": SIZE[0], "height": SIZE[1], "fx": fx, "fy": fy, "ppx": ppx, "ppy": ppy},
        **{"model": f"distortion.{model}", "coeffs": numbers},
    }


def realsense_json() -> Example:
    """As people dump what pyrealsense2 gives of a T265; the rotation is stored by columns."""
    streams = {
        f"fisheye_{number}": rs2_stream(focal, "kannala_brandt4", [*D[0].tolist(), 0.0])
        for number, focal, D in ((1, FOCAL1, D1), (2, FOCAL2, D2))
    }
    back = np.linalg.inv(T_RL)
    pose = {"rotation": back[:3, :3].T.ravel().tolist(), "translation": back[:3, 3].tolist()}
    content = {"serial": "1", "intrinsics": streams, "extrinsics": {"fisheye_2_to_fisheye_1": pose}}
    return Example({"t265.json": json.dumps(content)}, FISHEYES)


def realsense_json_plain() -> Example:
    """The same of a pair of infrared cameras, with one extrinsics that does not say where it leads."""
    content = {
        "left": {"intrinsics": rs2_stream(FOCAL1, "brown_conrady", [*RADTAN1, 0.0])},
        "right": {"intrinsics": rs2_stream(FOCAL2, "brown_conrady", [*RADTAN2, 0.0])},
        "extrinsics": {"rotation": T_RL[:3, :3].tolist(), "translation": T_RL[:3, 3].tolist()},
    }
    return Example({"d435.json": json.dumps(content)}, PINHOLES)


ARIA1 = [285.7, 420.1, 403.4, -0.02, 0.05, -0.04, 0.009, 1e-3, -2e-4, 1e-3, -2e-3, 3e-4, -1e-4, 2e-4, 1e-4]
ARIA2 = [284.9, 428.1, 398.9, -0.01, 0.04, -0.03, 0.007, 2e-3, -1e-4, 2e-3, -1e-3, 1e-4, -2e-4, 3e-4, 2e-4]
FISHEYE624 = ("k0", "k1", "k2", "k3", "k4", "k5", "p0", "p1", "s0", "s1", "s2", "s3")


def aria() -> Example:
    """As a VRS file holds it, the right camera first, and the RGB camera that is not of the pair."""

    def entry(label: str, params: list[float], T: np.ndarray) -> dict[str, Any]:
        x, y, z, w = Rotation.from_matrix(T[:3, :3]).as_quat().tolist()
        return {
            "Calibrated": True,
            "Label": label,
            "Projection": {"Name": "FisheyeRadTanThinPrism", "Description": "see ...", "Params": params},
            "T_Device_Camera": {"Translation": T[:3, 3].tolist(), "UnitQuaternion": [w, [x, y, z]]},
            "SerialNumber": "0072510f1b210703030b",
        }

    content = {
        "CameraCalibrations": [
            entry("camera-rgb", ARIA1, np.eye(4)),
            entry("camera-slam-right", ARIA2, T_BODY_RIGHT),
            entry("camera-slam-left", ARIA1, T_BODY_LEFT),
        ],
        "ImuCalibrations": [],
        "DeviceClassInfo": {"BuildVersion": "DVT", "DeviceClass": "Aria"},
    }
    left, right = (
        Camera(
            "fisheye624",
            SIZE,
            {"fx": f, "fy": f, "cx": cx, "cy": cy} | dict(zip(FISHEYE624, rest, strict=True)),
        )
        for f, cx, cy, *rest in (ARIA1, ARIA2)
    )
    asked = {"size": SIZE, "cameras": ["camera-slam-left", "camera-slam-right"]}
    return Example({"calib.json": json.dumps(content)}, rig(left, right), options=asked)


def facebook360() -> Example:
    """As facebook360_dep saves a rig: pixels from the image's corner, y up on the sensor, metres."""

    def entry(name: str, focal: list[float], D: np.ndarray, T: np.ndarray) -> dict[str, Any]:
        fx, fy, cx, cy = focal
        right, down, forward = T[:3, :3].T
        return {
            "version": 1,
            "type": "FTHETA",
            "id": name,
            "group": "side camera",
            "origin": T[:3, 3].tolist(),
            "right": right.tolist(),
            "up": (-down).tolist(),
            "forward": forward.tolist(),
            "resolution": list(SIZE),
            "principal": [cx + 0.5, cy + 0.5],
            "focal": [fx, -fy],
            "distortion": D[0, :3].tolist(),
            "fov": 1.4,
        }

    content = {"cameras": [entry("cam0", FOCAL1, D1, T_BODY_LEFT), entry("cam1", FOCAL2, D2, T_BODY_RIGHT)]}
    left, right = (
        Camera(
            "kannala-brandt",
            SIZE,
            dict(zip((*FOCAL, *KB[:3]), (*focal, *D[0, :3]), strict=True)),
            max_angle_deg=np.degrees(1.4),
        )
        for focal, D in ((FOCAL1, D1), (FOCAL2, D2))
    )
    return Example({"rig.json": json.dumps(content)}, rig(left, right))


EXAMPLES: dict[str, Example] = {
    "realsense": realsense(),
    "realsense-d400": realsense_d400(),
    "realsense-json": realsense_json(),
    "realsense-json-plain": realsense_json_plain(),
    "aria": aria(),
    "facebook360": facebook360(),
}
