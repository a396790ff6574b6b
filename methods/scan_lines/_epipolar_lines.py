"""How many pixels epipolar lines and the distances between them take, so that no source pixel is lost."""

import numpy as np

import rectbench as rb

LINES, PLACES = 513, 257
"""Half planes about the baseline, and places on each, at which either lens is asked."""


def lossless(angles: np.ndarray, px_per_rad: np.ndarray) -> rb.MonotoneSpline:
    """The profile over rising angles [K] that has nowhere fewer pixels a radian than [2, K], of both images.

    Where neither shows anything (0), as many as at the next angle where one does. A slope of the spline that
    is as high as both ends of its interval keeps it above the straight line from one to the other.
    """
    highest = px_per_rad.max(axis=0)
    shown = highest > 0
    padded = np.pad(np.interp(angles, angles[shown], highest[shown]), 1, mode="edge")
    slopes = np.maximum(padded[1:], padded[:-1])
    return rb.MonotoneSpline.of(angles, slopes)


def lossless_on_spheres(
    problem: rb.Problem, view: rb.ViewAngles
) -> tuple[rb.MonotoneSpline, rb.MonotoneSpline]:
    """h(γ) along the lines and g(β) across them, on the spheres of both lenses.

    Where a radian of γ is a long and one of β is b long in the source image, steps of a row and a column are
    a / h' and b / g'. A matrix of these columns has singular values up to 1 where they are no longer than
    1 / √(1 + |cos ∠(a, b)|): at a right angle, which a conformal lens keeps, the paper's one pixel.
    """
    gamma, beta = np.linspace(*view.gamma, PLACES), np.linspace(*view.beta, LINES)
    along, across = [], []
    for warp in problem.angle_warps():
        places = np.stack(np.meshgrid(gamma, beta), axis=-1)
        steps = warp.inverse_jacobian(places)
        steps[~warp.source.contains(warp.inverse(places))] = np.nan
        lengths = np.linalg.norm(steps, axis=-2)
        skew = np.abs((steps[..., 0] * steps[..., 1]).sum(axis=-1)) / lengths.prod(axis=-1)
        needed = to_the_rim(lengths * np.sqrt(1 + skew)[..., None])
        along.append(np.nanmax(needed[..., 0], axis=0, initial=0))
        across.append(np.nanmax(needed[..., 1], axis=1, initial=0))
    return lossless(gamma, np.stack(along)), lossless(beta, np.stack(across))


def to_the_rim(values: np.ndarray) -> np.ndarray:
    """Values [lines, places, 2], NaN where nothing is seen, one step on: they grow as they did before."""
    padded = np.pad(values, ((2, 2), (2, 2), (0, 0)), constant_values=np.nan)
    rows, columns = values.shape[:2]

    def beside(down: int, across: int) -> np.ndarray:
        return padded[2 + down : 2 + down + rows, 2 + across : 2 + across + columns]

    reached = [values]
    for down, across in ((0, 1), (0, -1), (1, 0), (-1, 0)):
        one, two = beside(down, across), beside(2 * down, 2 * across)
        reached.append(np.where(np.isnan(values), one + np.maximum(one - two, 0), np.nan))
    grown: np.ndarray = np.fmax.reduce(reached)
    return grown
