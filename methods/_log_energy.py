"""Log distortion of û = h(γ), v̂ = g(β) as a function of the logarithms of their slopes: convex, exact.

With D = d(γ, β)/d(pixel), rows ∇γ and ∇β, and p = log h', q = log g' the Jacobian is diag(e^p, e^q) D. Of its
singular values σ1 ≥ σ2

    (log σ1 + log σ2) / 2 = (p + q + log |det D|) / 2                           linear in p and q
    (log σ1 - log σ2) / 2 = arcosh(κ cosh τ) / 2,  τ = p - q + log |∇γ| / |∇β|,  κ = |∇γ| |∇β| / |det D| ≥ 1

and arcosh(κ cosh τ) is convex in τ and never below 0. So the mean of log² σ1 + log² σ2 is convex in p and q,
for any lens and pose: where slopes are free, no descent can end at a minimum that is not the least one.
"""

from typing import NamedTuple

import numpy as np

import rectbench as rb

TINY = 1e-8
"""Below it arcosh(κ cosh τ)² / 2 cannot be told from τ² / 2, nor its derivatives."""


class WeightedPixels(NamedTuple):
    """Source pixels of one image, and how much each counts."""

    pixels: np.ndarray
    """[N, 2]"""
    weights: np.ndarray
    """[N]"""


class LogEnergy:
    """½ mean(log² σ1 + log² σ2) over weighted pixels of both images, left then right, and its derivatives.

    At the scale of least energy it is the square of the log distortion: that takes the mean away.
    """

    def __init__(
        self, angle_warps: tuple[rb.Warp, rb.Warp], left: WeightedPixels, right: WeightedPixels
    ) -> None:
        angles, jacobians, weights = [], [], []
        for warp, (pixels, weight) in zip(angle_warps, (left, right), strict=True):
            at, J = warp.forward(pixels), warp.jacobian(pixels)
            there = np.isfinite(J).all(axis=(1, 2))  # an epipole has no β
            angles.append(at[there])
            jacobians.append(J[there])
            weights.append(weight[there])
        self.gamma_left, self.gamma_right = (at[:, 0] for at in angles)
        self.beta = np.concatenate(angles)[:, 1]
        self.weights = np.concatenate(weights) / np.sum(np.concatenate(weights))
        (gamma_u, gamma_v), (beta_u, beta_v) = np.moveaxis(np.concatenate(jacobians), 0, -1)
        along, across = np.hypot(gamma_u, gamma_v), np.hypot(beta_u, beta_v)
        det = np.abs(gamma_u * beta_v - gamma_v * beta_u)
        self.log_area, self.log_ratio = np.log(det), np.log(along / across)
        self.kappa = along * across / det
        self.skew_squared = ((gamma_u * beta_u + gamma_v * beta_v) / det) ** 2  # κ² - 1, with all digits

    @property
    def effective_count(self) -> float:
        """How many pixels of equal weight tell as much (Kish)."""
        return float(1 / (self.weights @ self.weights))

    def __call__(self, p: np.ndarray, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """The energy of p, q [N], its gradient [2, N] and, pixel by pixel, second derivatives [2, 2, N]."""
        size = (p + q + self.log_area) / 2
        half, squeeze, curvature = self.squeeze(p - q + self.log_ratio)
        value = float(self.weights @ (size**2 + half / 2))
        gradient = self.weights * [size + squeeze / 2, size - squeeze / 2]
        same, mixed = self.weights * (1 + curvature) / 2, self.weights * (1 - curvature) / 2
        return value, gradient, np.array([[same, mixed], [mixed, same]])

    def squeeze(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """arcosh(κ cosh τ)² / 2 [N] and its first and second derivative by τ."""
        sinh, cosh = self.kappa * np.sinh(tau), self.kappa * np.cosh(tau)
        square = sinh * sinh + self.skew_squared  # sinh² of the whole
        whole = np.arcsinh(np.sqrt(square))
        round_ = square < TINY**2
        square = np.where(round_, 1.0, square)
        per_sinh = np.where(round_, 1.0, whole / np.sqrt(square))
        curvature = (sinh * sinh + per_sinh * cosh * self.skew_squared) / square
        return whole**2 / 2, per_sinh * sinh, np.where(round_, 1.0, curvature)
