"""One image's way into the rectified frame: source pixel → ray → rotation → rectified pixel."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from numpy.typing import ArrayLike

from rectbench.cameras import Camera
from rectbench.cameras.projection import as_points, projected_partials
from rectbench.formulas.evaluation import evaluate_points
from rectbench.formulas.protocol import Formulas
from rectbench.rigs.rig import checked_rotation
from rectbench.types import Constants, FloatArray
from rectbench.warps.targets import Target


@dataclass(frozen=True, eq=False)
class Warp:
    """Target ∘ R_rect_cam ∘ Φ⁻¹: the paper's H = Ψ ∘ R ∘ Φ (section III), exactly invertible.

    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265")
    >>> warp = rb.rectify(rig, method="abraham").left
    >>> warp.forward([400.0, 400.0]).round(1), warp.jacobian([400.0, 400.0]).round(1)
    (array([378.5, 396.4]), array([[ 1.,  0.],
           [-0.,  1.]]))
    >>> warp.inverse(warp.forward([400.0, 400.0])).round(6)
    array([400., 400.])
    """

    source: Camera
    R_rect_cam: FloatArray = field(repr=False)
    """[3, 3], from the camera's frame to the rectified one."""
    target: Target

    def __post_init__(self) -> None:
        object.__setattr__(self, "R_rect_cam", checked_rotation(self.R_rect_cam, "R_rect_cam"))

    @property
    def constants(self) -> Constants:
        """The numbers in the warp's formulas."""
        rows = tuple(tuple(map(float, row)) for row in self.R_rect_cam)
        return {"source": self.source.constants, "R": rows, "target": self.target.constants}

    def forward(self, px: ArrayLike) -> FloatArray:
        """Rectified pixels [..., 2] of source pixels [..., 2]; NaN where there is none."""
        return evaluate_points(self._forward_formula, self.constants, as_points(px, 2, "px"))[0]

    def inverse(self, px_rect: ArrayLike) -> FloatArray:
        """Source pixels [..., 2] of rectified pixels [..., 2]; NaN where there is none."""
        return evaluate_points(self._inverse_formula, self.constants, as_points(px_rect, 2, "px_rect"))[0]

    def jacobian(self, px: ArrayLike) -> FloatArray:
        """d(rectified)/d(source) [..., 2, 2] at source pixels [..., 2]; NaN where there is none.

        Columns are the paper's w1 = d(û, v̂)/du and w2 = d(û, v̂)/dv.
        """
        entries, _ = evaluate_points(self.jacobian_formula, self.constants, as_points(px, 2, "px"))
        return entries.reshape(*entries.shape[:-1], 2, 2)

    def inverse_jacobian(self, px_rect: ArrayLike) -> FloatArray:
        """d(source)/d(rectified) [..., 2, 2] at rectified pixels [..., 2]; NaN where there is none.

        The inverse of `jacobian` at the source pixel: its columns span what a rectified pixel covers there.
        """
        points = as_points(px_rect, 2, "px_rect")
        entries, _ = evaluate_points(self._inverse_jacobian_formula, self.constants, points)
        return entries.reshape(*entries.shape[:-1], 2, 2)

    def _forward_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        x, y, z, seen = self.source.unproject_formula(c.source, u, v, xp)
        u_rect, v_rect, ok = self.target.project_formula(c.target, *rotated(c.R, x, y, z), xp)
        return u_rect, v_rect, ok & seen

    def _inverse_formula(self, c: Any, u_rect: Any, v_rect: Any, xp: Formulas) -> tuple[Any, Any, Any]:
        x, y, z, ok = self.target.unproject_formula(c.target, u_rect, v_rect, xp)
        u, v, seen = self.source.project_formula(c.source, *rotated_back(c.R, x, y, z), xp)
        return u, v, ok & seen

    def jacobian_formula(self, c: Any, u: Any, v: Any, xp: Formulas) -> tuple[Any, Any, Any, Any, Any]:
        """∂û/∂u, ∂û/∂v, ∂v̂/∂u, ∂v̂/∂v and the mask, for formulas over many pixels."""
        x, y, z, seen = self.source.unproject_formula(c.source, u, v, xp)
        du, dv, _ = projected_partials(self.source, c.source, x, y, z, xp)
        across, down = (rotated(c.R, *d) for d in ray_derivatives(du, dv))
        du_rect, dv_rect, ok = projected_partials(self.target, c.target, *rotated(c.R, x, y, z), xp)
        by_u, by_v = ((_dot(gradient, across), _dot(gradient, down)) for gradient in (du_rect, dv_rect))
        return *by_u, *by_v, ok & seen

    def _inverse_jacobian_formula(self, c: Any, u_rect: Any, v_rect: Any, xp: Formulas) -> tuple[Any, ...]:
        x, y, z, ok = self.target.unproject_formula(c.target, u_rect, v_rect, xp)
        du_rect, dv_rect, _ = projected_partials(self.target, c.target, x, y, z, xp)
        across, down = (rotated_back(c.R, *d) for d in ray_derivatives(du_rect, dv_rect))
        du, dv, seen = projected_partials(self.source, c.source, *rotated_back(c.R, x, y, z), xp)
        return _dot(du, across), _dot(du, down), _dot(dv, across), _dot(dv, down), ok & seen


Vector = tuple[Any, Any, Any]


def ray_derivatives(du: Vector, dv: Vector) -> tuple[Vector, Vector]:
    """d(unit ray)/du and d(unit ray)/dv from the projection's gradients du/d(ray) and dv/d(ray).

    The columns of the pseudo-inverse: the gradients are orthogonal to the ray, hence so are these.
    """
    uu, uv, vv = _dot(du, du), _dot(du, dv), _dot(dv, dv)
    determinant = uu * vv - uv * uv
    p, q, r = vv / determinant, uv / determinant, uu / determinant
    across = (p * du[0] - q * dv[0], p * du[1] - q * dv[1], p * du[2] - q * dv[2])
    down = (r * dv[0] - q * du[0], r * dv[1] - q * du[1], r * dv[2] - q * du[2])
    return across, down


def rotated(R: Any, x: Any, y: Any, z: Any) -> Vector:
    """R @ (x, y, z), entry by entry, for formulas."""
    return _dot(R[0], (x, y, z)), _dot(R[1], (x, y, z)), _dot(R[2], (x, y, z))


def rotated_back(R: Any, x: Any, y: Any, z: Any) -> Vector:
    """Rᵀ @ (x, y, z), entry by entry, for formulas."""
    a, b, c = R
    first, second, third = (a[i] * x + b[i] * y + c[i] * z for i in range(3))
    return first, second, third


def _dot(a: Any, b: Any) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
