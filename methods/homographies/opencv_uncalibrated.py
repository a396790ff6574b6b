"""OpenCV's rectification from matches, as it ships it."""

import cv2
import numpy as np

import rectbench as rb


class Options(rb.Options):
    threshold: float = rb.option(
        5.0, "matches of a greater algebraic error |x'ᵀ F x| are left out; 0 keeps all of them", ge=0
    )


class OpenCVUncalibrated(rb.HomographyRectifier[Options]):
    """`cv2.stereoRectifyUncalibrated`, which is Hartley's method, its images where it puts them.

    Its epipole has the digits of single precision (OpenCV 5.0): where it is millions of pixels away, rows are
    tenths of a pixel off and more, even with exact matches.
    """

    name = "opencv-uncalibrated"
    references = (
        "OpenCV, stereoRectifyUncalibrated",
        "Hartley, Theory and Practice of Projective Rectification, "
        "International Journal of Computer Vision 35(2), 1999",
    )

    def homographies(
        self, view: rb.PinholeView, options: Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        left, right = view.matches
        F = rb.fundamental_matrix(left, right)
        found, H_left, H_right = cv2.stereoRectifyUncalibrated(
            left, right, F, view.size, threshold=options.threshold
        )
        if not found:
            raise rb.Unsupported(f"OpenCV finds no rectification of these {len(left)} matches")
        return H_left, H_right, {}

    def placement(self, view: rb.PinholeView, H_left: np.ndarray, H_right: np.ndarray) -> np.ndarray:
        return np.eye(3)
