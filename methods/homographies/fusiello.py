"""Quasi-Euclidean rectification from matches alone (Fusiello and Irsara 2008)."""

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

import rectbench as rb

from ._turned_cameras import (
    VIEW_DEG,
    focal_range,
    fundamental_of,
    intrinsics,
    open_focal,
    rotation,
    upright,
    upright_roll,
)

START_FOCALS = 3
"""Starting focal lengths, spread between the bounds; the best end is kept."""
FEW_MATCHES = 100


class Fusiello(rb.HomographyRectifier):
    """H_i = K_new R_i K⁻¹ with five angles and one focal length that minimise the Sampson error."""

    name = "fusiello"
    references = ("Fusiello and Irsara, Quasi-Euclidean uncalibrated epipolar rectification, ICPR 2008",)

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        left, right = (np.column_stack([px, np.ones(len(px))]) for px in view.matches)
        unit = float(sum(view.size))

        def sampson(p: np.ndarray, chosen: slice) -> np.ndarray:
            return rb.sampson_residuals(fundamental(p, view.centre, unit), left[chosen], right[chosen])

        def all_six(start: np.ndarray, chosen: slice) -> OptimizeResult:
            return least_squares(sampson, start, bounds=bounds, x_scale=1.0, args=(chosen,))

        def fitted(focal: float) -> OptimizeResult:
            """Five angles at a fixed focal length, then all six: the angles must not pay for a poor start."""
            log = np.log(focal / unit)

            def turned_only(angles: np.ndarray) -> np.ndarray:
                return sampson(np.append(angles, log), few)

            turned = least_squares(turned_only, level, method="lm")
            return all_six(np.append(turned.x, log), few)

        shortest, longest = focal_range(view)
        free = [np.inf] * 5
        bounds = [*np.negative(free), np.log(shortest / unit)], [*free, np.log(longest / unit)]
        # A few matches tell which start is good; all of them then finish it.
        few, every = slice(None, None, max(1, len(left) // FEW_MATCHES)), slice(None)
        roll = upright_roll(rb.fundamental_matrix(*view.matches), view.centre)
        level = np.array([0, roll, 0, 0, roll])
        starts = np.geomspace(shortest, longest, START_FOCALS + 2)[1:-1]
        best = min((fitted(focal) for focal in starts), key=lambda fit: fit.cost)
        best = all_six(best.x, every)

        R_left, R_right, focal = unpack(best.x, unit)
        R_left, R_right = upright(R_left, R_right)
        K = intrinsics(focal, view.centre)
        notes: dict[str, float | str] = {
            "focal_px": focal,
            "sampson_rms_px": float(np.sqrt(2 * best.cost / len(left))),
        }
        if best.active_mask[5]:
            notes["warning"] = open_focal(VIEW_DEG[1] if best.active_mask[5] < 0 else VIEW_DEG[0])
        return K @ R_left @ np.linalg.inv(K), K @ R_right @ np.linalg.inv(K), notes


def unpack(p: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray, float]:
    """R_left (its x-rotation fixed at 0), R_right and the focal length in px, of the six parameters."""
    focal = float(unit * np.exp(np.clip(p[5], -8, 8)))
    return rotation(0.0, p[0], p[1]), rotation(p[2], p[3], p[4]), focal


def fundamental(p: np.ndarray, centre: np.ndarray, unit: float) -> np.ndarray:
    """F = K⁻ᵀ R'ᵀ [e_x]× R K⁻¹: after both rotations the rows agree."""
    R_left, R_right, focal = unpack(p, unit)
    from_pixel = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, focal]])  # f K⁻¹
    return fundamental_of(R_left @ from_pixel, R_right @ from_pixel)
