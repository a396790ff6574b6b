"""Rectification of least perspective distortion in closed form (Lafiosca and Ceccaroni 2022)."""

import numpy as np

import rectbench as rb

from ._homographies import Pencils


class LafioscaCeccaroni(rb.HomographyRectifier):
    """Loop and Zhang's least projective distortion as a root of a quartic, from the calibrated pose.

    Theirs is that the least is found directly, and is the least of all. The quartic is derived here from the
    criterion itself, not in their coordinates; the affine parts are Loop and Zhang's.
    """

    name = "lafiosca-ceccaroni"
    references = (
        "Lafiosca and Ceccaroni, Rectifying Homographies for Stereo Vision: Analytical Solution for Minimal "
        "Distortion, SAI 2022",
    )
    needs = frozenset({"pose"})

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        K_inverse = np.linalg.inv(view.K)
        pencils = Pencils.of(K_inverse.T @ view.rig.essential_matrix @ K_inverse, view)
        t = least_distorted(pencils)
        H_left, H_right = pencils.rectified(t)
        return H_left, H_right, {"projective_distortion": pencils.projective_distortion(t)}


def least_distorted(pencils: Pencils) -> float:
    """The pair t of least projective distortion of all.

    The left image's part is a quadratic a(t), the right one's a'(t)/l(t)² with a linear l. The slope of their
    sum vanishes where da/dt l³ + da'/dt l - 2 a' dl/dt does, a quartic with one real root at least.
    """
    (a_left, _), (a_right, line) = pencils.variances
    slope = a_left.deriv() * line**3 + a_right.deriv() * line - 2 * a_right * line.deriv()
    # A double root comes as a pair with a little of an imaginary part: its real part is the root.
    return float(min(slope.trim().roots().real, key=pencils.projective_distortion))
