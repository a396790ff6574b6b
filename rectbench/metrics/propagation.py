"""The covariance of a rig's parameters, propagated to where a point appears in the right rectified image."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from rectbench.cameras.projection import projected_partials
from rectbench.cameras.sensitivity import parameter_constants, parameter_partials
from rectbench.formulas.evaluation import evaluate_points
from rectbench.rigs import Rig, RigCovariance
from rectbench.rigs.covariance import POSE
from rectbench.types import FloatArray
from rectbench.warps import Rectification
from rectbench.warps.rectification import in_frame
from rectbench.warps.warp import Vector, ray_derivatives, rotated, rotated_back

GROUPS = ("rotation", "translation", "left intrinsics", "right intrinsics")


class Propagation:
    """Variances of row error and of inverse distance, by the formulas that project and rectify.

    What is summed to them, g Σ gᵀ with a gradient g over the parameters, is summed in the kernel: the
    gradients of all pixels would fill the memory.
    """

    def __init__(self, rect: Rectification, rig: Rig, covariance: RigCovariance) -> None:
        self.rect, self.rig = rect, rig
        unsure = covariance.uncertain
        self.pose = tuple(name for name in unsure if name in POSE)
        self.left, self.right = (_of_part(unsure, side) for side in ("left", "right"))
        names = (*self.pose, *(f"left.{n}" for n in self.left), *(f"right.{n}" for n in self.right))
        self.groups = [_group(name) for name in names]
        self.matrix = covariance.over(names)
        self.constants = {
            "left": parameter_constants(rig.left, self.left),
            "right": parameter_constants(rig.right, self.right),
            "R": _rows(rig.R_right_left),
            "t": tuple(map(float, rig.t_right_left)),
            "warp": rect.right.constants,
            "covariance": _rows(self.matrix),
        }

    def at(self, pixels: FloatArray, inverse_depth: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of the points that the left source pixels [N, 2] show at this 1/d (1/m):

        the variance of the row error [N, 4], px², and of 1/d [N, 4], 1/m², as the sum of what each of
        `GROUPS` adds, and ∂û/∂(1/d) in the right image [N], px m. NaN where a point is not in both
        images, source and rectified.
        """
        columns = np.column_stack([pixels, np.full(len(pixels), inverse_depth)])
        values, _ = evaluate_points(self._formula, self.constants, columns)
        px_right = values[:, :2]
        px_rect = self.rect.left.forward(pixels), self.rect.right.forward(px_right)
        shown = in_frame(px_rect[0], self.rect.size) & in_frame(px_rect[1], self.rect.size)
        shown &= self.rig.left.contains(pixels) & self.rig.right.contains(px_right)
        values[~shown] = math.nan
        return values[:, 3:7], values[:, 7:], values[:, 2]

    def _formula(self, c: Any, u: Any, v: Any, inverse_depth: Any, xp: Any) -> tuple[Any, ...]:
        """Right source pixel, ∂û/∂(1/d), the groups' parts in row error and in 1/d, and the mask."""
        px_right, per_inverse, by_column, by_row, ok = self._slopes(c, u, v, inverse_depth, xp)
        of_row = self._variance_by_group(c, by_row, u)
        of_inverse = self._variance_by_group(c, [slope / per_inverse for slope in by_column], u)
        return *px_right, per_inverse, *of_row, *of_inverse, ok

    def _slopes(self, c: Any, u: Any, v: Any, inverse_depth: Any, xp: Any) -> tuple[Any, ...]:
        """Right source pixel; slopes of its û by 1/d, of û and of v̂ by all parameters; the mask."""
        left, right = self.rig.left, self.rig.right
        x, y, z, seen = left.unproject_formula(c.left.value, u, v, xp)
        turned = rotated(c.R, x, y, z)
        px, py, pz = (a + inverse_depth * b for a, b in zip(turned, c.t, strict=True))
        u_right, v_right, ok = right.project_formula(c.right.value, px, py, pz, xp)
        per_point = projected_partials(right, c.right.value, px, py, pz, xp)[:2]
        *J, warped = self.rect.right.jacobian_formula(c.warp, u_right, v_right, xp)
        by_left = parameter_partials(left, c.left, len(self.left), x, y, z, xp)[:2]
        by_right = parameter_partials(right, c.right, len(self.right), px, py, pz, xp)[:2]
        ray_per_pixel = ray_derivatives(*projected_partials(left, c.left.value, x, y, z, xp)[:2])

        def slopes(row: Sequence[Any]) -> tuple[Any, tuple[Any, ...]]:
            """Of one rectified coordinate, by 1/d and by the parameters."""
            gradient = _weighted(row, per_point)
            by_turn, by_shift = _cross(turned, gradient), tuple(inverse_depth * g for g in gradient)
            of_pose = dict(zip(POSE, (*by_turn, *by_shift), strict=True))
            # A pixel held fixed while its lens changes sees another ray.
            per_left_pixel = [-_dot(rotated_back(c.R, *gradient), d) for d in ray_per_pixel]
            return _dot(gradient, c.t), (
                *(of_pose[name] for name in self.pose),
                *_weighted(per_left_pixel, by_left),
                *_weighted(row, by_right),
            )

        (per_inverse, by_column), (_, by_row) = slopes(J[:2]), slopes(J[2:])
        return (u_right, v_right), per_inverse, by_column, by_row, seen & ok & warped

    def _variance_by_group(self, c: Any, gradient: Sequence[Any], like: Any) -> list[Any]:
        """The parts of g Σ gᵀ; that of a correlation between two groups goes to both in halves."""
        parts = dict.fromkeys(GROUPS, 0.0 * like)
        for group, slope, row, known in zip(self.groups, gradient, c.covariance, self.matrix, strict=True):
            terms = zip(row, gradient, known, strict=True)
            parts[group] = parts[group] + slope * sum(s * g for s, g, nonzero in terms if nonzero)
        return list(parts.values())


def _rows(matrix: FloatArray) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(map(float, row)) for row in matrix)


def _group(name: str) -> str:
    part, _, parameter = name.partition(".")
    if part == "pose":
        return "rotation" if parameter.startswith("r") else "translation"
    return f"{part} intrinsics"


def _of_part(names: Sequence[str], part: str) -> tuple[str, ...]:
    return tuple(name.removeprefix(f"{part}.") for name in names if name.startswith(f"{part}."))


def _weighted(pair: Sequence[Any], partials: Sequence[Sequence[Any]]) -> tuple[Any, ...]:
    """pair[0] * partials[0] + pair[1] * partials[1], entry by entry."""
    return tuple(pair[0] * a + pair[1] * b for a, b in zip(*partials, strict=True))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
