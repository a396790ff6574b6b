"""Rectification from matches by the least turns, one after the other (Monasse, Morel and Tang 2010)."""

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

import rectbench as rb

from ._turned_cameras import HALF_TURN, VIEW_DEG, focal_range, fundamental_of, intrinsics, open_focal, upright

STARTS = 25
"""Focal lengths, spread between the bounds, among which the search for the best one begins."""
PRECISION, AT_BOUND = 1e-9, 1e-3
"""Of the search, relatively; and how near to a bound a focal length has ended there."""


class ThreeStep(rb.HomographyRectifier):
    """K R_i K⁻¹: the epipoles to infinity, then onto the rows, then what is left about the baseline.

    Each turn is the least that does its step; the focal length, the one thing unknown, is that of least
    Sampson error. Of the third turn each image takes half here.
    """

    name = "three-step"
    references = ("Monasse, Morel and Tang, Three-Step Image Rectification, BMVC 2010",)

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        F = rb.fundamental_matrix(*view.matches)
        left, right = (np.column_stack([px, np.ones(len(px))]) for px in view.matches)

        def error(log_focal: float) -> float:
            K = intrinsics(np.exp(log_focal), view.centre)
            R_left, R_right = three_turns(K.T @ F @ K)
            from_pixel = np.linalg.inv(K)
            turned = fundamental_of(R_left @ from_pixel, R_right @ from_pixel)
            return float((rb.sampson_residuals(turned, left, right) ** 2).mean())

        shortest, longest = np.log(focal_range(view))
        focals = np.linspace(shortest, longest, STARTS)
        best = int(np.argmin([error(focal) for focal in focals]))
        around = focals[max(best - 1, 0)], focals[min(best + 1, STARTS - 1)]
        found = minimize_scalar(error, bounds=around, options={"xatol": PRECISION})
        K = intrinsics(np.exp(found.x), view.centre)
        R_left, R_right = three_turns(K.T @ F @ K)
        notes: dict[str, float | str] = {"focal_px": K[0, 0], "sampson_rms_px": float(np.sqrt(found.fun))}
        for bound, view_deg in ((shortest, VIEW_DEG[1]), (longest, VIEW_DEG[0])):
            if abs(found.x - bound) < AT_BOUND:
                notes["warning"] = open_focal(view_deg)
        return K @ R_left @ np.linalg.inv(K), K @ R_right @ np.linalg.inv(K), notes


def three_turns(E: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rotations (R_left, R_right) that the essential matrix E = Kᵀ F K asks for."""
    R_left, R_right = (onto_rows(np.linalg.svd(matrix)[2][-1]) for matrix in (E, E.T))
    # Now E has become k [i]× R_x(angle): [[-sin, -cos], [cos, -sin]] between y and z.
    rest = (R_right @ E @ R_left.T)[1:, 1:]
    if np.linalg.det(rest) < 0:  # one image is upside down beside the other
        R_right = HALF_TURN @ R_right
        rest = (R_right @ E @ R_left.T)[1:, 1:]
    sin, cos = -(rest[0, 0] + rest[1, 1]), rest[1, 0] - rest[0, 1]
    half = np.arctan(sin / cos) / 2 if cos else np.pi / 4  # of either sign of E the smaller turn
    about_baseline = Rotation.from_rotvec([half, 0, 0]).as_matrix()
    return upright(about_baseline @ R_left, about_baseline.T @ R_right)


def onto_rows(epipole: np.ndarray) -> np.ndarray:
    """The two turns [3, 3] that bring the ray of an epipole [3] to infinity and then onto the x axis."""
    x, y, z = epipole if epipole[0] >= 0 else -epipole
    off_plane, off_row = np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)
    to_infinity = Rotation.from_rotvec(np.array([-y, x, 0]) / np.hypot(x, y) * off_plane)
    return (Rotation.from_rotvec([0, 0, -off_row]) * to_infinity).as_matrix()
