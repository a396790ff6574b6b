"""OpenCV's rectification of a calibrated pair, as it ships it."""

from typing import Literal

import cv2
import numpy as np

import rectbench as rb

COEFFICIENTS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")


class Options(rb.Options):
    alpha: float = rb.option(
        -1.0, "0 shows valid pixels only, 1 all of the source, -1 is OpenCV's default scale", ge=-1, le=1
    )
    principal_points: Literal["same", "free"] = rb.option(
        "same", "whether both have one principal point (OpenCV's CALIB_ZERO_DISPARITY)"
    )


class OpenCVStereoRectify(rb.HomographyRectifier[Options]):
    """`cv2.stereoRectify`, its images where it puts them.

    Takes a pinhole lens with its own matrix and coefficients, any other as it is undistorted. Cameras one
    above the other get columns that correspond instead of rows, and are refused.
    """

    name = "opencv-stereo-rectify"
    references = (
        "OpenCV, stereoRectify",
        "Bouguet, Camera Calibration Toolbox for Matlab, 2004",
    )
    needs = frozenset({"pose"})

    def homographies(
        self, view: rb.PinholeView, options: Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        rig = view.problem.rig
        lenses = (lens if lens.model == "pinhole" else view.camera for lens in (rig.left, rig.right))
        (K_left, D_left), (K_right, D_right) = (opencv_lens(lens) for lens in lenses)
        R_left, R_right, P_left, P_right, *_ = cv2.stereoRectify(
            K_left,
            D_left,
            K_right,
            D_right,
            view.size,
            rig.R_right_left,
            rig.t_right_left[:, None],
            flags=cv2.CALIB_ZERO_DISPARITY if options.principal_points == "same" else 0,
            alpha=options.alpha,
        )
        if P_right[1, 3] != 0:
            raise rb.Unsupported(
                "OpenCV lays the baseline of cameras one above the other along the columns; expected cameras "
                "side by side"
            )
        K_inverse = np.linalg.inv(view.K)
        H_left, H_right = P_left[:, :3] @ R_left @ K_inverse, P_right[:, :3] @ R_right @ K_inverse
        return H_left, H_right, {"focal_px": float(P_left[0, 0])}

    def placement(self, view: rb.PinholeView, H_left: np.ndarray, H_right: np.ndarray) -> np.ndarray:
        return np.eye(3)


def opencv_lens(camera: rb.Camera) -> tuple[np.ndarray, np.ndarray]:
    """OpenCV's camera matrix [3, 3] and distortion coefficients [12] of a pinhole lens."""
    p = camera.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
    return K, np.array([p.get(name, 0.0) for name in COEFFICIENTS])
