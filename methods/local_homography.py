"""Pixel-variant local homography (Zhou, Dai and Li): the cubics in γ and β with the least distortion."""

from typing import Literal

import numpy as np
from scipy.optimize import minimize

import rectbench as rb

LEAST_SLOPE = 1e-3
"""Ψ' stays above this share of the source's centre resolution, so that the inverse keeps its digits."""


class Options(rb.Options):
    alpha_ratio: float = rb.option(0.5, "weight α1 of the aspect ratio loss", ge=0)
    alpha_skew: float = rb.option(0.5, "weight α2 of the skew loss", ge=0)
    columns: Literal["per-image", "shared"] = rb.option(
        "per-image", "whether each image has its own Ψ_u or both share one"
    )
    start: Literal["equidistant", "random"] = rb.option(
        "equidistant", "where the minimisation starts: Ψ(θ) = f θ, Abraham's map, or anywhere"
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
        rb.refuse_epipole_in_view(problem.rig)
        focal = rb.centre_resolution_px(problem.rig)
        bounds = rb.view_angles(problem.rig)
        if options.columns == "shared":
            bounds = bounds._replace(gamma_left=bounds.gamma, gamma_right=bounds.gamma)
        energy = Energy(problem, options)
        start = focal * starting_point(options, problem.seed)
        if not np.isfinite(energy(start)[0]):
            raise rb.InvalidResult("the energy is infinite at the start: the view reaches an epipole")
        # The solver begins as if L were round; in these coordinates it nearly is.
        rounding = energy.rounding(start)

        def coefficients(y: np.ndarray) -> np.ndarray:
            return start + rounding @ y

        def energy_and_gradient(y: np.ndarray) -> tuple[float, np.ndarray]:
            value, gradient = energy(coefficients(y))
            return value, gradient @ rounding

        found = minimize(  # type: ignore[call-overload]  # its stubs know constraints of one number
            energy_and_gradient,
            np.zeros(9),
            jac=True,
            method="SLSQP",
            constraints={
                "type": "ineq",
                "fun": lambda y: slopes(coefficients(y), bounds) / focal - LEAST_SLOPE,
                "jac": lambda y: slope_gradients(coefficients(y), bounds) @ rounding / focal,
            },
            options={"maxiter": 500, "ftol": 1e-13},
        )
        left, right, rows = coefficients(found.x).reshape(3, 3)
        if options.columns == "shared":
            right = left
        u_left, u_right, v = (
            rb.Cubic(0.0, c[0], c[1], c[2], *span)
            for c, span in zip((left, right, rows), bounds, strict=True)
        )
        notes: dict[str, float | str] = {"energy": float(found.fun), "iterations": float(found.nit)}
        if not found.success:
            notes["warning"] = f"the minimisation ended early: {found.message}"
        return rb.Rectification.from_profiles(problem.rig, u_left, u_right, v, notes, view=bounds)


class Energy:
    """L of the coefficients (c1, c2, c3) of Ψ_u left, Ψ_u right and Ψ_v, with its gradient."""

    def __init__(self, problem: rb.Problem, options: Options) -> None:
        warps, pixels = problem.angle_warps(), (problem.pixels_left, problem.pixels_right)
        angles = [warp.forward(px) for warp, px in zip(warps, pixels, strict=True)]
        J = np.concatenate([warp.jacobian(px) for warp, px in zip(warps, pixels, strict=True)])
        (self.gamma_u, self.gamma_v), (self.beta_u, self.beta_v) = np.moveaxis(J, 0, -1)
        self.area = np.abs(self.gamma_u * self.beta_v - self.gamma_v * self.beta_u)
        gamma_left, gamma_right = (slope_basis(a[:, 0]) for a in angles)
        none_left, none_right = np.zeros_like(gamma_left), np.zeros_like(gamma_right)
        self.columns = np.block([[gamma_left, none_left], [none_right, gamma_right]])
        if options.columns == "shared":
            self.columns = np.block([[gamma_left, none_left], [gamma_right, none_right]])
        self.rows = slope_basis(np.concatenate([a[:, 1] for a in angles]))
        weights = np.array([1.0, options.alpha_ratio, options.alpha_skew])
        self.weights = np.sqrt(weights / len(self.rows))[:, None]

    def __call__(self, c: np.ndarray) -> tuple[float, np.ndarray]:
        """L, the mean per pixel, and its gradient."""
        loss, J = self.losses(c)
        return float(loss @ loss), 2 * loss @ J

    def losses(self, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weighted area, ratio and skew losses of all pixels, whose squares sum to L, and their d/dc."""
        A, B = self.columns @ c[:6], self.rows @ c[6:]  # Ψ_u'(γ) and Ψ_v'(β)
        w1, w2 = np.hypot(A * self.gamma_u, B * self.beta_u), np.hypot(A * self.gamma_v, B * self.beta_v)
        skew_u, skew_v = self.gamma_u * self.gamma_v, self.beta_u * self.beta_v
        loss = self.weights * [A * B * self.area - 1, w1 - w2, A**2 * skew_u + B**2 * skew_v]
        by_A = [B * self.area, A * (self.gamma_u**2 / w1 - self.gamma_v**2 / w2), 2 * A * skew_u]
        by_B = [A * self.area, B * (self.beta_u**2 / w1 - self.beta_v**2 / w2), 2 * B * skew_v]
        J_columns = (self.weights * by_A)[..., None] * self.columns
        J_rows = (self.weights * by_B)[..., None] * self.rows
        return loss.ravel(), np.concatenate([J_columns, J_rows], axis=-1).reshape(-1, 9)

    def rounding(self, c: np.ndarray) -> np.ndarray:
        """[9, 9], from coordinates in which L (after Gauss and Newton) has unit curvature at c."""
        _, J = self.losses(c)
        curvature = 2 * J.T @ J
        curvature += 1e-9 * np.trace(curvature) * np.eye(9)  # a coefficient may be without any effect
        return np.linalg.inv(np.linalg.cholesky(curvature)).T


def starting_point(options: Options, seed: int) -> np.ndarray:
    """Coefficients [9] in units of the source's centre resolution; random ones may even fall."""
    equidistant = np.tile([1.0, 0.0, 0.0], 3)
    if options.start == "equidistant":
        return equidistant
    rng = np.random.default_rng([seed, options.draw])
    return equidistant * rng.uniform(0.2, 3.0, 9) + rng.normal(0.0, 0.3, 9)


def slope_basis(theta: np.ndarray) -> np.ndarray:
    """Ψ'(θ) = slope_basis(θ) @ (c1, c2, c3)."""
    theta = np.asarray(theta, dtype=float)
    return np.stack([np.ones_like(theta), 2 * theta, 3 * theta**2], axis=-1)


def slope_places(c: np.ndarray, bounds: rb.ViewAngles) -> np.ndarray:
    """Where Ψ', a parabola, can be least on its range [3, 3]: both ends, and its vertex held inside."""
    low, high = np.array(bounds).T
    _, c2, c3 = c.reshape(3, 3).T
    vertex = -c2 / np.where(np.abs(c3) > 1e-12, 3 * c3, np.inf)
    return np.stack([low, high, np.clip(vertex, low, high)], axis=-1)


def slopes(c: np.ndarray, bounds: rb.ViewAngles) -> np.ndarray:
    """Ψ' at those places [9]: positive there is positive everywhere."""
    return np.einsum("kpi,ki->kp", slope_basis(slope_places(c, bounds)), c.reshape(3, 3)).ravel()


def slope_gradients(c: np.ndarray, bounds: rb.ViewAngles) -> np.ndarray:
    """d(slopes)/dc [9, 9]; Ψ' is flat at its vertex, so that the vertex's own motion adds nothing."""
    basis = slope_basis(slope_places(c, bounds))
    gradients = np.zeros((3, 3, 3, 3))
    for k in range(3):
        gradients[k, :, k] = basis[k]
    return gradients.reshape(9, 9)
