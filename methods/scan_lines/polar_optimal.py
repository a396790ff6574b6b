"""The least log distortion of all maps û = h(γ), v̂ = g(β), wherever the epipoles are."""

from typing import Literal

import numpy as np

import rectbench as rb

from ._log_energy import LogEnergy, Splines, WeightedPixels

FITTED_PIXELS = 3000
"""An image, where nobody asks for certain pixels: by 500 the splines would bend to fit the grid."""
ELSEWHERE = 1e-3
"""Where certain pixels are asked for, the others' share: something has to say what the map does there."""
PIXELS_A_SLOPE = 10
FIRST_INTERVALS, MOST_INTERVALS = 4, 32
ENOUGH_GAIN = 1e-3
"""Intervals are halved until that takes less than this share of the distortion away."""


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
        found = splines.least(np.full(splines.count, np.log(rb.centre_resolution_px(rig))))
        gain = 1.0
        while gain > ENOUGH_GAIN and splines.intervals < MOST_INTERVALS:
            finer = Splines(energy, view, 2 * splines.intervals, options.columns)
            if finer.count * PIXELS_A_SLOPE > energy.effective_count:
                break
            below = finer.least(splines.refined(found.x, finer))
            gain, splines, found = 1 - np.sqrt(below.fun / found.fun), finer, below
        notes: dict[str, float | str] = {
            "log_distortion": float(np.sqrt(found.fun)),
            "intervals": float(splines.intervals),
        }
        if not found.success:
            notes["warning"] = f"the minimisation ended early: {found.message}"
        u_left, u_right, v = splines.profiles(found.x)
        return rb.Rectification.from_profiles(rig, u_left, u_right, v, notes, view=view)


def fitted(camera: rb.Camera, asked: np.ndarray) -> WeightedPixels:
    """The pixels asked for, and hardly any other; of the usual grid a finer one."""
    usual = rb.evaluation_pixels(camera)
    if np.array_equal(asked, usual):
        finer = rb.evaluation_pixels(camera, FITTED_PIXELS)
        return WeightedPixels(finer, np.ones(len(finer)))
    weights = np.repeat([1.0, ELSEWHERE * len(asked) / len(usual)], [len(asked), len(usual)])
    return WeightedPixels(np.concatenate([asked, usual]), weights)
