"""The language of formulas: every function that one may call on its namespace `xp`.

A formula is written once, for arrays of any kind, from the four operations, `**` with a whole number,
comparisons, `&` and `|` of masks, and the functions below. NumPy evaluates it, Dr.Jit compiles it, and jets
carry derivatives through it. A choice between two values is `xp.where`, never `if`.

| | functions |
|---|---|
| angles in radians | `sin cos tan`, `asin acos atan atan2` |
| roots and powers | `sqrt square hypot pow` |
| exponentials | `exp log expm1 log1p`, `sinh cosh tanh`, `asinh acosh atanh` |
| order | `abs sign floor minimum maximum`, `where isfinite` |
| continuous at 0 | `sinc cosc tanc atanc sinhc`: a quotient that has a limit there, with its derivative |
| curves | `polynomial piecewise spline` |
| tables | `interval take`, of constants that are arrays |

Values and partial derivatives agree on all namespaces to some 1e-13, at the limits too, and NaN stays NaN.
Where a function has no slope (the root at 0, asin at ±1), its partials are infinite or NaN. Dr.Jit, which
serves where points are many, differs in this:

- `tan` below 1e-4 is right to 4e-13, which is up to 4e-9 of the value; `tanc` has all digits there.
- `sin cos tan` have no right digit beyond 2e9 radians.
- `hypot` is infinite from 1e154 on and may be 0 below 1e-153: what is below 2e-308 may count as 0.
- `atan2` is ±0 where both are 0, whatever their signs, and NaN where both are infinite.
- `0.0 * x` is 0 and `x != x` is False even where x is NaN.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol


class ArrayFunctions(Protocol):
    """What each namespace brings itself: functions of arrays, entry by entry, under the array-API's names."""

    def sin(self, x: Any, /) -> Any:
        """The sine of x radians."""

    def cos(self, x: Any, /) -> Any:
        """The cosine of x radians."""

    def tan(self, x: Any, /) -> Any:
        """The tangent of x radians."""

    def asin(self, x: Any, /) -> Any:
        """The angle in [-π/2, π/2] whose sine is x; NaN beyond ±1."""

    def acos(self, x: Any, /) -> Any:
        """The angle in [0, π] whose cosine is x; NaN beyond ±1."""

    def atan(self, x: Any, /) -> Any:
        """The angle in (-π/2, π/2) whose tangent is x."""

    def atan2(self, y: Any, x: Any, /) -> Any:
        """The angle in [-π, π] from the x axis to the point (x, y); a y of -0 is below the axis."""

    def sqrt(self, x: Any, /) -> Any:
        """The square root; NaN below 0."""

    def square(self, x: Any, /) -> Any:
        """x x."""

    def hypot(self, x: Any, y: Any, /) -> Any:
        """√(x² + y²)."""

    def pow(self, x: Any, y: Any, /) -> Any:
        """x to the power y, for x above 0; `x**3` serves any x."""

    def exp(self, x: Any, /) -> Any:
        """e to the power x."""

    def expm1(self, x: Any, /) -> Any:
        """exp x - 1, without cancellation near 0."""

    def log(self, x: Any, /) -> Any:
        """The natural logarithm; -inf at 0, NaN below."""

    def log1p(self, x: Any, /) -> Any:
        """log(1 + x), without cancellation near 0."""

    def sinh(self, x: Any, /) -> Any:
        """The hyperbolic sine."""

    def cosh(self, x: Any, /) -> Any:
        """The hyperbolic cosine."""

    def tanh(self, x: Any, /) -> Any:
        """The hyperbolic tangent."""

    def asinh(self, x: Any, /) -> Any:
        """The inverse of sinh."""

    def acosh(self, x: Any, /) -> Any:
        """The inverse of cosh, at least 0; NaN below 1."""

    def atanh(self, x: Any, /) -> Any:
        """The inverse of tanh; ±inf at ±1, NaN beyond."""

    def abs(self, x: Any, /) -> Any:
        """The absolute value; its slope at 0 counts as 1."""

    def sign(self, x: Any, /) -> Any:
        """-1, 0 or 1."""

    def floor(self, x: Any, /) -> Any:
        """The greatest whole number that is at most x."""

    def minimum(self, x: Any, y: Any, /) -> Any:
        """The lesser of both."""

    def maximum(self, x: Any, y: Any, /) -> Any:
        """The greater of both."""

    def where(self, condition: Any, x: Any, y: Any, /) -> Any:
        """x where the condition holds, else y. What is not chosen may be NaN."""

    def isfinite(self, x: Any, /) -> Any:
        """The mask of what is neither NaN nor infinite."""

    def interval(self, knots: Any, x: Any, /) -> Any:
        """The number i of the interval that x lies in, knots[i] ≤ x < knots[i + 1]; of the outer ones beyond.

        `knots` is a constant that is an array of two or more rising numbers. Found by halving, so that
        thousands of knots cost little more than ten. Of NaN any interval.
        """

    def take(self, table: Any, number: Any, /) -> Any:
        """table[number], entry by entry: of a constant that is an array, at numbers of an `interval`, or
        at whole ones from other formulas. Of NaN any entry."""


class Formulas(ArrayFunctions, Protocol):
    """All functions of the language: those of the arrays, and what follows from them on every namespace.

    >>> from rectbench.formulas.namespaces import NUMPY
    >>> def mercator(angle, xp: Formulas):
    ...     return xp.asinh(xp.tan(angle))
    >>> print(round(mercator(0.5, NUMPY), 6))
    0.522238
    """

    def sinc(self, x: Any, /) -> Any:
        """sin x / x, 1 at 0. (NumPy's function of this name has π x in the place of x.)"""
        return _quotient(self, self.sin, x, _SINC)

    def cosc(self, x: Any, /) -> Any:
        """(1 - cos x) / x², ½ at 0, without cancellation."""
        half = self.sinc(0.5 * x)
        return 0.5 * half * half

    def tanc(self, x: Any, /) -> Any:
        """tan x / x, 1 at 0."""
        return self.sinc(x) / self.cos(x)

    def atanc(self, x: Any, /) -> Any:
        """atan x / x, 1 at 0."""
        return _quotient(self, self.atan, x, _ATANC)

    def sinhc(self, x: Any, /) -> Any:
        """sinh x / x, 1 at 0."""
        return _quotient(self, self.sinh, x, _SINHC)

    def polynomial(self, coefficients: Sequence[Any], x: Any, /) -> Any:
        """c[0] + c[1] x + c[2] x² + ..., by Horner's rule."""
        *lower, value = coefficients
        for coefficient in reversed(lower):
            value = coefficient + x * value
        return value

    def piecewise(self, knots: Sequence[Any], pieces: Sequence[Any], x: Any, /) -> Any:
        """pieces[0] below knots[0], pieces[i] from knots[i - 1] on; one piece more than knots, which rise."""
        value = pieces[0]
        for knot, piece in zip(knots, pieces[1:], strict=True):
            value = self.where(x < knot, value, piece)
        return value

    def spline(self, knots: Sequence[Any], coefficients: Sequence[Sequence[Any]], x: Any, /) -> Any:
        """Σ_k c[i][k] (x - knots[i])^k between knots[i] and knots[i + 1]: a polynomial in each interval.

        One tuple of coefficients an interval, all of one length; knots rise. Beyond the outer knots the
        outer polynomials go on. SciPy's piecewise polynomials hold the same: `p.x` and `p.c[::-1].T`. Each
        knot costs every element a choice, so that some tens of them are a good number; `interval` and `take`
        serve more.
        """
        inner = knots[1:-1]
        start = self.piecewise(inner, knots[:-1], x)
        columns = zip(*coefficients, strict=True)
        return self.polynomial([self.piecewise(inner, column, x) for column in columns], x - start)


def _quotient(xp: Formulas, function: Any, x: Any, series: tuple[float, Sequence[float]]) -> Any:
    """function(x) / x, by its series in x² near 0, where the quotient's derivative would lose its digits."""
    reach, coefficients = series
    near = xp.abs(x) < reach
    away = xp.where(near, 1.0, x)
    return xp.where(near, xp.polynomial(coefficients, x * x), function(away) / away)


def _factorials(sign: float) -> tuple[float, ...]:
    """sign^k / (2k + 1)!, as many as reach the last digit at x² = ¼."""
    terms = [1.0]
    for k in range(1, 9):
        terms.append(sign * terms[-1] / (2 * k * (2 * k + 1)))
    return tuple(terms)


_SINC, _SINHC = (0.5, _factorials(-1.0)), (0.5, _factorials(1.0))
_ATANC = (0.1, tuple((-1.0) ** k / (2 * k + 1) for k in range(9)))
