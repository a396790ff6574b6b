"""The fundamental matrix of pinhole matches: normalised eight points, refined on the Sampson error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from rectbench.cameras.projection import as_points
from rectbench.errors import InvalidInput
from rectbench.types import FloatArray

DEGENERATE = 1e-9
"""Spread, relative to where the points lie, that is rounding."""


def fundamental_matrix(px_left: ArrayLike, px_right: ArrayLike) -> FloatArray:
    """F [3, 3] of rank 2 with (right, 1)ᵀ F (left, 1) = 0, Frobenius norm 1, from matches without outliers.

    Hartley's normalised eight-point solution (In Defense of the Eight-Point Algorithm, 1997), then
    Levenberg-Marquardt on the Sampson error over the rank-2 matrices F = U diag(1, s, 0) Vᵀ.
    Raises InvalidInput for fewer than 8 matches or matches in one line.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> left = np.random.default_rng(0).uniform(0, 640, (20, 2))
    >>> shifts = np.linspace(5, 40, 20) ** 1.5
    >>> right = left - np.stack([shifts, np.zeros(20)], axis=1)  # along rows: already rectified
    >>> np.abs(rb.fundamental_matrix(left, right)).round(3)
    array([[0.   , 0.   , 0.   ], [0.   , 0.   , 0.707], [0.   , 0.707, 0.   ]])
    """
    left, right = as_points(px_left, 2, "px_left"), as_points(px_right, 2, "px_right")
    if left.shape != right.shape or left.ndim != 2 or len(left) < 8:
        raise InvalidInput(
            f"matches have shapes {left.shape} and {right.shape}; expected [N, 2] twice, N >= 8"
        )
    T_left, T_right = _normalisation(left), _normalisation(right)
    x = _homogeneous(left) @ T_left.T
    y = _homogeneous(right) @ T_right.T
    equations = (y[:, :, None] * x[:, None, :]).reshape(len(x), 9)
    *_, vt = np.linalg.svd(equations, full_matrices=len(x) < 9)
    F = T_right.T @ _refined(vt[-1].reshape(3, 3), x, y) @ T_left
    return F / np.linalg.norm(F)


def sampson_residuals(F: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
    """Signed Sampson distances [N], in the unit of the homogeneous points [N, 3].

    >>> import numpy as np
    >>> import rectbench as rb
    >>> F = np.array([[0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])  # of a rectified pair: rows correspond
    >>> left, right = np.array([[9.0, 5.0, 1.0]]), np.array([[4.0, 5.2, 1.0]])
    >>> np.abs(rb.sampson_residuals(F, left, right)).round(3)  # either pixel moves by half of 0.2
    array([0.141])
    """
    lines_right, lines_left = left @ F.T, right @ F
    # Column by column: fits ask by the thousand, and sums over so short an axis take three times as long.
    (a, b, c), (d, e, f) = right.T, lines_right.T
    p, q, _ = lines_left.T
    residuals: FloatArray = (a * d + b * e + c * f) / np.sqrt((d * d + e * e) + (p * p + q * q))
    return residuals


def _refined(F: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
    """The rank-2 matrix near F with the least Sampson error, parametrised by two turns and a ratio."""
    U, s, Vt = np.linalg.svd(F)

    def matrix(p: FloatArray) -> FloatArray:
        middle = np.diag([1.0, s[1] / s[0] + p[6], 0.0])
        product: FloatArray = U @ _turn(p[:3]) @ middle @ _turn(p[3:6]).T @ Vt
        return product

    def residuals(p: FloatArray) -> FloatArray:
        return sampson_residuals(matrix(p), left, right)

    return matrix(least_squares(residuals, np.zeros(7), method="lm", xtol=1e-14).x)


def _turn(omega: FloatArray) -> FloatArray:
    return Rotation.from_rotvec(omega).as_matrix()


def _normalisation(points: FloatArray) -> FloatArray:
    """The similarity that brings points to mean 0 and mean distance √2."""
    centre = points.mean(axis=0)
    spread = np.linalg.norm(points - centre, axis=1).mean()
    _, across = np.linalg.svd(points - centre, compute_uv=False)
    if not across > DEGENERATE * (1 + np.abs(centre).max()) * np.sqrt(len(points)):
        raise InvalidInput(
            "all matches are the same pixel or in one line; expected them spread over the image"
        )
    scale = np.sqrt(2) / spread
    return np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1.0]])


def _homogeneous(points: FloatArray) -> FloatArray:
    return np.column_stack([points, np.ones(len(points))])
