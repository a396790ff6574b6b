"""Projective rectification from matches that is as nearly affine as can be (Loop and Zhang 1999)."""

import numpy as np
from scipy.optimize import minimize_scalar

import rectbench as rb

from ._homographies import Pencils

PRECISION = 1e-10
"""Of the search, of the range of t."""


class LoopZhang(rb.HomographyRectifier):
    """H_s H_r H_p: least projective distortion over the pairs of lines w, then a similarity, then a shear.

    As with the authors, the least is searched between those of each image alone, so that it may be a local
    one; `lafiosca-ceccaroni` has it in closed form. Columns, which the paper leaves open, have each image's
    middle in the middle.
    """

    name = "loop-zhang"
    references = ("Loop and Zhang, Computing Rectifying Homographies for Stereo Vision, CVPR 1999",)

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        pencils = Pencils.of(rb.fundamental_matrix(*view.matches), view)
        t = nearest_affine(pencils)
        H_left, H_right = pencils.rectified(t)
        return H_left, H_right, {"projective_distortion": pencils.projective_distortion(t)}


def nearest_affine(pencils: Pencils) -> float:
    """The pair t of least projective distortion between the best ones of each image alone."""
    # a(t)/l(t)² has one least value, where da/dt l = 2 a dl/dt; the quadratic terms of the two sides cancel.
    slopes = [a.deriv() * line - 2 * a * line.deriv() for a, line in pencils.variances]
    low, high = sorted(-slope.coef[0] / slope.coef[1] for slope in slopes)
    criterion, precise = pencils.projective_distortion, PRECISION * (high - low)
    return float(minimize_scalar(criterion, bounds=(low, high), options={"xatol": precise}).x)
