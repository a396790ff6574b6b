"""The least log distortion of all maps û = h(γ), v̂ = g(β), wherever the epipoles are."""

from typing import Literal

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import minimize

import rectbench as rb

from ._log_energy import LogEnergy, WeightedPixels

FITTED_PIXELS = 3000
"""An image, where nobody asks for certain pixels: by 500 the splines would bend to fit the grid."""
ELSEWHERE = 1e-3
"""Where certain pixels are asked for, the others' share: something has to say what the map does there."""
PIXELS_A_SLOPE = 10
FIRST_INTERVALS, MOST_INTERVALS = 4, 32
ENOUGH_GAIN = 1e-3
"""Intervals are halved until that takes less than this share of the distortion away."""
SMOOTHING = 1e-7
"""Weight of the differences of log slopes, too small to matter but where no pixel is."""


class Options(rb.Options):
    columns: Literal["per-image", "shared"] = rb.option(
        "per-image", "whether each image has its own h or both share one"
    )


class PolarOptimal(rb.Rectifier[Options]):
    """û = h(γ), v̂ = g(β), monotone splines of least log distortion, for any motion."""

    name = "polar-optimal"
    references = (
        "Pollefeys, Koch and Van Gool, A simple and efficient rectification method for general motion, "
        "ICCV 1999",
        "Ramsay, Monotone Regression Splines in Action, Statistical Science 3(4), 1988",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """Newton's method in a trust region, on splines of ever more intervals.

        The log distortion is convex in the logarithms of the slopes (see `_log_energy`), of which the
        splines hold e^α: every α rises. A pixel is as large as in the sources, in the geometric mean.
        """
        rig, view = problem.rig, rb.view_angles(problem.rig)
        if options.columns == "shared":
            view = view._replace(gamma_left=view.gamma, gamma_right=view.gamma)
        pixels = fitted(rig.left, problem.pixels_left), fitted(rig.right, problem.pixels_right)
        energy = LogEnergy(problem.angle_warps(), *pixels)
        splines = Splines(energy, view, FIRST_INTERVALS, options.columns)
        alpha, least = splines.least(np.full(splines.count, np.log(rb.centre_resolution_px(rig))))
        gain = 1.0
        while gain > ENOUGH_GAIN and splines.intervals < MOST_INTERVALS:
            finer = Splines(energy, view, 2 * splines.intervals, options.columns)
            if finer.count * PIXELS_A_SLOPE > energy.effective_count:
                break
            alpha, below = finer.least(splines.refined(alpha, finer))
            gain, splines, least = 1 - below / least, finer, below
        u_left, u_right, v = splines.profiles(alpha)
        notes = {"log_distortion": least, "intervals": float(splines.intervals)}
        return rb.Rectification.from_profiles(rig, u_left, u_right, v, notes, view=view)


def fitted(camera: rb.Camera, asked: np.ndarray) -> WeightedPixels:
    """The pixels asked for, and hardly any other; of the usual grid a finer one."""
    usual = rb.evaluation_pixels(camera)
    if np.array_equal(asked, usual):
        finer = rb.evaluation_pixels(camera, FITTED_PIXELS)
        return WeightedPixels(finer, np.ones(len(finer)))
    weights = np.repeat([1.0, ELSEWHERE * len(asked) / len(usual)], [len(asked), len(usual)])
    return WeightedPixels(np.concatenate([asked, usual]), weights)


class Splines:
    """h of either image and g as splines of so many intervals, by the logs α of their control slopes."""

    def __init__(self, energy: LogEnergy, view: rb.ViewAngles, intervals: int, columns: str) -> None:
        self.energy, self.intervals = energy, intervals
        self.knots = [np.linspace(*span, intervals + 1) for span in view]
        angles = (energy.gamma_left, energy.gamma_right, energy.beta)
        bases = [rb.MonotoneSpline.slope_basis(k, a) for k, a in zip(self.knots, angles, strict=True)]
        left, right, self.rows = bases
        self.columns = np.vstack([left, right]) if columns == "shared" else block_diag(left, right)
        each = intervals + 2
        self.count, self.split = self.columns.shape[1] + each, self.columns.shape[1]
        changes = np.diff(np.eye(each), axis=0)
        self.smoothing = block_diag(*[SMOOTHING * changes.T @ changes] * (self.count // each))

    def __call__(self, alpha: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """The energy of α [M], its gradient [M] and its second derivatives [M, M]."""
        weighted = self.columns * np.exp(alpha[: self.split]), self.rows * np.exp(alpha[self.split :])
        slopes = [w.sum(axis=1) for w in weighted]
        value, gradient, second = self.energy(*np.log(slopes))
        # Of the logarithm of a sum of e^α: each one's share, and what the shares change by.
        shares = [w / slope[:, None] for w, slope in zip(weighted, slopes, strict=True)]
        by_alpha = np.concatenate([w.T @ g for w, g in zip(shares, gradient, strict=True)])
        hessian = np.diag(by_alpha) + self.smoothing
        ends = slice(None, self.split), slice(self.split, None)
        for i, j in np.ndindex(2, 2):
            bent = second[i, j] - gradient[i] * (i == j)
            hessian[ends[i], ends[j]] += (shares[i].T * bent) @ shares[j]
        smoothed = self.smoothing @ alpha
        return value + float(alpha @ smoothed) / 2, by_alpha + smoothed, hessian

    def least(self, alpha: np.ndarray) -> tuple[np.ndarray, float]:
        """The α [M] of least energy, from a start, and the log distortion there."""
        found = minimize(  # type: ignore[call-overload]  # its stubs know no value with its gradient
            lambda a: self(a)[:2],
            alpha,
            jac=True,
            hess=lambda a: self(a)[2],
            method="trust-exact",
            options={"gtol": 1e-7},
        )
        return found.x, float(np.sqrt(found.fun))

    def curves(self, alpha: np.ndarray) -> list[np.ndarray]:
        """α of h left, h right and g."""
        *columns, rows = np.split(alpha, self.count // (self.intervals + 2))
        return [columns[0], columns[-1], rows]

    def profiles(self, alpha: np.ndarray) -> tuple[rb.Profile, rb.Profile, rb.Profile]:
        """h left, h right and g."""
        curves = zip(self.knots, self.curves(alpha), strict=True)
        left, right, rows = (rb.MonotoneSpline.of(knots, np.exp(a)) for knots, a in curves)
        return left, right, rows

    def refined(self, alpha: np.ndarray, finer: "Splines") -> np.ndarray:
        """α of finer splines that are nearly the same."""
        logs = []
        for coarse, fine, a in zip(self.knots, finer.knots, self.curves(alpha), strict=True):
            middles = np.concatenate([fine[:1], (fine[1:] + fine[:-1]) / 2, fine[-1:]])
            logs.append(np.log(rb.MonotoneSpline.slope_basis(coarse, middles) @ np.exp(a)))
        left, right, rows = logs
        return np.concatenate([left, right, rows] if finer.count == 3 * len(rows) else [left, rows])
