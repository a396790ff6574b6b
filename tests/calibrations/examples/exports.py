"""What people and small tools dump: NumPy archives, SimpleStereo, MultiCal, sections left and right."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np
import yaml

from tests.calibrations.calibration_files import D1, D2, K1, K2, R_RIGHT_LEFT, T_RIGHT_LEFT
from tests.calibrations.examples.made_up import (
    FISHEYES,
    FOCAL1,
    FOCAL2,
    PINHOLES,
    RADTAN1,
    RADTAN2,
    RATIONAL1,
    RATIONAL2,
    RATIONALS,
    SIZE,
    T_BODY_LEFT,
    T_BODY_RIGHT,
    T_RL,
    Example,
)


def archive(**arrays: Any) -> bytes:
    """What `np.savez` writes."""
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def numpy_archive() -> Example:
    """As people save what `cv2.fisheye.stereoCalibrate` gave them; the large arrays are not the rig's."""
    content = archive(
        mtx1=K1,
        dist1=D1.T,
        mtx2=np.asfortranarray(K2),
        dist2=D2.T,
        R=R_RIGHT_LEFT,
        T=T_RIGHT_LEFT[:, None],
        image_size=np.array(SIZE),
        model=np.array("fisheye"),
        corners=np.zeros((40, 54, 1, 2), np.float32),
        map_left=np.zeros((800, 848), np.float32),
    )
    return Example({"stereo.npz": content}, FISHEYES)


def python_names() -> Example:
    """As Python scripts name what `stereoCalibrate` gave them, in JSON."""
    content = {
        **{f"camera_matrix_{side}": K.tolist() for side, K in (("left", K1), ("right", K2))},
        **{f"dist_coeff_{side}": [D] for side, D in (("left", RATIONAL1), ("right", RATIONAL2))},
        "R": R_RIGHT_LEFT.tolist(),
        "T": T_RIGHT_LEFT[:, None].tolist(),
        "image_size": list(SIZE),
    }
    return Example({"stereo.json": json.dumps(content)}, RATIONALS)


def left_right() -> Example:
    def section(focal: list[float], radtan: list[float], T: np.ndarray) -> dict[str, Any]:
        return {
            "camera_model": "pinhole",
            "distortion_model": "radtan",
            "intrinsics": focal,
            "distortion_coeffs": [*radtan, 0.0],
            "resolution": list(SIZE),
            "T": T.tolist(),
        }

    content = {"left": section(FOCAL1, RADTAN1, np.eye(4)), "right": section(FOCAL2, RADTAN2, T_RL)}
    return Example({"stereo.yaml": yaml.safe_dump(content)}, PINHOLES)


def simplestereo() -> Example:
    """As `StereoRig.save` writes it, of a board in millimetres, which the file does not say."""
    content = {
        **{f"res{number}": list(SIZE) for number in (1, 2)},
        **{f"intrinsic{number}": K.tolist() for number, K in ((1, K1), (2, K2))},
        "R": R_RIGHT_LEFT.tolist(),
        "T": (1000 * T_RIGHT_LEFT[:, None]).tolist(),
        **{f"distCoeffs{number}": [[*D, 0.0]] for number, D in ((1, RADTAN1), (2, RADTAN2))},
        "F": np.eye(3).tolist(),
        "E": np.eye(3).tolist(),
        "reprojectionError": 0.21,
    }
    return Example({"rig.json": json.dumps(content)}, PINHOLES)


def multical() -> Example:
    """As its export writes it, the poses those of cameras in a rig."""

    def camera(K: np.ndarray, D: list[float]) -> dict[str, Any]:
        return {"model": "rational", "image_size": list(SIZE), "K": K.tolist(), "dist": [D]}

    def pose(T_rig_camera: np.ndarray) -> dict[str, Any]:
        T = np.linalg.inv(T_rig_camera)
        return {"R": T[:3, :3].tolist(), "T": T[:3, 3].tolist()}

    content = {
        "cameras": {"cam1": camera(K1, RATIONAL1), "cam2": camera(K2, RATIONAL2)},
        "camera_poses": {"cam1": pose(T_BODY_LEFT), "cam2": pose(T_BODY_RIGHT)},
        "image_sets": {"rgb": [{"cam1": "cam1/0001.png", "cam2": "cam2/0001.png"}]},
    }
    return Example({"calibration.json": json.dumps(content, indent=2)}, RATIONALS)


def multical_master() -> Example:
    """The poses in the frame of a master camera, and MultiCal's fisheye, which calls itself standard."""
    cameras = {
        name: {"model": "standard", "image_size": list(SIZE), "K": K.tolist(), "dist": D.T.tolist()}
        for name, K, D in (("cam1", K1, D1), ("cam2", K2, D2))
    }
    poses = {
        "cam1": {"R": np.eye(3).tolist(), "T": [0.0, 0.0, 0.0]},
        "cam2_to_cam1": {"R": R_RIGHT_LEFT.tolist(), "T": T_RIGHT_LEFT.tolist()},
    }
    content = {"cameras": cameras, "camera_poses": poses}
    return Example({"calibration.json": json.dumps(content, indent=2)}, FISHEYES)


EXAMPLES: dict[str, Example] = {
    "opencv-numpy": numpy_archive(),
    "opencv-python-names": python_names(),
    "left-right": left_right(),
    "simplestereo": simplestereo(),
    "multical": multical(),
    "multical-master": multical_master(),
}
