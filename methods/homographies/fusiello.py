"""Quasi-Euclidean rectification from matches alone (Fusiello and Irsara 2008)."""

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

import rectbench as rb

START_FOCALS = 3
"""Starting focal lengths, spread between the bounds; the best end is kept."""
FEW_MATCHES = 100
HALF_TURN = np.diag([-1.0, -1.0, 1.0])
VIEW_DEG = (10.0, 150.0)
"""The focal length is held to views between these, the plausible ones."""


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

        # Small rotations leave the focal length open: without bounds noise would carry it anywhere.
        shortest, longest = (view.size[0] / 2 / np.tan(np.radians(fov) / 2) for fov in reversed(VIEW_DEG))
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
        if np.trace(R_left[:2, :2] + R_right[:2, :2]) < 0:  # a half turn of both leaves the rows as they are
            R_left, R_right = HALF_TURN @ R_left, HALF_TURN @ R_right
        K = intrinsics(focal, view.centre)
        notes: dict[str, float | str] = {
            "focal_px": focal,
            "sampson_rms_px": float(np.sqrt(2 * best.cost / len(left))),
        }
        if best.active_mask[5]:
            bound = VIEW_DEG[1] if best.active_mask[5] < 0 else VIEW_DEG[0]
            notes["warning"] = f"the matches leave the focal length open: it ended at a view of {bound:.0f}°"
        return K @ R_left @ np.linalg.inv(K), K @ R_right @ np.linalg.inv(K), notes


def upright_roll(F: np.ndarray, centre: np.ndarray) -> float:
    """A quarter turn where the left epipole lies more above the middle than beside it; else 0."""
    x, y, w = np.linalg.svd(F)[2][-1]
    return 0.0 if abs(y - w * centre[1]) <= abs(x - w * centre[0]) else float(np.pi / 2)


def unpack(p: np.ndarray, unit: float) -> tuple[np.ndarray, np.ndarray, float]:
    """R_left (its x-rotation fixed at 0), R_right and the focal length in px, of the six parameters."""
    focal = float(unit * np.exp(np.clip(p[5], -8, 8)))
    return rotation(0.0, p[0], p[1]), rotation(p[2], p[3], p[4]), focal


def rotation(x: float, y: float, z: float) -> np.ndarray:
    """Rx Ry Rz. Written out: the fit asks for thousands of them."""
    (cx, cy, cz), (sx, sy, sz) = np.cos([x, y, z]), np.sin([x, y, z])
    return np.array(
        [
            [cy * cz, -cy * sz, sy],
            [cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy],
            [sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy],
        ]
    )


def intrinsics(focal: float, centre: np.ndarray) -> np.ndarray:
    """K of a pinhole image whose principal point is its middle."""
    return np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1.0]])


def fundamental(p: np.ndarray, centre: np.ndarray, unit: float) -> np.ndarray:
    """F = K⁻ᵀ R'ᵀ [e_x]× R K⁻¹: after both rotations the rows agree."""
    R_left, R_right, focal = unpack(p, unit)
    from_pixel = np.array([[1, 0, -centre[0]], [0, 1, -centre[1]], [0, 0, focal]])  # f K⁻¹
    left, right = R_left @ from_pixel, R_right @ from_pixel
    return np.outer(right[2], left[1]) - np.outer(right[1], left[2])
