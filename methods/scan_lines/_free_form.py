"""û = h(β, γ) of either image and v̂ = g(β) as splines that rise whatever their coefficients are.

h = Σ_ij c_ij B_i(β) N_j(γ), see `rb.SplineSurface`, with the slope Σ_ij e^(α_ij) B_i(β) Q_j(γ) along γ: Q_j
are quadratic B-splines, and c_i,j+1 - c_ij = w_j e^(α_ij). What is free is α and, for each i, where the line
begins; of g, a `rb.MonotoneSpline`, the logarithms of its slopes. So nothing has to be constrained.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import cho_factor, cho_solve
from threadpoolctl import threadpool_limits

import rectbench as rb

from ._stretch_energies import StretchEnergy

DEGREE = 3
HOLD, BENT_COLUMNS, BENT_ROWS = 1e-7, 1e-6, 1e-5
"""Weights of squared distances from a fit's start and of squared second differences along what is free, of h
and of g: too small to matter but where no pixel is."""
SETTLED = 1e-6
"""A fit ends where a step takes less than this share of the energy away."""
MOST_STEPS = 200
DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-6, 1e9
"""Added to the Hessian's diagonal as a share of it: at first, the least once a step went wrong, the most."""


Columns = Literal["full", "separable"]
Rows = Literal["shared", "per-image"]


class Intervals(NamedTuple):
    """How many intervals the splines have."""

    columns: int
    """Of γ and β, in h."""
    rows: int
    """Of β, in g."""


@dataclass(frozen=True, eq=False)
class Fit:
    """z of least energy, and that."""

    z: np.ndarray
    energy: float


class FreeForm:
    """The energy as a function of what is free: z [M], of h left, h right and g in this order.

    Of the columns of an image z is [lines, places]: where a line begins, in focal lengths, and its α.
    Separable columns, h = h(γ), have one line; rows that are not shared have a g for each image, and are no
    rectification: they tell what sharing costs.
    """

    def __init__(
        self,
        energy: StretchEnergy,
        view: rb.ViewAngles,
        intervals: Intervals,
        focal_px: float,
        columns: Columns = "full",
        rows: Rows = "shared",
    ) -> None:
        self.energy, self.view, self.intervals, self.focal_px = energy, view, intervals, focal_px
        self.columns, self.rows = columns, rows
        self.places = intervals.columns + DEGREE
        self.lines = self.places if columns == "full" else 1
        self.curves = 1 if rows == "shared" else 2
        self.split = 2 * self.lines * self.places
        self.count = self.split + self.curves * (intervals.rows + DEGREE - 1)
        self.begins = np.zeros(self.count, dtype=bool)
        self.begins[: self.split : self.places] = True
        gamma_left, gamma_right, beta = view
        self.along = [clamped(span, intervals.columns) for span in (gamma_left, gamma_right)]
        self.across = clamped(beta, intervals.columns)
        self.down = clamped(beta, intervals.rows)
        self.sums = [running_sums(knots) for knots in self.along]
        index, basis = zip(*(self.local(side) for side in range(2)), strict=True)
        self.index, self.basis = np.concatenate(index), np.concatenate(basis)
        """[N, k], the coefficients that a pixel depends on, and [N, 3, k], how its x does."""
        self.bending = self.second_differences()
        self.pairs = (self.index[:, :, None] * self.count + self.index[:, None]).ravel()

    def local(self, side: int) -> tuple[np.ndarray, np.ndarray]:
        """The part of `index` and `basis` of one image."""
        gamma, beta = self.energy.angles[side].T
        count = len(gamma)
        line, B, bend = (np.full((count, 1), value) for value in (0, 1.0, 0.0))
        if self.columns == "full":
            line, B, bend = splines_at(self.across, beta, DEGREE)
        place, N, slope = splines_at(self.along[side], gamma, DEGREE)
        row, Q, _ = splines_at(self.down[1:-1], beta, DEGREE - 1)
        row = row + self.split + side * (self.curves - 1) * (self.intervals.rows + DEGREE - 1)
        column = (side * self.lines + line[:, :, None]) * self.places + place[:, None]
        basis = np.zeros((count, 3, B.shape[1] * N.shape[1] + Q.shape[1]))
        of_columns, of_rows = slice(-Q.shape[1]), slice(-Q.shape[1], None)
        basis[:, 0, of_columns] = (B[:, :, None] * slope[:, None]).reshape(count, -1)
        basis[:, 1, of_columns] = (bend[:, :, None] * N[:, None]).reshape(count, -1)
        basis[:, 2, of_rows] = Q
        return np.concatenate([column.reshape(count, -1), row], axis=1), basis

    def second_differences(self) -> np.ndarray:
        """[M, M], half of what its quadratic form adds to the energy."""
        form = np.zeros((self.count, self.count))
        columns = np.arange(self.split).reshape(2, self.lines, self.places)
        rows = np.arange(self.split, self.count).reshape(self.curves, -1)
        curves = [(BENT_COLUMNS, curve) for side in columns for curve in (*side[:, 1:], *side.T)]
        for weight, curve in (*curves, *((BENT_ROWS, row) for row in rows)):
            bends = np.diff(np.eye(len(curve)), n=2, axis=0)
            form[np.ix_(curve, curve)] += weight * bends.T @ bends
        return form

    def even(self) -> np.ndarray:
        """z of û = f γ, v̂ = f β."""
        return np.where(self.begins, 0.0, np.log(self.focal_px))

    def least(self, start: np.ndarray) -> Fit:
        """Newton's method from z [M] on, its steps damped as Levenberg's and Marquardt's are."""
        with threadpool_limits(
            limits=1, user_api="blas"
        ):  # on matrices this small threads wait for each other
            return self.descended(start)

    def descended(self, start: np.ndarray) -> Fit:
        """The same, on as many threads as there are."""
        z, damping = start, DAMPING
        value, gradient, hessian = self.derivatives(z, start)
        for _ in range(MOST_STEPS):
            scale = np.diag(np.abs(np.diag(hessian)) + HOLD)
            while True:
                step = descent(hessian + damping * scale, gradient)
                below = self.value(z + step, start) if step is not None else np.inf
                if below < value:
                    break
                damping = max(5 * damping, LEAST_DAMPING)
                if damping > MOST_DAMPING:
                    return Fit(z, value)
            z, gain, damping = z + step, value - below, damping / 8
            value, gradient, hessian = self.derivatives(z, start)
            if gain < SETTLED * value:
                break
        return Fit(z, value)

    def value(self, z: np.ndarray, held: np.ndarray) -> float:
        """The energy of z [M] and its restraint, held to a place."""
        with np.errstate(all="ignore"):
            energies, _, _ = self.energy(self.x(z))
        return float(energies.sum()) + self.restraint(z, held)

    def derivatives(self, z: np.ndarray, held: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """The same with its gradient [M] and Hessian [M, M]."""
        energies, by_x, by_xx = self.energy(self.x(z))
        by_c = np.einsum("in,nik->nk", by_x, self.basis)
        by_cc = np.matmul(self.basis.transpose(0, 2, 1), np.matmul(np.moveaxis(by_xx, -1, 0), self.basis))
        first = np.bincount(self.index.ravel(), by_c.ravel(), self.count)
        second = np.bincount(self.pairs, by_cc.ravel(), self.count**2).reshape(self.count, -1)
        first, second = self.to_steps(first), self.to_steps(self.to_steps(second).T)
        steps = self.steps(z)
        rate = np.where(self.begins, self.focal_px, steps)
        curved = np.diag(np.where(self.begins, 0.0, steps * first) + HOLD) + self.bending
        return (
            float(energies.sum()) + self.restraint(z, held),
            rate * first + HOLD * (z - held) + self.bending @ z,
            rate[:, None] * second * rate + curved,
        )

    def restraint(self, z: np.ndarray, held: np.ndarray) -> float:
        """What keeps z [M] in its place, and from bending, where nothing else does."""
        return float(HOLD * (z - held) @ (z - held) + z @ self.bending @ z) / 2

    def x(self, z: np.ndarray) -> np.ndarray:
        """∂h/∂γ, ∂h/∂β and g' [N, 3] at the pixels."""
        x: np.ndarray = np.einsum("nik,nk->ni", self.basis, self.coefficients(z)[self.index])
        return x

    def steps(self, z: np.ndarray) -> np.ndarray:
        """Beginnings in pixels, and slopes in pixels a radian [M]."""
        steps: np.ndarray = np.where(self.begins, self.focal_px * z, np.exp(np.where(self.begins, 0.0, z)))
        return steps

    def coefficients(self, z: np.ndarray) -> np.ndarray:
        """c [M] of the columns, left and right, and slopes of the rows."""
        steps = self.steps(z)
        columns = steps[: self.split].reshape(2, self.lines, self.places)
        summed = [lines @ sums.T for lines, sums in zip(columns, self.sums, strict=True)]
        return np.concatenate([*(c.ravel() for c in summed), steps[self.split :]])

    def to_steps(self, by_c: np.ndarray) -> np.ndarray:
        """Derivatives [M, ...] by c as derivatives by beginnings and slopes."""
        found, each = by_c.copy(), self.lines * self.places
        for side, sums in enumerate(self.sums):
            part = slice(side * each, (side + 1) * each)
            lines = by_c[part].reshape(self.lines, self.places, -1)
            found[part] = np.matmul(sums.T, lines).reshape(found[part].shape)
        return found

    def of_coefficients(self, c: np.ndarray) -> np.ndarray:
        """z [M] of such coefficients, which have to rise."""
        columns = c[: self.split].reshape(2, self.lines, self.places)
        steps = [np.linalg.solve(sums, lines.T).T for lines, sums in zip(columns, self.sums, strict=True)]
        both = np.concatenate([*(s.ravel() for s in steps), c[self.split :]])
        return np.where(self.begins, both / self.focal_px, np.log(np.where(self.begins, 1.0, both)))

    def refined(self, z: np.ndarray, finer: "FreeForm") -> np.ndarray:
        """z of a form that has all that this one has: the same columns and rows."""
        c = self.coefficients(z)
        parts = []
        for side, lines in enumerate(c[: self.split].reshape(2, self.lines, self.places)):
            along = inserted(self.along[side], finer.along[side], DEGREE)
            across = inserted(self.across, finer.across, DEGREE)
            if self.columns == "separable":
                across = np.ones((finer.lines, 1))
            parts.append((across @ lines @ along.T).ravel())
        rows = c[self.split :].reshape(self.curves, -1)
        down = inserted(self.down[1:-1], finer.down[1:-1], DEGREE - 1)
        parts += [down @ row for row in np.resize(rows, (finer.curves, rows.shape[1]))]
        return finer.of_coefficients(np.concatenate(parts))

    def surfaces(self, z: np.ndarray) -> tuple[rb.SplineSurface, rb.SplineSurface]:
        """h left and h right."""
        columns = self.coefficients(z)[: self.split].reshape(2, self.lines, self.places)
        each = np.broadcast_to(columns, (2, self.places, self.places))
        spans = self.view.gamma_left, self.view.gamma_right
        left, right = (rb.SplineSurface.of(self.view.beta, s, c) for s, c in zip(spans, each, strict=True))
        return left, right

    def profiles(self, z: np.ndarray) -> tuple[rb.MonotoneSpline, rb.MonotoneSpline]:
        """g of either image, one and the same where they share it."""
        slopes = self.coefficients(z)[self.split :].reshape(self.curves, -1)
        knots = self.down[DEGREE:-DEGREE]
        return rb.MonotoneSpline.of(knots, slopes[0]), rb.MonotoneSpline.of(knots, slopes[-1])


def descent(hessian: np.ndarray, gradient: np.ndarray) -> np.ndarray | None:
    """The step to where a parabola has its minimum; None where it has none."""
    try:
        step: np.ndarray = -cho_solve(cho_factor(hessian, check_finite=False), gradient, check_finite=False)
    except np.linalg.LinAlgError:
        return None
    return step


def clamped(span: tuple[float, float], intervals: int) -> np.ndarray:
    """Even knots of cubic B-splines that end with the range."""
    return np.pad(np.linspace(*span, intervals + 1), DEGREE, mode="edge")


def widths(knots: np.ndarray) -> np.ndarray:
    """∫ Q_j over the quadratic B-splines that slopes of such cubic ones are made of."""
    return (knots[DEGREE + 1 : -1] - knots[1 : -DEGREE - 1]) / DEGREE


def averages(knots: np.ndarray, degree: int = DEGREE) -> np.ndarray:
    """Greville's abscissae: where a B-spline's coefficient is about the value."""
    return np.stack([knots[1 + k : len(knots) - degree + k] for k in range(degree)]).mean(axis=0)


def running_sums(knots: np.ndarray) -> np.ndarray:
    """[places, places], from a line's beginning, in its middle, and its slopes to its c."""
    weights = np.append(1.0, widths(knots))
    sums = np.tril(np.tile(weights, (len(weights), 1)))
    sums[:, 1:] -= sums[len(weights) // 2, 1:]
    return sums


def splines_at(knots: np.ndarray, places: np.ndarray, degree: int) -> tuple[np.ndarray, ...]:
    """The numbers of the B-splines that are not 0 at places [N], their values and slopes, [N, degree + 1]."""
    at = np.clip(places, knots[0], knots[-1])
    values, lower = (
        BSpline.design_matrix(at, k, d).data.reshape(len(at), d + 1)
        for k, d in ((knots, degree), (knots[1:-1], degree - 1))
    )
    last = len(knots) - degree - 2
    first = np.clip(np.searchsorted(knots, at, side="right") - 1, degree, last) - degree
    numbers = first[:, None] + np.arange(degree + 1)
    rates = degree / (knots[degree + 1 : -1] - knots[1 : -degree - 1])
    rising = lower * rates[numbers[:, :-1]]
    return numbers, values, np.pad(rising, ((0, 0), (1, 0))) - np.pad(rising, ((0, 0), (0, 1)))


def inserted(knots: np.ndarray, finer: np.ndarray, degree: int) -> np.ndarray:
    """From coefficients of B-splines to those over more knots, theirs among them: the same function."""
    places = np.clip(averages(finer, degree), finer[0], finer[-1])
    coarse, fine = (BSpline.design_matrix(places, k, degree).toarray() for k in (knots, finer))
    found: np.ndarray = np.linalg.solve(fine, coarse)
    return found
