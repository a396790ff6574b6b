"""Rectification from matches with bounds on how much it distorts (Ko, Shim, Choi and Kuo 2017)."""

import numpy as np
from scipy.optimize import least_squares

import rectbench as rb

from ._homographies import mapped, polygon_area, shift
from ._turned_cameras import focal_range, fundamental_of, intrinsics, rotation, upright_roll

IDEAL = np.array([1.0, 0.0, 0.0, 1.0])
"""Aspect ratio, skewness [deg], rotation [deg] and size ratio of an image that is not distorted,"""
BOUND = np.array([0.2, 5.0, 30.0, 0.2])
"""and how far from these they may lie."""
AIM = 0.9
"""Share of the bound to which a measure is brought back that was beyond it."""
FIRST_WEIGHT, HEAVIER, ROUNDS = 1e-2, 10.0, 5
"""Squared pixels that count as much as a measure being off by its bound, once it is beyond; by what they are
multiplied while it stays there; and how often."""
WORSE_PX = 0.1
"""The Sampson error may not grow by more for it."""
ROUGHLY = 1e-3
"""Relative decrease of the cost at which a round ends: only the last one's result is kept."""
MATCHES = 300
"""As many are enough for eight parameters."""


class USRCGD(rb.HomographyRectifier):
    """K_new R_i K_i⁻¹ of least Sampson error whose four measures of distortion stay within bounds.

    Five angles as Fusiello and Irsara have them, a zoom for each image and a shift of rows between them. From
    the paper's abstract are the error, bounded by measures that enter the cost with adaptive weights. Which
    measures, bounds and parameters they are could not be compared with its text; how weights grow is ours.
    """

    name = "usr-cgd"
    references = (
        "Ko, Shim, Choi and Kuo, Robust Uncalibrated Stereo Rectification with Constrained Geometric "
        "Distortions (USR-CGD), Image and Vision Computing 60, 2017",
    )

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        unit = float(sum(view.size))
        every = max(1, len(view.matches.left) // MATCHES)
        left, right = (np.column_stack([px, np.ones(len(px))])[::every] for px in view.matches)
        shortest, longest = np.log(np.array(focal_range(view)) / unit)
        free = [np.inf] * 5
        bounds = [*np.negative(free), shortest, shortest, -0.5], [*free, longest, longest, 0.5]

        def sampson(p: np.ndarray) -> np.ndarray:
            return rb.sampson_residuals(fundamental_of(*turned(p, view)), left, right) / np.sqrt(len(left))

        def off(p: np.ndarray) -> np.ndarray:
            return (np.array([distortions(H, view.size) for H in turned(p, view)]) - ideal) / BOUND

        def cost(p: np.ndarray) -> np.ndarray:
            too_far = np.maximum(np.abs(off(p)) - AIM, 0)
            return np.append(sampson(p), (np.sqrt(weights) * too_far).ravel())

        # Cameras one above the other need a quarter turn, which is then no distortion.
        roll = upright_roll(rb.fundamental_matrix(*view.matches), view.centre)
        ideal = IDEAL + np.degrees([0, 0, roll, 0])
        p, weights = np.array([0, roll, 0, 0, roll, 0, 0, 0]), np.zeros((2, 4))
        p = least_squares(cost, p, bounds=bounds).x
        most_px = np.linalg.norm(sampson(p)) + WORSE_PX
        for _ in range(ROUNDS):
            if not (beyond := np.abs(off(p)) > 1).any():
                break
            weights[beyond] = np.maximum(HEAVIER * weights[beyond], FIRST_WEIGHT)
            tried = least_squares(cost, p, bounds=bounds, ftol=ROUGHLY, xtol=ROUGHLY / 100).x
            if np.linalg.norm(sampson(tried)) > most_px:
                break
            p = tried
        H_left, H_right = (with_middle_column(H, view.centre) for H in turned(p, view))
        notes: dict[str, float | str] = {"sampson_rms_px": float(np.linalg.norm(sampson(p)))}
        if (np.abs(off(p)) > 1).any():
            notes["warning"] = "a distortion stays beyond its bound, so that rows correspond"
        return H_left, H_right, notes


def turned(p: np.ndarray, view: rb.PinholeView) -> tuple[np.ndarray, np.ndarray]:
    """H_left and H_right of five angles, the logarithms of two focal lengths and a shift, lengths in units of
    width + height."""
    unit = sum(view.size)
    f_left, f_right = unit * np.exp(p[5:7])
    R_left, R_right = rotation(0.0, p[0], p[1]), rotation(p[2], p[3], p[4])
    K_left, K_right = intrinsics(f_left, view.centre), intrinsics(f_right, view.centre)
    K_new = intrinsics((f_left + f_right) / 2, view.centre)
    return K_new @ R_left @ np.linalg.inv(K_left), shift(0, unit * p[7]) @ K_new @ R_right @ np.linalg.inv(
        K_right
    )


def with_middle_column(H: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """The same rows, the middle of the image in the middle column."""
    return shift(middle[0] - mapped(H, middle[None])[0, 0], 0) @ H


def distortions(H: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """Aspect ratio, skewness [deg], rotation [deg] and size ratio of an image through H.

    The ratio of its half diagonals, how far its corners are from right angles in the mean, how far the right
    half of its horizontal midline is turned, and its area over that of the source.
    """
    w, h = size
    corners = np.array([[0, 0], [w, 0], [w, h], [0, h]]) - 0.5
    middle, right_middle = np.array([(w - 1) / 2, (h - 1) / 2]), np.array([w - 0.5, (h - 1) / 2])
    a, b, c, d, o, e = mapped(H, np.array([*corners, middle, right_middle]))
    half = [np.linalg.norm(corner - o) for corner in (a, b, c, d)]
    around = np.array([a, b, c, d])
    to_next, to_last = np.roll(around, -1, axis=0) - around, np.roll(around, 1, axis=0) - around
    cosines = (
        (to_next * to_last).sum(axis=1) / np.linalg.norm(to_next, axis=1) / np.linalg.norm(to_last, axis=1)
    )
    skewness = np.abs(90 - np.degrees(np.arccos(np.clip(cosines, -1, 1)))).mean()
    turn = np.degrees(np.arctan2(*(e - o)[::-1]))
    return np.array(
        [(half[0] / half[2] + half[1] / half[3]) / 2, skewness, turn, polygon_area(around) / (w * h)]
    )
