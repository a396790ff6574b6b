"""What a lens and a rectified image have in common: rays on one side, pixels on the other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.errors import InvalidInput
from rectbench.formulas.evaluation import evaluate_points
from rectbench.formulas.jets import JetNamespace, as_jets, constant, variables
from rectbench.formulas.protocol import Formulas
from rectbench.types import BoolArray, Constants, FloatArray

__all__ = ["BoolArray", "Projection", "as_points", "projected_partials"]


def as_points(array: ArrayLike, width: int, name: str) -> FloatArray:
    """`array` as float64 [..., width], or a clear error."""
    try:
        points = np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} are no array of numbers; expected [..., {width}]") from None
    if points.ndim == 0 or points.shape[-1] != width:
        raise InvalidInput(f"{name} has shape {points.shape}; expected [..., {width}]")
    return points


class Projection(ABC):
    """A mapping between rays (x right, y down, z forward) and pixels, invertible on its domain.

    A subclass states its two formulas against a namespace `xp` (see `rectbench.formulas.protocol`) and
    the constants in them; everything else, derivatives included, follows from those.

    >>> import rectbench as rb
    >>> class Stereographic(rb.Projection):  # 100 px · tan(θ/2) from the centre
    ...     constants = {"f": 100.0}
    ...     def project_formula(self, c, x, y, z, xp):
    ...         reach = xp.sqrt(x * x + y * y + z * z) + z
    ...         return c.f * x / reach, c.f * y / reach, reach > 0
    ...     def unproject_formula(self, c, u, v, xp):
    ...         p, q = u / c.f, v / c.f
    ...         square = p * p + q * q
    ...         return 2 * p / (1 + square), 2 * q / (1 + square), (1 - square) / (1 + square), square >= 0
    >>> Stereographic().project([1, 0, 0])
    (array([100.,   0.]), array(True))
    >>> Stereographic().project_jacobian([0, 0, 1])
    array([[50.,  0.,  0.], [ 0., 50.,  0.]])
    """

    @property
    @abstractmethod
    def constants(self) -> Constants:
        """The numbers in the formulas, by the names under which these read them."""

    @abstractmethod
    def project_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        """Pixel (u, v) of the ray (x, y, z), of any length, and whether the ray is in the domain."""

    @abstractmethod
    def unproject_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any]:
        """Unit ray (x, y, z) of the pixel (u, v), and whether the pixel is in the domain."""

    def project(self, rays: ArrayLike) -> tuple[FloatArray, BoolArray]:
        """Pixels [..., 2] of rays or points [..., 3] of any length, and the mask of valid ones.

        A ray outside the domain gives NaN. Pixels beyond the image's edge are valid here; see
        `Camera.contains`.
        """
        return evaluate_points(self.project_formula, self.constants, as_points(rays, 3, "rays"))

    def unproject(self, pixels: ArrayLike) -> tuple[FloatArray, BoolArray]:
        """Unit rays [..., 3] of pixels [..., 2], and the mask of valid ones; the others are NaN."""
        return evaluate_points(self.unproject_formula, self.constants, as_points(pixels, 2, "pixels"))

    def project_jacobian(self, rays: ArrayLike) -> FloatArray:
        """d(pixel)/d(ray) [..., 2, 3] at rays [..., 3]; NaN outside the domain.

        The pixel does not depend on the ray's length, so each row is orthogonal to the ray.
        """
        rays = as_points(rays, 3, "rays")
        partials, _ = evaluate_points(self._project_jacobian_formula, self.constants, rays)
        return partials.reshape(*rays.shape[:-1], 2, 3)

    def _project_jacobian_formula(self, c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, ...]:
        (ux, uy, uz), (vx, vy, vz), ok = projected_partials(self, c, x, y, z, xp)
        return ux, uy, uz, vx, vy, vz, ok

    def unproject_jacobian(self, pixels: ArrayLike) -> FloatArray:
        """d(unit ray)/d(pixel) [..., 3, 2] at pixels [..., 2]; NaN outside the domain.

        The pseudo-inverse of the projection's Jacobian: its rows are orthogonal to the ray, so its
        pseudo-inverse is the derivative that moves the ray along the unit sphere.
        """
        rays, _ = self.unproject(pixels)
        j = self.project_jacobian(rays)
        gram = j @ np.swapaxes(j, -1, -2)
        with np.errstate(invalid="ignore", divide="ignore"):
            determinant = gram[..., 0, 0] * gram[..., 1, 1] - gram[..., 0, 1] ** 2
            adjugate = np.stack(
                [gram[..., 1, 1], -gram[..., 0, 1], -gram[..., 0, 1], gram[..., 0, 0]], axis=-1
            ).reshape(gram.shape)
            return np.swapaxes(j, -1, -2) @ (adjugate / determinant[..., None, None])


def projected_partials(
    projection: Projection, c: Any, x: Any, y: Any, z: Any, xp: Formulas
) -> tuple[tuple[Any, ...], tuple[Any, ...], Any]:
    """The partial derivatives of u and of v by x, y, z, and the mask, as part of a formula."""
    u, v, ok = projection.project_formula(as_jets(c), *variables(x, y, z), JetNamespace(xp))
    return constant(u).partials, constant(v).partials, ok
