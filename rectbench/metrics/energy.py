"""The shape of the energy: L over two coefficients of a fitted map, the others held.

Zhou, Dai and Li, section III-E and its figure "Energy curves". A coefficient is moved in steps of what
it does: a change of 1 turns the slope Ψ' at the far end of its range by the cubic's mean slope, so
that c1, c2 and c3, whose units differ, stand on one scale.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rectbench.errors import InvalidInput
from rectbench.metrics.distortion import WEIGHTS
from rectbench.plugins.metric import Case, Column, Metric
from rectbench.types import FloatArray
from rectbench.warps import Cubic, Epipolar, Profile, Rectification, Warp, evaluation_pixels
from rectbench.warps.jacobians import entries
from rectbench.warps.targets import ANGLES

COEFFICIENTS = ("u1", "u2", "u3", "v1", "v2", "v3")
"""c1, c2, c3 of the left image's û = Ψ_u(γ), and of v̂ = Ψ_v(β), which both images share."""
SLICES = (("u1", "v1"), ("u1", "u3"), ("v1", "v3"))
"""The pairs that are shown and counted: both scales, and scale against bend along each axis."""
SPAN, COUNT = 0.5, 41
_CHUNK = 32
"""Grid points at a time: arrays over their pixels stay in the cache."""


@dataclass(frozen=True, eq=False)
class EnergySlice:
    """L of a rectification whose two coefficients are changed, on a grid about their fitted values."""

    first: str
    second: str
    steps: FloatArray
    """[n], the change of either coefficient: 1 turns the slope at the range's end by the mean slope."""
    energy: FloatArray
    """[n, n], mean L per pixel over both images; rows follow `first`, columns `second`."""
    feasible: NDArray[np.bool_]
    """[n, n], where every cubic still rises over its whole range."""

    @property
    def convex(self) -> NDArray[np.bool_]:
        """[n - 2, n - 2], the inner points where the Hessian over both is positive definite."""
        L = self.energy
        aa = L[2:, 1:-1] - 2 * L[1:-1, 1:-1] + L[:-2, 1:-1]
        bb = L[1:-1, 2:] - 2 * L[1:-1, 1:-1] + L[1:-1, :-2]
        ab = (L[2:, 2:] - L[2:, :-2] - L[:-2, 2:] + L[:-2, :-2]) / 4
        definite: NDArray[np.bool_] = (aa > 0) & (aa * bb > ab * ab)
        return definite

    @property
    def convex_share(self) -> float:
        """Share of the feasible inner points that are convex."""
        inner = self.feasible[1:-1, 1:-1]
        return float(self.convex[inner].mean()) if inner.any() else math.nan


@dataclass(frozen=True, eq=False)
class EnergyCurve:
    """The same over one coefficient: `steps`, `energy` and `feasible` are [n]."""

    name: str
    steps: FloatArray
    energy: FloatArray
    feasible: NDArray[np.bool_]


def energy_slice(
    rect: Rectification, first: str, second: str, span: float = SPAN, count: int = COUNT
) -> EnergySlice:
    """L over `count` x `count` changes of two coefficients by -span to span, on the evaluation pixels.

    Raises InvalidInput for an unknown coefficient, and for a rectification that is no pair of cubics.
    """
    return _Landscape(rect).slice(first, second, np.linspace(-span, span, count))


def energy_curve(rect: Rectification, name: str, span: float = SPAN, count: int = COUNT) -> EnergyCurve:
    """L over changes of one coefficient; see `energy_slice`."""
    steps = np.linspace(-span, span, count)
    energy, feasible = _Landscape(rect).at(steps[:, None] * _unit(name))
    return EnergyCurve(name, steps, energy, feasible)


def energy_convex_share(rect: Rectification, span: float = SPAN, count: int = COUNT) -> float:
    """Share of the feasible inner grid points, over all SLICES, where L is convex; NaN without cubics."""
    if not has_cubics(rect):
        return math.nan
    landscape, steps = _Landscape(rect), np.linspace(-span, span, count)
    slices = [landscape.slice(first, second, steps) for first, second in SLICES]
    convex = np.concatenate([s.convex[s.feasible[1:-1, 1:-1]] for s in slices])
    return float(convex.mean()) if convex.size else math.nan


def has_cubics(rect: Rectification) -> bool:
    """Whether both images are û = Ψ_u(γ), v̂ = Ψ_v(β) with cubics."""
    targets = (rect.left.target, rect.right.target)
    return all(isinstance(t, Epipolar) and isinstance(t.u, Cubic) and isinstance(t.v, Cubic) for t in targets)


class _Landscape:
    """L as a function of changes [K, 6] of the COEFFICIENTS; what does not change is computed once."""

    def __init__(self, rect: Rectification) -> None:
        if not has_cubics(rect):
            raise InvalidInput("the energy's shape was asked of a rectification that is no pair of cubics")
        self._left, self._right = _Side(rect.left), _Side(rect.right)

    def slice(self, first: str, second: str, steps: FloatArray) -> EnergySlice:
        a, b = np.meshgrid(steps, steps, indexing="ij")
        changes = a[..., None] * _unit(first) + b[..., None] * _unit(second)
        energy, feasible = self.at(changes.reshape(-1, len(COEFFICIENTS)))
        return EnergySlice(first, second, steps, energy.reshape(a.shape), feasible.reshape(a.shape))

    def at(self, changes: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
        """L [K], and whether all cubics rise [K]."""
        columns, rows = changes[:, :3], changes[:, 3:]
        held = np.zeros_like(columns)
        left, right = self._left, self._right
        if not rows.any():  # Ψ_u of the left image alone: one value serves for all of the right one
            total = left.losses(columns, rows) + right.losses(held[:1], rows[:1])
        else:
            total = left.losses(columns, rows) + right.losses(held, rows)
        feasible = left.rises(columns, rows) & right.rises(held, rows)
        return total / (left.pixels + right.pixels), feasible


class _Side:
    """One image's angle derivatives at its evaluation pixels, and its two cubics."""

    def __init__(self, warp: Warp) -> None:
        pixels = evaluation_pixels(warp.source)
        pixels = pixels[np.isfinite(warp.forward(pixels)).all(axis=1)]
        to_angles = Warp(warp.source, warp.R_rect_cam, ANGLES)
        gamma, beta = to_angles.forward(pixels).T
        a, b, c, d = entries(to_angles.jacobian(pixels))
        assert isinstance(warp.target, Epipolar)
        self.pixels = len(pixels)
        self._u, self._v = _slopes(warp.target.u), _slopes(warp.target.v)
        self._along, self._across = _slope_basis(gamma), _slope_basis(beta)
        self._area = np.abs(a * d - b * c)
        self._squares = (a * a, c * c, b * b, d * d)
        self._skew_u, self._skew_v = a * b, c * d

    def losses(self, columns: FloatArray, rows: FloatArray) -> FloatArray:
        """Sum of L over the pixels [K], of changes [K, 3] of Ψ_u and of Ψ_v."""
        sums = [
            self._sum(columns[start : start + _CHUNK], rows[start : start + _CHUNK])
            for start in range(0, len(columns), _CHUNK)
        ]
        return np.concatenate(sums)

    def _sum(self, columns: FloatArray, rows: FloatArray) -> FloatArray:
        A, B = self._u.changed(columns) @ self._along, self._v.changed(rows) @ self._across
        AA, BB = A * A, B * B
        gu, bu, gv, bv = self._squares
        w1, w2 = np.sqrt(AA * gu + BB * bu), np.sqrt(AA * gv + BB * bv)
        area, ratio, skew = np.abs(A * B) * self._area - 1, w1 - w2, AA * self._skew_u + BB * self._skew_v
        weights = WEIGHTS**2
        total: FloatArray = sum(
            weight * np.einsum("kn,kn->k", loss, loss)
            for weight, loss in zip(weights, (area, ratio, skew), strict=True)
        )
        return total

    def rises(self, columns: FloatArray, rows: FloatArray) -> NDArray[np.bool_]:
        """Whether Ψ_u and Ψ_v rise over their whole range [K]."""
        return self._u.rises(columns) & self._v.rises(rows)


@dataclass(frozen=True, eq=False)
class _Slopes:
    """(c1, c2, c3) of a cubic, the changes of them that make one step, and its range."""

    coefficients: FloatArray
    steps: FloatArray
    low: float
    high: float

    def changed(self, changes: FloatArray) -> FloatArray:
        return self.coefficients + self.steps * changes

    def rises(self, changes: FloatArray) -> NDArray[np.bool_]:
        """Whether Ψ' > 0: at both ends and, where the parabola has it inside, at its vertex."""
        c = self.changed(changes)
        with np.errstate(divide="ignore", invalid="ignore"):
            vertex = np.clip(np.nan_to_num(-c[:, 1] / (3 * c[:, 2])), self.low, self.high)
        places = (np.full_like(vertex, self.low), np.full_like(vertex, self.high), vertex)
        positive = [np.einsum("ki,ik->k", c, _slope_basis(place)) > 0 for place in places]
        rising: NDArray[np.bool_] = np.all(positive, axis=0)
        return rising


def _slopes(profile: Profile) -> _Slopes:
    assert isinstance(profile, Cubic)
    far = max(abs(profile.low), abs(profile.high))
    mean = float(profile(profile.high) - profile(profile.low)) / (profile.high - profile.low)
    steps = mean / _slope_basis(np.array([far]))[:, 0]
    return _Slopes(np.array([profile.c1, profile.c2, profile.c3]), steps, profile.low, profile.high)


def _slope_basis(theta: FloatArray) -> FloatArray:
    """[3, N]: Ψ'(θ) = (c1, c2, c3) @ basis."""
    return np.stack([np.ones_like(theta), 2 * theta, 3 * theta * theta])


def _unit(name: str) -> FloatArray:
    """The change [6] by one step of the coefficient of that name."""
    if name not in COEFFICIENTS:
        raise InvalidInput(f"unknown coefficient '{name}'; expected one of {', '.join(COEFFICIENTS)}")
    unit = np.zeros(len(COEFFICIENTS))
    unit[COEFFICIENTS.index(name)] = 1.0
    return unit


class EnergyShape(Metric):
    """How convex the energy is about a fit of cubics."""

    name, topic = "energy", "Energy"
    columns = (
        Column.share(
            "energy_convex_share",
            "energy convex",
            None,
            "Share of the energy's slices where the rows keep their order, out to ±50 % of the slope, on "
            "which L is convex.",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """NaN for a rectification without cubics."""
        return {"energy_convex_share": energy_convex_share(case.rect)}
