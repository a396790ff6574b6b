"""Both distortions of any map û = h(β, γ), v̂ = g(β), pixel by pixel, with exact first and second derivatives.

With x = (∂h/∂γ, ∂h/∂β, g') and D = d(γ, β)/d(pixel) the Jacobian is ((x0, x1), (0, x2)) D. The squared
lengths of its columns w1 and w2, their product and its determinant

    P = |w1|²,  Q = |w2|²,  R = w1·w2,  S = |det J|

are quadratic forms of x, and both measures are functions of the four.
"""

from collections.abc import Callable, Mapping

import numpy as np

import rectbench as rb

from ._log_energy import WeightedPixels

ROUND = 1e-6
"""Where X - 1 is less, arcosh² X is told from its series: the rest of it is below rounding."""

Derivatives = tuple[np.ndarray, np.ndarray, np.ndarray]
"""A value a pixel [N], its derivatives [k, N] and its second ones [k, k, N]."""


def log_energy(P: np.ndarray, Q: np.ndarray, R: np.ndarray, S: np.ndarray) -> Derivatives:
    """½ (log² σ1 + log² σ2) = ¼ (log² S + arcosh² X), X = (P + Q) / 2S: that is cosh(log σ1 - log σ2).

    At the scale of least energy its mean is the square of the log distortion. R is in it through S alone,
    since P Q = R² + S².
    """
    log_S, X = np.log(S), (P + Q) / (2 * S)
    above = np.maximum(X - 1, 0.0)
    sinh_squared = above * (above + 2)
    squeeze = np.arcsinh(np.sqrt(sinh_squared))
    is_round = above < ROUND
    apart = np.where(is_round, 1.0, sinh_squared)
    by_X = np.where(is_round, 1 - above / 3, squeeze / np.sqrt(apart)) / 2
    by_XX = np.where(is_round, -1 / 3, (1 - 2 * X * by_X) / apart) / 2
    none = np.zeros_like(S)
    X_by = np.array([1 / (2 * S), 1 / (2 * S), none, -X / S])
    first = by_X * X_by
    first[3] += log_S / (2 * S)
    second = by_XX * X_by[:, None] * X_by
    second[3, :2] -= by_X / (2 * S**2)
    second[:2, 3] -= by_X / (2 * S**2)
    second[3, 3] += (2 * X * by_X + (1 - log_S) / 2) / S**2
    return (log_S**2 + squeeze**2) / 4, first, second


def paper_energy(P: np.ndarray, Q: np.ndarray, R: np.ndarray, S: np.ndarray) -> Derivatives:
    """L = (S - 1)² + ½ (√P - √Q)² + ½ R² (Zhou, Dai and Li, section III-D, α1 = α2 = ½)."""
    root = np.sqrt(P * Q)
    second = np.zeros((4, 4, len(S)))
    second[0, 0], second[1, 1] = root / (4 * P**2), root / (4 * Q**2)
    second[0, 1] = second[1, 0] = -1 / (4 * root)
    second[2, 2], second[3, 3] = 1.0, 2.0
    first = np.array([(1 - root / P) / 2, (1 - root / Q) / 2, R, 2 * (S - 1)])
    return (S - 1) ** 2 + (P + Q) / 2 - root + R**2 / 2, first, second


ENERGIES: Mapping[str, Callable[..., Derivatives]] = {"log": log_energy, "L": paper_energy}


class StretchEnergy:
    """The mean of one of the two over weighted pixels of both images, left then right."""

    def __init__(
        self,
        objective: str,
        angle_warps: tuple[rb.Warp, rb.Warp],
        left: WeightedPixels,
        right: WeightedPixels,
    ) -> None:
        self.of, self.pixels, self.angles = ENERGIES[objective], [], []
        jacobians, weights = [], []
        for warp, (pixels, weight) in zip(angle_warps, (left, right), strict=True):
            J = warp.jacobian(pixels)
            there = np.isfinite(J).all(axis=(1, 2))  # an epipole has no β
            self.pixels.append(pixels[there])
            self.angles.append(warp.forward(pixels[there]))  # (γ, β) [N, 2]
            jacobians.append(J[there])
            weights.append(weight[there])
        self.weights = np.concatenate(weights) / np.sum(np.concatenate(weights))
        self.forms = doubled_forms(np.concatenate(jacobians))

    def __call__(self, x: np.ndarray) -> Derivatives:
        """Of x [N, 3] at the pixels: what each adds to the mean [N], by x [3, N], by x twice [3, 3, N]."""
        halves = np.einsum("knij,nj->kni", self.forms, x)
        value, first, second = self.of(*(np.einsum("kni,ni->kn", halves, x) / 2))
        by_x = np.einsum("kn,kni->in", first, halves)
        bent = np.einsum("kln,kni->lni", second, halves)
        by_xx = np.einsum("kn,knij->ijn", first, self.forms) + np.einsum("lni,lnj->ijn", bent, halves)
        return self.weights * value, self.weights * by_x, self.weights * by_xx

    def of_rectification(self, rect: rb.Rectification) -> float:
        """Of any map, by its Jacobian; infinite where it does not map all the pixels."""
        warps = zip((rect.left, rect.right), self.pixels, strict=True)
        (a, b), (c, d) = np.moveaxis(np.concatenate([warp.jacobian(px) for warp, px in warps]), 0, -1)
        with np.errstate(invalid="ignore", divide="ignore"):
            value, _, _ = self.of(a * a + c * c, b * b + d * d, a * b + c * d, np.abs(a * d - b * c))
        mean = float(self.weights @ value)
        return mean if np.isfinite(mean) else np.inf

    @property
    def effective_count(self) -> float:
        """How many pixels of equal weight tell as much (Kish)."""
        return float(1 / (self.weights @ self.weights))


def doubled_forms(D: np.ndarray) -> np.ndarray:
    """2 P, 2 Q, 2 R and 2 S as matrices [4, N, 3, 3], of D = d(γ, β)/d(pixel) [N, 2, 2]."""
    gamma, beta = np.moveaxis(D, 0, -1)
    forms = np.zeros((4, len(D), 3, 3))
    for form, (u, v) in zip(forms, ((0, 0), (1, 1), (0, 1)), strict=False):
        form[:, 0, 0] = 2 * gamma[u] * gamma[v]
        form[:, 0, 1] = form[:, 1, 0] = gamma[u] * beta[v] + gamma[v] * beta[u]
        form[:, 1, 1] = form[:, 2, 2] = 2 * beta[u] * beta[v]
    forms[3, :, 0, 2] = forms[3, :, 2, 0] = np.abs(gamma[0] * beta[1] - gamma[1] * beta[0])
    return forms
