"""Numbers of a made-up fisheye rig, and the files that OpenCV writes of it."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

R_RIGHT_LEFT = Rotation.from_euler("xyz", [0.7, -1.3, 2.1], degrees=True).as_matrix()
T_RIGHT_LEFT = np.array([-0.11, 0.002, -0.0005])
K1 = np.array([[285.722, 0, 420.135], [0, 286.759, 403.394], [0, 0, 1]])
K2 = np.array([[284.941, 0, 428.131], [0, 286.004, 398.914], [0, 0, 1]])
D1 = np.array([[-0.0066, 0.0473, -0.0458, 0.0090]])
D2 = np.array([[-0.0059, 0.0437, -0.0413, 0.0075]])
INTRINSICS = {"K1": K1, "D1": D1, "K2": K2, "D2": D2}
POSE = {"R": R_RIGHT_LEFT, "T": T_RIGHT_LEFT}
IMAGE = {"image_width": 848, "image_height": 800}
WHOLE_RIG = {"model": "fisheye", **IMAGE, **INTRINSICS, **POSE}


def opencv_file(suffix: str = ".yml", **entries: Any) -> str:
    """What cv2.FileStorage writes for these keys."""
    storage = cv2.FileStorage(f"rig{suffix}", cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    for key, value in entries.items():
        storage.write(key, value)
    return storage.releaseAndGetString()
