"""Rectification from matches that leaves the left image as it is (Xiao, Sun, Pang, Yan and Ren 2018)."""

import numpy as np
from scipy.optimize import least_squares

import rectbench as rb

from ._homographies import mapped, refuse_apart, rows_rms_px, sheared, shift


class DSR(rb.HomographyRectifier):
    """The homography of the right image alone that minimises how far matches are apart in rows.

    Serves cameras that look the same way, beside each other along the rows, such as a phone's. From the paper
    are the untouched left image and the least vertical displacement. Ours are the linear start, and the
    columns: sheared as Loop and Zhang do, and shifted until no match has a disparity below 0.
    """

    name = "dsr"
    references = (
        "Xiao, Sun, Pang, Yan and Ren, DSR: Direct Self-rectification for Uncalibrated Dual-lens Cameras, "
        "3DV 2018",
    )

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        left, right = (px - view.centre for px in view.matches)
        H_right = sheared(level(left[:, 1], right, unit=sum(view.size) / 2), view.size)
        H_right = shift((left - mapped(H_right, right))[:, 0].min(), 0) @ H_right
        rms_px = rows_rms_px(np.eye(3), left, H_right, right)
        refuse_apart(rms_px, view, "one homography leaves", "cameras that look the same way along the rows")
        H_right = shift(*view.centre) @ H_right @ shift(*-view.centre)
        return np.eye(3), H_right, {"rows_rms_px": rms_px}

    def placement(self, view: rb.PinholeView, H_left: np.ndarray, H_right: np.ndarray) -> np.ndarray:
        return np.eye(3)


def level(rows: np.ndarray, right: np.ndarray, unit: float) -> np.ndarray:
    """The homography [3, 3] with first row (1, 0, 0) that brings pixels [N, 2] as near as can be to rows [N].

    `unit`, px, is about the size of the image, so that all five numbers of its last two rows are about 1.
    """
    y, points = rows / unit, np.column_stack([right / unit, np.ones(len(right))])

    def apart(p: np.ndarray) -> np.ndarray:
        return points @ p[:3] / (1 + points[:, :2] @ p[3:]) - y

    start, *_ = np.linalg.lstsq(np.column_stack([points, -y[:, None] * points[:, :2]]), y)
    p = least_squares(apart, start, method="lm", xtol=1e-14, ftol=1e-14).x
    to_unit = np.diag([1 / unit, 1 / unit, 1])
    return np.linalg.inv(to_unit) @ np.array([[1, 0, 0], p[:3], [*p[3:], 1]]) @ to_unit
