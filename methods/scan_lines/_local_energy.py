"""What local homography minimises, and the constraint it does so under, both with exact derivatives.

Ψ(θ) = c0 + c1 f + c2 f² + c3 f³, f = f(θ), for Ψ_u of either image and Ψ_v of both: nine coefficients c,
since c0 only places the image in its frame.
"""

from collections.abc import Callable, Mapping

import numpy as np

import rectbench as rb

SLOPES: Mapping[str, Callable[[np.ndarray], np.ndarray]] = {
    "equidistant": np.ones_like,
    "stereographic": lambda theta: 1 / np.cos(theta / 2) ** 2,
    "equisolid": lambda theta: np.cos(theta / 2),
    "orthographic": np.cos,
    "cylindrical": lambda theta: 1 / np.cos(theta) ** 2,
}
"""f'(θ) of the lens laws."""

LARGEST_SHARE = 0.999
"""Of the angle at which f or its slope ends: nearer to it there are no digits left."""


class Law:
    """f(θ), rising on the view, by the name of a lens law."""

    def __init__(self, name: str, bounds: rb.ViewAngles) -> None:
        """Raises Unsupported where the view reaches beyond the angles that the law has."""
        self.name, self.profile, self.bounds = name, rb.Radial(name, 1.0, 0.0), bounds
        reach, limit = np.abs(bounds).max(), self.profile.high
        if name != "equidistant" and reach > LARGEST_SHARE * limit:
            limit_deg, reach_deg = np.degrees([limit, reach])
            raise rb.Unsupported(
                f"model={name} ends at {limit_deg:.0f} degrees; the view reaches {reach_deg:.1f}"
            )

    def slope_basis(self, theta: np.ndarray) -> np.ndarray:
        """Ψ'(θ) = slope_basis(θ) @ (c1, c2, c3)."""
        slope = SLOPES[self.name](np.asarray(theta, dtype=float))
        return slope[..., None] * parabola(self.profile(theta))

    def profiles(self, c: np.ndarray) -> list[rb.Profile]:
        """Ψ_u left, Ψ_u right and Ψ_v of the coefficients [9]; that they rise is checked, exactly."""
        spans = zip(c.reshape(3, 3), self.bounds, strict=True)
        return [self.profile_of(three, *span) for three, span in spans]

    def profile_of(self, c: np.ndarray, low: float, high: float) -> rb.Profile:
        if self.name == "equidistant":  # f(θ) = θ
            return rb.Cubic(0.0, c[0], c[1], c[2], low, high)
        f_low, f_high = map(float, self.profile([low, high]))
        return rb.Composed(rb.Cubic(0.0, c[0], c[1], c[2], f_low, f_high), self.profile, low, high)


class Energy:
    """L of the coefficients (c1, c2, c3) of Ψ_u left, Ψ_u right and Ψ_v, with its gradient."""

    def __init__(
        self, problem: rb.Problem, law: Law, alphas: tuple[float, float], columns: str = "per-image"
    ) -> None:
        warps, pixels = problem.angle_warps(), (problem.pixels_left, problem.pixels_right)
        angles = [warp.forward(px) for warp, px in zip(warps, pixels, strict=True)]
        J = np.concatenate([warp.jacobian(px) for warp, px in zip(warps, pixels, strict=True)])
        (self.gamma_u, self.gamma_v), (self.beta_u, self.beta_v) = np.moveaxis(J, 0, -1)
        self.area = np.abs(self.gamma_u * self.beta_v - self.gamma_v * self.beta_u)
        gamma_left, gamma_right = (law.slope_basis(a[:, 0]) for a in angles)
        none_left, none_right = np.zeros_like(gamma_left), np.zeros_like(gamma_right)
        self.columns = np.block([[gamma_left, none_left], [none_right, gamma_right]])
        if columns == "shared":
            self.columns = np.block([[gamma_left, none_left], [gamma_right, none_right]])
        self.rows = law.slope_basis(np.concatenate([a[:, 1] for a in angles]))
        self.weights = np.sqrt(np.array([1.0, *alphas]) / len(self.rows))[:, None]

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


class Slopes:
    """dΨ/df where it can be least, which has to be positive: it is a parabola in f, so everywhere."""

    def __init__(self, law: Law) -> None:
        self.ranges = law.profile(np.array(law.bounds))

    def __call__(self, c: np.ndarray) -> np.ndarray:
        """[9], at three places for each of the three."""
        return np.einsum("kpi,ki->kp", parabola(self.places(c)), c.reshape(3, 3)).ravel()

    def jacobian(self, c: np.ndarray) -> np.ndarray:
        """d/dc [9, 9]; a parabola is flat at its vertex, so that the vertex's own motion adds nothing."""
        basis = parabola(self.places(c))
        gradients = np.zeros((3, 3, 3, 3))
        for k in range(3):
            gradients[k, :, k] = basis[k]
        return gradients.reshape(9, 9)

    def places(self, c: np.ndarray) -> np.ndarray:
        """[3, 3] values of f: both ends of the range, and the vertex held inside."""
        low, high = self.ranges.T
        _, c2, c3 = c.reshape(3, 3).T
        vertex = -c2 / np.where(np.abs(c3) > 1e-12, 3 * c3, np.inf)
        return np.stack([low, high, np.clip(vertex, low, high)], axis=-1)


def parabola(f: np.ndarray) -> np.ndarray:
    """dΨ/df = parabola(f) @ (c1, c2, c3)."""
    f = np.asarray(f, dtype=float)
    return np.stack([np.ones_like(f), 2 * f, 3 * f**2], axis=-1)
