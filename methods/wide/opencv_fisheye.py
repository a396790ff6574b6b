"""Perspective rectification of fisheye lenses as OpenCV ships it: `cv2.fisheye.stereoRectify`."""

import cv2
import numpy as np

import rectbench as rb

LENSES = {"kannala-brandt": ("k1", "k2", "k3", "k4"), "equidistant": ()}
"""What cv2.fisheye knows, and the coefficients by their names here."""
FOCAL_SHARES, LEAST_SHOWN = (0.05, 20.0), 0.1
"""Focal lengths, as shares of the source's resolution, and shares of its pixels, that are no accident."""


class Options(rb.Options):
    balance: float = rb.option(
        0.0, "OpenCV's balance: 0 the longest focal length, 1 the shortest, which shows the most", ge=0, le=1
    )
    fov_scale: float = rb.option(1.0, "OpenCV's divisor of the focal length", gt=0)


class OpenCVFisheye(rb.Rectifier[Options]):
    """OpenCV's rotations and new camera matrices, for lenses after Kannala and Brandt: û = c_x + f x/z.

    It sizes the image by the middles of the source's edges; of lenses of 180° and more these have no place in
    a plane, and what comes out is refused where it shows next to nothing. Both principal points agree
    (CALIB_ZERO_DISPARITY, as in OpenCV's samples).
    """

    name = "opencv-fisheye"
    references = (
        "OpenCV, cv::fisheye::stereoRectify and cv::fisheye::initUndistortRectifyMap, module calib3d",
        "Kannala and Brandt, A generic camera model and calibration method for conventional, wide-angle, and "
        "fish-eye lenses, PAMI 28(8), 2006",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        rig = problem.rig
        if rig.left.size != rig.right.size:
            raise rb.Unsupported(
                f"cv2.fisheye takes images of one size; these have {rig.left.size} and {rig.right.size} px"
            )
        R1, R2, P1, P2, _ = cv2.fisheye.stereoRectify(
            *intrinsics(rig.left),
            *intrinsics(rig.right),
            rig.left.size,
            rig.R_right_left,
            rig.t_right_left[:, None],
            cv2.CALIB_ZERO_DISPARITY,
            balance=options.balance,
            fov_scale=options.fov_scale,
        )
        focal, resolution = float(P1[0, 0]), rb.centre_resolution_px(rig)
        too_wide = "the lens is too wide for it, or the cameras look too far off the baseline's middle plane"
        if not FOCAL_SHARES[0] <= focal / resolution <= FOCAL_SHARES[1]:
            raise rb.Unsupported(
                f"cv2.fisheye.stereoRectify gives f = {focal:.3g} px where the source has {resolution:.0f}: "
                + too_wide
            )
        left = rb.Warp(rig.left, R1, rb.Perspective(P1[:, :3]))
        right = rb.Warp(rig.right, R2, rb.Perspective(P2[:, :3]))
        rect = rb.Rectification(rig, left, right, rig.left.size, {"focal_px": focal})
        shown = rb.metrics.coverage(rect, rig)["coverage_pixels"]
        if shown < LEAST_SHOWN:
            raise rb.Unsupported(f"cv2.fisheye.stereoRectify shows {shown:.1%} of the sources: {too_wide}")
        return rect


def intrinsics(camera: rb.Camera) -> tuple[np.ndarray, np.ndarray]:
    """K [3, 3] and the four coefficients; raises Unsupported for a lens that cv2.fisheye does not know."""
    if camera.model not in LENSES:
        raise rb.Unsupported(
            f"cv2.fisheye knows lenses after {' and '.join(LENSES)}; this one is {camera.model}"
        )
    p = camera.params
    K = np.array([[p["fx"], 0, p["cx"]], [0, p["fy"], p["cy"]], [0, 0, 1.0]])
    return K, np.array([p[name] for name in LENSES[camera.model]] or [0.0] * 4)
