"""What photogrammetry and radiance fields write: Metashape, OpenMVG, Meshroom, transforms.json."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np

from rectbench import Camera, Rig
from tests.calibrations.calibration_files import D1, D2, R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL,
    FOCAL1,
    FOCAL2,
    KB,
    RADTAN1,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    Example,
    rig,
)

WIDTH, HEIGHT = SIZE
CHUNK_SCALE = 2.5


def one_focal(model: str, focal: list[float], names: tuple[str, ...], numbers: list[float]) -> Camera:
    """A camera whose focal length is the first of the two."""
    f, _, cx, cy = focal
    return Camera(model, SIZE, dict(zip((*FOCAL, *names), (f, f, cx, cy, *numbers), strict=True)))


def metashape_sensor(number: int, kind: str, focal: list[float], terms: dict[str, float]) -> str:
    fx, fy, cx, cy = focal
    numbers = {"f": fy, "cx": cx + 0.5 - WIDTH / 2, "cy": cy + 0.5 - HEIGHT / 2, "b1": fx - fy, **terms}
    resolution = f'<resolution width="{WIDTH}" height="{HEIGHT}"/>'
    return (
        f'<sensor id="{number}" label="lens {number}" type="{kind}">{resolution}'
        '<property name="layer_index" value="0"/>'
        f'<calibration type="{kind}" class="initial">{resolution}<f>300</f></calibration>'
        f'<calibration type="{kind}" class="adjusted">{resolution}'
        + "".join(f"<{name}>{value!r}</{name}>" for name, value in numbers.items())
        + "</calibration><covariance><params>f cx cy</params></covariance></sensor>\n"
    )


def metashape_text(sensors: list[str], poses: list[np.ndarray], component: str) -> str:
    cameras = "".join(
        f'<camera id="{number}" sensor_id="{number}" component_id="0" label="{label}">'
        f"<transform>{' '.join(map(repr, T.ravel().tolist()))}</transform></camera>\n"
        for number, (label, T) in enumerate(zip(("left", "right"), poses, strict=True))
    )
    lost = '<camera id="2" sensor_id="0" label="not aligned"/>\n'
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<document version="2.0.0">\n'
        '<chunk label="Chunk 1" enabled="true">\n'
        f'<sensors next_id="2">\n{"".join(sensors)}</sensors>\n'
        f'<components next_id="1"><component id="0" label="one">{component}</component></components>\n'
        f'<cameras next_id="3" next_group_id="1">\n<group id="0" label="rig" type="folder">\n{lost}{cameras}'
        "</group></cameras>\n</chunk>\n</document>\n"
    )


def scaled(T: np.ndarray, scale: float) -> np.ndarray:
    T = T.copy()
    T[:3, 3] *= scale
    return T


METASHAPE_TERMS = (
    {"b2": 1.5, "k1": -0.28, "k2": 0.07, "k3": 1e-3, "k4": 2e-4, "p1": 2e-4, "p2": -3e-4},
    {"k1": -0.03, "k3": 2e-4},
)


def metashape() -> Example:
    """Frame sensors, one of them skewed, in a component that makes its lengths metres."""
    sensors = [
        metashape_sensor(number, "frame", focal, terms)
        for number, (focal, terms) in enumerate(zip((FOCAL1, FOCAL2), METASHAPE_TERMS, strict=True))
    ]
    turned = " ".join(map(repr, T_BODY_LEFT[:3, :3].ravel().tolist()))
    component = (
        f"<transform><rotation>{turned}</rotation><translation>1 2 3</translation>"
        f"<scale>{CHUNK_SCALE!r}</scale></transform>"
    )
    poses = [scaled(T, 1 / CHUNK_SCALE) for T in (T_BODY_LEFT, T_BODY_RIGHT)]
    one, two = METASHAPE_TERMS
    left = {"skew": one["b2"], "p1": one["p2"], "p2": one["p1"]}
    left |= {name: one[name] for name in ("k1", "k2", "k3", "k4")}
    cameras = (
        Camera("radial-tangential", SIZE, dict(zip(FOCAL, FOCAL1, strict=True)) | left),
        Camera("pinhole", SIZE, dict(zip(FOCAL, FOCAL2, strict=True)) | two),
    )
    return Example({"cameras.xml": metashape_text(sensors, poses, component)}, rig(*cameras))


def metashape_fisheye() -> Example:
    """Fisheyes, one with tangential terms, and no scale: the chunk's lengths are taken for metres."""
    terms: list[dict[str, float]] = [dict(zip(KB, D[0].tolist(), strict=True)) for D in (D1, D2)]
    sensors = [
        metashape_sensor(0, "fisheye", FOCAL1, terms[0] | {"b2": -0.7}),
        metashape_sensor(1, "fisheye", FOCAL2, terms[1] | {"p1": 1e-3, "p2": -2e-3}),
    ]
    focal = [dict(zip(FOCAL, numbers, strict=True)) for numbers in (FOCAL1, FOCAL2)]
    cameras = (
        Camera("kannala-brandt", SIZE, focal[0] | terms[0] | {"skew": -0.7}),
        Camera("thin-prism-fisheye", SIZE, focal[1] | terms[1] | {"p1": -2e-3, "p2": 1e-3}),
    )
    return Example({"cameras.xml": metashape_text(sensors, [T_BODY_LEFT, T_BODY_RIGHT], "")}, rig(*cameras))


Y_UP_Z_BACK = np.diag([1.0, -1.0, -1.0, 1.0])


def transforms() -> Example:
    """As ns-process-data writes it: a lens in each frame, COLMAP's half pixel, y up and z back."""
    frames = [
        {
            "file_path": f"images/{name}",
            "w": WIDTH,
            "h": HEIGHT,
            "fl_x": focal[0],
            "fl_y": focal[1],
            "cx": focal[2] + 0.5,
            "cy": focal[3] + 0.5,
            **dict(zip(KB, D[0].tolist(), strict=True)),
            "transform_matrix": (T @ Y_UP_Z_BACK).tolist(),
            "colmap_im_id": 1,
        }
        for name, focal, D, T in (
            ("left.png", FOCAL1, D1, T_BODY_LEFT),
            ("right.png", FOCAL2, D2, T_BODY_RIGHT),
        )
    ]
    content = {
        "camera_model": "OPENCV_FISHEYE",
        "frames": frames,
        "applied_transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]],
        "ply_file_path": "sparse_pc.ply",
    }
    return Example({"transforms.json": json.dumps(content, indent=4)}, FISHEYES)


def transforms_ngp() -> Example:
    """As instant-ngp's colmap2nerf.py writes it: one lens at the top, and the field of view that it has."""
    fx, fy, cx, cy = FOCAL1
    content = {
        "camera_angle_x": float(2 * np.arctan(WIDTH / (2 * fx))),
        "camera_angle_y": float(2 * np.arctan(HEIGHT / (2 * fy))),
        "fl_x": fx,
        "fl_y": fy,
        **dict(zip(("k1", "k2", "p1", "p2"), RADTAN1, strict=True)),
        "k3": 0,
        "k4": 0,
        "is_fisheye": False,
        "cx": cx + 0.5,
        "cy": cy + 0.5,
        "w": float(WIDTH),
        "h": float(HEIGHT),
        "aabb_scale": 32,
        "frames": [
            {
                "file_path": f"./images/{name}.jpg",
                "sharpness": 217.3,
                "transform_matrix": (T @ Y_UP_Z_BACK).tolist(),
            }
            for name, T in (("a", T_BODY_LEFT), ("b", T_BODY_RIGHT))
        ],
    }
    lens = Camera(
        "pinhole", SIZE, dict(zip((*FOCAL, "k1", "k2", "p1", "p2"), (*FOCAL1, *RADTAN1), strict=True))
    )
    return Example({"transforms.json": json.dumps(content, indent=2)}, rig(lens, lens))


F_THETA_POLY = [0.0, 3.4e-3, 2.1e-7, 1.6e-9, -4e-13]


def transforms_f_theta() -> Example:
    """As instant-ngp takes f-theta lenses: the angle by powers of the pixels."""
    content = {
        **{f"ftheta_p{power}": number for power, number in enumerate(F_THETA_POLY)},
        **{"w": WIDTH, "h": HEIGHT, "cx": FOCAL1[2] + 0.5, "cy": FOCAL1[3] + 0.5},
        "rolling_shutter": [0.0, 0.0, 0.0],
        "frames": [
            {"file_path": f"images/{name}.png", "transform_matrix": (T @ Y_UP_Z_BACK).tolist()}
            for name, T in (("a", T_BODY_LEFT), ("b", T_BODY_RIGHT))
        ],
    }
    params = {"cx": FOCAL1[2], "cy": FOCAL1[3], "angle_poly": F_THETA_POLY[1:]}
    lens = Camera("f-theta", SIZE, params)
    return Example({"transforms.json": json.dumps(content)}, rig(lens, lens))


def openmvg() -> Example:
    """As openMVG_main_ConvertSfM_DataFormat writes it: a class's name stands where it comes first."""

    def pointer(number: int, data: dict[str, Any]) -> dict[str, Any]:
        return {"ptr_wrapper": {"id": number, "data": data}}

    def view(number: int, name: str) -> dict[str, Any]:
        data = {"local_path": "", "filename": name, "width": WIDTH, "height": HEIGHT}
        data |= {"id_view": number, "id_intrinsic": number, "id_pose": number}
        return {"key": number, "value": {"polymorphic_id": 1 << 30} | pointer((1 << 31) + number, data)}

    def intrinsic(number: int, focal: list[float], D: np.ndarray) -> dict[str, Any]:
        base = {"value0": {"width": WIDTH, "height": HEIGHT}, "focal_length": focal[0]}
        data = {"value0": base | {"principal_point": focal[2:]}, "fisheye": D[0].tolist()}
        kind: dict[str, Any] = {"polymorphic_id": 2}
        if number == 0:
            kind = {"polymorphic_id": (1 << 31) + 2, "polymorphic_name": "fisheye"}
        return {"key": number, "value": kind | pointer((1 << 31) + 10 + number, data)}

    def extrinsic(number: int, T: np.ndarray) -> dict[str, Any]:
        value = {"rotation": T[:3, :3].T.tolist(), "center": T[:3, 3].tolist()}
        return {"key": number, "value": value}

    content = {
        "sfm_data_version": "0.3",
        "root_path": "/images",
        "views": [view(5, "nowhere.jpg"), view(0, "left.jpg"), view(1, "right.jpg")],
        "intrinsics": [intrinsic(0, FOCAL1, D1), intrinsic(1, FOCAL2, D2)],
        "extrinsics": [extrinsic(0, T_BODY_LEFT), extrinsic(1, T_BODY_RIGHT)],
        "structure": [],
        "control_points": [],
    }
    cameras = [one_focal("kannala-brandt", f, KB, D[0].tolist()) for f, D in ((FOCAL1, D1), (FOCAL2, D2))]
    return Example({"sfm_data.json": json.dumps(content, indent=1)}, rig(*cameras))


SENSOR_MM, PIXEL_RATIO = 36.0, 1.01
BROWN1, BROWN2 = [-0.2, 0.05, 1e-4, 3e-4, -2e-4], [-0.21, 0.04, 0.0, -1e-4, 2e-4]
BROWN = ("k1", "k2", "k3", "p1", "p2")


def alicevision_pose(T_camera_world: np.ndarray) -> dict[str, Any]:
    """Words, the rotation by columns, and the centre."""
    R = T_camera_world[:3, :3]
    centre = -R.T @ T_camera_world[:3, 3]
    return {"rotation": list(map(repr, R.T.ravel().tolist())), "center": list(map(repr, centre.tolist()))}


def alicevision() -> Example:
    """As Meshroom's StructureFromMotion writes it since version 1.2.5: words, millimetres, offsets."""

    def intrinsic(number: int, focal: list[float], brown: list[float]) -> dict[str, Any]:
        return {
            "intrinsicId": str(3171410960 + number),
            "width": str(WIDTH),
            "height": str(HEIGHT),
            "sensorWidth": repr(SENSOR_MM),
            "sensorHeight": "24",
            "serialNumber": "",
            "type": "pinhole",
            "initializationMode": "estimated",
            "initialFocalLength": "-1",
            "focalLength": repr(focal[0] * SENSOR_MM / WIDTH),
            "pixelRatio": repr(PIXEL_RATIO),
            "pixelRatioLocked": "true",
            "principalPoint": [repr(focal[2] - WIDTH / 2), repr(focal[3] - HEIGHT / 2)],
            "distortionInitializationMode": "none",
            "distortionParams": list(map(repr, brown)),
            "undistortionOffset": ["0", "0"],
            "undistortionParams": "",
            "distortionType": "brown",
            "undistortionType": "none",
            "locked": "false",
        }

    def view(number: int, name: str) -> dict[str, Any]:
        ids = {"viewId": str(1808829010 + number), "poseId": str(1808829010 + number)}
        return ids | {
            "intrinsicId": str(3171410960 + number),
            "path": f"/images/{name}",
            "width": str(WIDTH),
            "height": str(HEIGHT),
            "metadata": {"AliceVision:SensorWidth": "36"},
        }

    poses = [
        {"poseId": str(1808829010 + number), "pose": {"transform": alicevision_pose(T), "locked": "0"}}
        for number, T in enumerate((np.linalg.inv(T_BODY_LEFT), np.linalg.inv(T_BODY_RIGHT)))
    ]
    content = {
        "version": ["1", "2", "8"],
        "views": [view(0, "left.jpg"), view(1, "right.jpg"), view(2, "lost.jpg")],
        "intrinsics": [intrinsic(0, FOCAL1, BROWN1), intrinsic(1, FOCAL2, BROWN2)],
        "poses": poses,
    }
    cameras = [
        replace(camera, params={**camera.params, "fy": camera.params["fx"] * PIXEL_RATIO})
        for camera in (
            one_focal("pinhole", FOCAL1, BROWN, BROWN1),
            one_focal("pinhole", FOCAL2, BROWN, BROWN2),
        )
    ]
    return Example({"cameras.sfm.json": json.dumps(content, indent=4)}, rig(*cameras))


def alicevision_rig() -> Example:
    """Version 1.1: pixels alone, types that name the distortion, and two cameras of a rig."""

    def intrinsic(number: int, kind: str, focal: list[float], numbers: list[float]) -> dict[str, Any]:
        return {
            "intrinsicId": number,
            "width": WIDTH,
            "height": HEIGHT,
            "serialNumber": "",
            "type": kind,
            "pxFocalLength": focal[0],
            "principalPoint": focal[2:],
            "distortionParams": numbers,
        }

    views = [
        {"viewId": 10 + n, "poseId": 7, "rigId": 3, "subPoseId": n, "isPoseIndependant": False}
        | {"intrinsicId": n, "path": name, "width": WIDTH, "height": HEIGHT}
        for n, name in enumerate(("a.png", "b.png"))
    ]
    inner = np.linalg.inv(T_BODY_LEFT)
    outer = np.linalg.inv(T_BODY_RIGHT) @ T_BODY_LEFT @ inner
    sub_poses = [{"status": "estimated", "pose": alicevision_pose(T)} for T in (inner, outer)]
    content = {
        "version": [1, 1, 0],
        "views": views,
        "intrinsics": [
            intrinsic(0, "fisheye4", FOCAL1, D1[0].tolist()),
            intrinsic(1, "fisheye1", FOCAL2, [0.9]),
        ],
        "poses": [{"poseId": 7, "pose": {"transform": alicevision_pose(T_BODY_RIGHT)}}],
        "rigs": [{"rigId": 3, "subPoses": sub_poses}],
    }
    cameras = (
        one_focal("kannala-brandt", FOCAL1, KB, D1[0].tolist()),
        one_focal("field-of-view", FOCAL2, ("omega",), [0.9]),
    )
    return Example({"sfm.json": json.dumps(content)}, Rig(*cameras, R_RIGHT_LEFT, T_RIGHT_LEFT))


EXAMPLES: dict[str, Example] = {
    "metashape": metashape(),
    "metashape-fisheye": metashape_fisheye(),
    "transforms": transforms(),
    "transforms-ngp": transforms_ngp(),
    "transforms-f-theta": transforms_f_theta(),
    "openmvg": openmvg(),
    "alicevision": alicevision(),
    "alicevision-rig": alicevision_rig(),
}
