"""Rectification of omnidirectional cameras as OpenCV ships it: `cv2.omnidir`, in its four modes."""

from typing import Literal

import cv2
import numpy as np

import rectbench as rb

PI = 3.1415
"""As the module's documentation writes it."""
R_CYLINDER = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""The cylinder stands about the optical axis, z, and its middle looks along x."""
R_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""The middle of the stereographic image looks along -y."""


class Options(rb.Options):
    mode: Literal["longlati", "perspective", "cylindrical", "stereographic"] = rb.option(
        "longlati",
        "OpenCV's RECTIFY_...: longlati and perspective have epipolar rows, and its stereoReconstruct takes "
        "them; cylindrical, about the optical axis, and stereographic, about the vertical, have none",
    )


class OpenCVOmnidir(rb.Rectifier[Options]):
    """OpenCV's rotations and maps for the unified model, with the camera matrices that it recommends.

        longlati        û = f_x (γ + π/2)         v̂ = f_y (β + π/2)
        perspective     û = c_x + f_x x / z       v̂ = c_y + f_y y / z
        cylindrical     û = f_x atan2(y, x)       v̂ = f_y z / hypot(x, y)
        stereographic   û = 2 f_x x / (1 - y)     v̂ = 2 f_y z / (1 - y)     of unit rays

    The frame is the left camera's, turned so that x is the baseline and y at right angles to the optical
    axis: a baseline along that axis is refused. All images have the left one's size, wherever the view lies.
    """

    name = "opencv-omnidir"
    references = (
        "OpenCV, cv::omnidir::stereoRectify and cv::omnidir::initUndistortRectifyMap, module ccalib",
        "Mei and Rives, Single view point omnidirectional camera calibration from planar grids, ICRA 2007",
        "Li, Binocular spherical stereo, IEEE Transactions on Intelligent Transportation Systems 9(4), 2008",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig = problem.rig
        for camera in (rig.left, rig.right):
            if camera.model != "unified":
                raise rb.Unsupported(f"cv2.omnidir knows unified lenses; this one is {camera.model}")
        R1, R2 = cv2.omnidir.stereoRectify(rig.R_right_left, rig.t_right_left)
        if not np.isfinite([R1, R2]).all():
            raise rb.Unsupported(
                "cv2.omnidir.stereoRectify has no frame for a baseline along the optical axis"
            )
        size = width, height = rig.left.size
        K_new = new_camera_matrix(options.mode, width, height)
        R_mode, target = view(options.mode, K_new)
        left, right = rb.Warp(rig.left, R_mode @ R1, target), rb.Warp(rig.right, R_mode @ R2, target)
        return rb.Rectification(rig, left, right, size, {"mode": options.mode})


def new_camera_matrix(mode: str, width: int, height: int) -> np.ndarray:
    """K_new [3, 3] as recommended for an image of this size."""
    if mode == "perspective":
        return np.array([[width / 4, 0, width / 2], [0, height / 4, height / 2], [0, 0, 1.0]])
    return np.diag([width / PI, height / PI, 1.0])


def view(mode: str, K_new: np.ndarray) -> tuple[np.ndarray, rb.Target]:
    """The turn [3, 3] from the rectified frame to that of a mode's image, and the image."""
    fx, fy = float(K_new[0, 0]), float(K_new[1, 1])
    if mode == "perspective":
        return np.eye(3), rb.Perspective(K_new)
    if mode == "longlati":
        u, v = rb.Radial("equidistant", fx, fx * np.pi / 2), rb.Radial("equidistant", fy, fy * np.pi / 2)
        return np.eye(3), rb.Epipolar(u, v)
    if mode == "cylindrical":
        u, v = rb.Radial("equidistant", fx, 0.0), rb.Radial("cylindrical", fy, 0.0)
        return R_CYLINDER, rb.Upright(u, v)
    return R_UP, rb.Stereographic(1.0, 0.0, 0.0).framed(-0.5 / fx, -0.5 / fy, fx, fy)
