"""Rectification from matches that changes local areas the least (Gluckman and Nayar 2001)."""

from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

import rectbench as rb

from ._homographies import Pencils, sheared

NODES, WEIGHTS = np.polynomial.legendre.leggauss(14)
"""Gauss's rule, each way: areas are right to 1e-6 of them where w falls to a quarter at the rim."""
STARTS = 65
"""Pairs of lines w among which the search for the best one begins,"""
PRECISION = 1e-10
"""and how near it comes, of the range of t."""


class GluckmanNayar(rb.HomographyRectifier):
    """The pair w and the areas det H that minimise the integral of (det J - 1)² over both images.

    That is theirs; it leaves a shear of the columns and the ratio of width to height open. Here the shear is
    Loop and Zhang's, and so is the ratio, in the mean of the two images.
    """

    name = "gluckman-nayar"
    references = (
        "Gluckman and Nayar, Rectifying Transformations That Minimize Resampling Effects, CVPR 2001",
    )

    def homographies(
        self, view: rb.PinholeView, options: rb.Options
    ) -> tuple[np.ndarray, np.ndarray, dict[str, float | str]]:
        pencils = Pencils.of(rb.fundamental_matrix(*view.matches), view)
        t = least_resampling(pencils)
        shapes = [sheared(H, pencils.size) for H in pencils.similar(t)]
        growths = [best_area(H[2], pencils.size) / np.linalg.det(H) for H in shapes]
        down = np.prod(growths) ** 0.25
        H_left, H_right = (
            pencils.between_pixels(np.diag([growth / down, down, 1]) @ H)
            for H, growth in zip(shapes, growths, strict=True)
        )
        return H_left, H_right, {"area_change": area_change(pencils, t)}


def least_resampling(pencils: Pencils) -> float:
    """The pair t whose lines w change areas the least, each image at its best scale."""
    low, high = range_before_images(pencils)
    steps = np.linspace(low, high, STARTS)
    best = 1 + int(np.argmin([area_change(pencils, t) for t in steps[1:-1]]))
    bounds = steps[best - 1], steps[best + 1]
    change = partial(area_change, pencils)
    return float(minimize_scalar(change, bounds=bounds, options={"xatol": PRECISION * (high - low)}).x)


def range_before_images(pencils: Pencils) -> tuple[float, float]:
    """The range of t in which w_0 + t v meets neither image; Unsupported where there is none."""
    w, h = pencils.size
    corners = np.array([[-w, -h, 2], [w, -h, 2], [w, h, 2], [-w, h, 2]]) / 2
    left, right = (corners @ base for base in pencils.bases)
    for side in (1, -1):  # all corners lie on one side of their line, those of the right image on either
        at_zero, slope = np.concatenate([left, side * right]).T
        with np.errstate(divide="ignore", invalid="ignore"):
            crossed = -at_zero / slope
        low, high = crossed[slope > 0].max(), crossed[slope < 0].min()
        if low < high:
            return float(low), float(high)
    raise rb.Unsupported(
        "every pair of epipolar lines meets an image; expected epipoles outside of both views"
    )


def area_change(pencils: Pencils, t: float) -> float:
    """The mean of (det J - 1)² over both images, each scaled to its least: 1 - (mean g)² / mean g²."""
    means = [area_means(base @ [1, t], pencils.size) for base in pencils.bases]
    return float(np.mean([1 - first**2 / second for first, second in means]))


def best_area(w: np.ndarray, size: tuple[int, int]) -> float:
    """det H at which the mean of (det H g - 1)² is least, for w that is 1 in the middle."""
    first, second = area_means(w, size)
    return first / second


def area_means(w: np.ndarray, size: tuple[int, int]) -> tuple[float, float]:
    """The means of g and g² over an image, g = (w · x)⁻³: det J is det H times g."""
    x, y = NODES[:, None] * size[0] / 2, NODES * size[1] / 2
    g = (w[0] * x + w[1] * y + w[2]) ** -3.0
    return float(WEIGHTS @ g @ WEIGHTS / 4), float(WEIGHTS @ g**2 @ WEIGHTS / 4)
