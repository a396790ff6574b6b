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
from scipy import sparse
from scipy.optimize import OptimizeResult, minimize

import rectbench as rb

SMOOTHING = 1e-7
"""Weight of the differences of log slopes, too small to matter but where no pixel is."""
GRADIENT, FARTHEST_STEP = 1e-7, 10.0
"""Where a fit ends, and how far it may step in the logarithms at once."""
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


class Splines:
    """h of either image and g as splines of so many intervals, by the logs α of their control slopes."""

    def __init__(self, energy: LogEnergy, view: rb.ViewAngles, intervals: int, columns: str) -> None:
        self.energy, self.intervals = energy, intervals
        self.knots = [np.linspace(*span, intervals + 1) for span in view]
        angles = (energy.gamma_left, energy.gamma_right, energy.beta)
        left, right, rows = (
            sparse.csr_array(rb.MonotoneSpline.slope_basis(k, a))
            for k, a in zip(self.knots, angles, strict=True)
        )
        stacked = sparse.vstack if columns == "shared" else sparse.block_diag
        self.bases = sparse.csr_array(stacked([left, right])), rows
        each = intervals + 2
        self.split = self.bases[0].shape[1]
        self.count = self.split + each
        changes = np.diff(np.eye(each), axis=0)
        self.smoothing = np.kron(np.eye(self.count // each), SMOOTHING * changes.T @ changes)

    def least(self, alpha: np.ndarray) -> OptimizeResult:
        """What the solver says of the α [M] of least energy, from a start."""
        return minimize(
            self.value_and_gradient,
            alpha,
            jac=True,
            hess=self.hessian,
            method="trust-exact",
            options={"gtol": GRADIENT, "max_trust_radius": FARTHEST_STEP},
        )

    def value_and_gradient(self, alpha: np.ndarray) -> tuple[float, np.ndarray]:
        """The energy of α [M], and its gradient [M]."""
        shares, logs = self.shares(alpha)
        value, gradient, _ = self.energy(*logs)
        by_alpha = np.concatenate([w.T @ g for w, g in zip(shares, gradient, strict=True)])
        smoothed = self.smoothing @ alpha
        return value + float(alpha @ smoothed) / 2, by_alpha + smoothed

    def hessian(self, alpha: np.ndarray) -> np.ndarray:
        """Second derivatives [M, M] of the energy."""
        shares, logs = self.shares(alpha)
        _, gradient, second = self.energy(*logs)
        found = self.smoothing + np.diag(
            np.concatenate([w.T @ g for w, g in zip(shares, gradient, strict=True)])
        )
        ends = slice(None, self.split), slice(self.split, None)
        for i, j in np.ndindex(2, 2):
            bent = second[i, j] - gradient[i] * (i == j)  # the shares change too
            found[ends[i], ends[j]] += (shares[i].T @ (sparse.diags_array(bent) @ shares[j])).toarray()
        return found

    def shares(self, alpha: np.ndarray) -> tuple[list[sparse.csr_array], list[np.ndarray]]:
        """Of the slope at each pixel the share of each e^α [N, M], and its logarithm: of columns and rows."""
        shares, logs = [], []
        for basis, a in zip(self.bases, (alpha[: self.split], alpha[self.split :]), strict=True):
            slopes = basis @ np.exp(a)
            shares.append(sparse.diags_array(1 / slopes) @ basis @ sparse.diags_array(np.exp(a)))
            logs.append(np.log(slopes))
        return shares, logs

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
