"""How far out a distortion of the lens plane keeps its points apart, whatever its formula."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

from rectbench.formulas.domain import LEAST_SLOPE
from rectbench.formulas.jets import JetNamespace, as_jets, variables
from rectbench.formulas.namespaces import NUMPY

PlaneFormula = Callable[[Any, Any, Any, Any], tuple[Any, Any]]
"""formula(c, a, b, xp): where a distortion puts the point (a, b) of the plane."""

DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 180)


def edge_of_disk(
    formula: PlaneFormula,
    c: SimpleNamespace,
    radius: float,
    slope_before: Callable[[float], float] = lambda _: 1.0,
) -> dict[str, float]:
    """The greatest radius, up to the given one, on which the formula is monotone, and its image's.

    `slope_before` is the slope, at a radius, of a step before this one: the two together keep above
    `LEAST_SLOPE`. The formula alone must do so on the given radius, see `monotone_radius`.
    """

    def steep(radius: float) -> bool:
        own = float(_least_eigenvalue(formula, c, radius, DIRECTIONS).min())
        return own * slope_before(radius) >= 0.99 * LEAST_SLOPE

    if not steep(radius):
        low, high = 0.0, radius
        while high - low > 1e-9 * high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if steep(middle) else (low, middle)
        radius = low
    image = formula(c, radius * np.cos(DIRECTIONS), radius * np.sin(DIRECTIONS), NUMPY)
    return {"max_radius": radius, "reach": 1.01 * float(np.hypot(*image).max())}


def monotone_radius(formula: PlaneFormula, c: SimpleNamespace, farthest: float) -> float:
    """The greatest radius, up to `farthest`, on which the formula is monotone.

    Monotone: the symmetric part of its Jacobian keeps its eigenvalues above `LEAST_SLOPE` on the
    disk of that radius, so no two of its points land on one.
    """
    # Angles instead of radii, as a step in radius means less the farther out it is taken; and ever
    # finer about the direction that folds first.
    low, high, direction, reach = 0.0, math.atan(farthest), 0.0, math.pi
    for _ in range(5):
        angles = np.linspace(low, high, 64)
        directions = direction + np.linspace(-reach, reach, 180)
        least = _least_eigenvalue(formula, c, np.tan(angles)[:, None], directions)
        falling = np.flatnonzero(~(least.min(axis=1) >= LEAST_SLOPE))
        if not falling.size:
            return math.tan(high)
        low, high = angles[max(falling[0] - 2, 0)], angles[falling[0]]
        direction, reach = directions[least[falling[0]].argmin()], reach / 20.0
    return math.tan(low)


def _least_eigenvalue(formula: PlaneFormula, c: SimpleNamespace, radius: Any, direction: Any) -> Any:
    """Least eigenvalue of the symmetric part of the Jacobian at points in polar coordinates."""
    a, b = radius * np.cos(direction), radius * np.sin(direction)
    p, q = formula(as_jets(c), *variables(a, b), JetNamespace(NUMPY))
    (pa, pb), (qa, qb) = p.partials, q.partials
    return 0.5 * (pa + qb) - np.hypot(0.5 * (pa - qb), 0.5 * (pb + qa))
