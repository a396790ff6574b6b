"""How a point's right rectified pixel hangs on the rig's parameters, at given left pixel and distance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from rectbench.cameras.arrays import FloatArray, evaluate_points
from rectbench.cameras.projection import projected_partials
from rectbench.cameras.sensitivity import parameter_constants, parameter_partials
from rectbench.metrics.coverage import in_frame
from rectbench.rigs import Rig
from rectbench.rigs.covariance import POSE
from rectbench.warps import Rectification
from rectbench.warps.warp import Vector, ray_derivatives, rotated, rotated_back

GROUPS = ("rotation", "translation", "left intrinsics", "right intrinsics")


class RigSlopes:
    """Exact derivatives, by the formulas that project and rectify, by the parameters `names` of the rig.

    `groups` [P, 4] says which of `GROUPS` each parameter is of.
    """

    def __init__(self, rect: Rectification, rig: Rig, names: Sequence[str]) -> None:
        self.rect, self.rig = rect, rig
        self.pose = tuple(name for name in names if name in POSE)
        self.left, self.right = (_of_part(names, side) for side in ("left", "right"))
        grouped = [*self.pose, *(f"left.{n}" for n in self.left), *(f"right.{n}" for n in self.right)]
        self.places = [grouped.index(name) for name in names]
        self.groups = np.array([[float(_group(name) == group) for group in GROUPS] for name in names])
        self.groups = self.groups.reshape(len(names), len(GROUPS))
        self.constants = {
            "left": parameter_constants(rig.left, self.left),
            "right": parameter_constants(rig.right, self.right),
            "R": tuple(tuple(map(float, row)) for row in rig.R_right_left),
            "t": tuple(map(float, rig.t_right_left)),
            "warp": rect.right.constants,
        }

    def at(self, pixels: FloatArray, inverse_depth: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Of the points that the left source pixels [N, 2] show at this 1/d (1/m):

        ∂v̂'/∂θ [N, P], ∂(1/d)/∂θ [N, P], and ∂û'/∂(1/d) [N] in px m; NaN where a point is not in both
        images, source and rectified.
        """
        columns = np.column_stack([pixels, np.full(len(pixels), inverse_depth)])
        values, _ = evaluate_points(self._formula, self.constants, columns)
        px_right = values[:, :2]
        px_rect = self.rect.left.forward(pixels), self.rect.right.forward(px_right)
        shown = in_frame(px_rect[0], self.rect.size) & in_frame(px_rect[1], self.rect.size)
        shown &= self.rig.left.contains(pixels) & self.rig.right.contains(px_right)
        values = np.where(shown[:, None], values, math.nan)
        by_column, by_row = (half[:, self.places] for half in np.split(values[:, 3:], 2, axis=1))
        with np.errstate(divide="ignore", invalid="ignore"):
            return by_row, by_column / values[:, 2:3], values[:, 2]

    def _formula(self, c: Any, u: Any, v: Any, inverse_depth: Any, xp: Any) -> tuple[Any, ...]:
        """Right source pixel, ∂û'/∂(1/d), the slopes of û' by all parameters, those of v̂', the mask."""
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
        return u_right, v_right, per_inverse, *by_column, *by_row, seen & ok & warped


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
