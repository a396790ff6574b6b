"""Pixel-variant local homography (Zhou, Dai and Li): the cubics in γ and β with the least distortion."""

from typing import Literal

import numpy as np
from scipy.optimize import OptimizeResult, minimize

import rectbench as rb

from ._local_energy import Energy, Law, Slopes

LEAST_SLOPE = 1e-3
"""Ψ' stays above this share of the source's centre resolution, so that the inverse keeps its digits."""


class Options(rb.Options):
    alpha_ratio: float = rb.option(0.5, "weight α1 of the aspect ratio loss", ge=0)
    alpha_skew: float = rb.option(0.5, "weight α2 of the skew loss", ge=0)
    model: Literal["equidistant", "stereographic", "equisolid", "orthographic", "cylindrical"] = rb.option(
        "equidistant",
        "the f(θ) that Ψ is a cubic of: θ (equidistant, the paper's choice), 2 tan(θ/2) (stereographic), "
        "2 sin(θ/2) (equisolid), sin θ (orthographic) or tan θ (cylindrical)",
    )
    columns: Literal["per-image", "shared"] = rb.option(
        "per-image", "whether each image has its own Ψ_u or both share one"
    )
    inverse: Literal["exact", "polynomial"] = rb.option(
        "exact",
        "Ψ inverted exactly, or by a fitted polynomial as in the paper, which then is the map; the notes "
        "tell how far off it is",
    )
    inverse_degree: int = rb.option(9, "degree of that polynomial", ge=3, le=15)
    start: Literal["equidistant", "random"] = rb.option(
        "equidistant",
        "where the minimisation starts: Ψ = f(θ) at the source's centre resolution, or anywhere",
    )
    draw: int = rb.option(0, "which of the random starts", ge=0)


class LocalHomography(rb.Rectifier[Options]):
    """û = Ψ_u(γ), v̂ = Ψ_v(β), cubics that minimise the resampling distortion L under Ψ' > 0."""

    name = "local-homography"
    references = (
        "Zhou, Dai and Li, Pixel-variant Local Homography for Fisheye Stereo Rectification "
        "Minimizing Resampling Distortion",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """Steps 3 to 5 of the paper's algorithm: the pose is given, and images are built by the warps."""
        bounds = rb.view_angles(problem.rig)
        if options.columns == "shared":
            bounds = bounds._replace(gamma_left=bounds.gamma, gamma_right=bounds.gamma)
        law = Law(options.model, bounds)
        energy = Energy(problem, law, (options.alpha_ratio, options.alpha_skew), options.columns)
        focal = rb.centre_resolution_px(problem.rig)

        c, found = least(energy, Slopes(law), focal, starting_point(options, problem.seed))
        notes: dict[str, float | str] = {"energy": float(found.fun), "iterations": float(found.nit)}
        if not found.success:
            notes["warning"] = f"the minimisation ended early: {found.message}"
        if options.columns == "shared":
            c[3:6] = c[:3]

        u_left, u_right, v = law.profiles(c)
        if options.inverse == "polynomial":
            exact = u_left, u_right, v
            u_left, u_right, v = fitted = [rb.PolynomialInverse.of(p, options.inverse_degree) for p in exact]
            errors = [q.error_px(p) for q, p in zip(fitted, exact, strict=True)]
            notes |= {"inverse_error_u_px": max(errors[:2]), "inverse_error_v_px": errors[2]}
        return rb.Rectification.from_profiles(problem.rig, u_left, u_right, v, notes, view=bounds)


def least(
    energy: Energy, slopes: Slopes, focal: float, start: np.ndarray
) -> tuple[np.ndarray, OptimizeResult]:
    """The coefficients [9] of least L with dΨ/df above LEAST_SLOPE, and what the solver says of them."""
    start = focal * start
    if not np.isfinite(energy(start)[0]):
        raise rb.InvalidResult("the energy is infinite at the start: the view reaches an epipole")
    # The solver begins as if L were round; in these coordinates it nearly is.
    rounding = energy.rounding(start)

    def energy_and_gradient(y: np.ndarray) -> tuple[float, np.ndarray]:
        value, gradient = energy(start + rounding @ y)
        return value, gradient @ rounding

    found = minimize(  # type: ignore[call-overload]  # its stubs know constraints of one number
        energy_and_gradient,
        np.zeros(9),
        jac=True,
        method="SLSQP",
        constraints={
            "type": "ineq",
            "fun": lambda y: slopes(start + rounding @ y) / focal - LEAST_SLOPE,
            "jac": lambda y: slopes.jacobian(start + rounding @ y) @ rounding / focal,
        },
        options={"maxiter": 500, "ftol": 1e-13},
    )
    return start + rounding @ found.x, found


def starting_point(options: Options, seed: int) -> np.ndarray:
    """Coefficients [9] in units of the source's centre resolution; random ones may even fall."""
    as_f = np.tile([1.0, 0.0, 0.0], 3)
    if options.start == "equidistant":
        return as_f
    rng = np.random.default_rng([seed, options.draw])
    return as_f * rng.uniform(0.2, 3.0, 9) + rng.normal(0.0, 0.3, 9)
