"""Inverts the maps of the projection models, to machine precision, in any namespace."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from rectbench.cameras.arrays import (
    Jet,
    JetNamespace,
    as_jets,
    constant,
    repeat_until_settled,
    variables,
)
from rectbench.cameras.domain import PIXEL_SLACK

MOST_STEPS = 80
"""Bisection alone takes 53 steps; Newton's rarely more than six."""
LONGEST = 0.75
"""Share of the bracket that one Newton step may cross; else two points can call each other for ever."""
SETTLED = 4e-16
"""A step this small, relative to where it stands, is rounding."""


def invert_monotone(
    function: Callable[[Any], tuple[Any, Any]], target: Any, low: Any, high: Any, start: Any, xp: Any
) -> Any:
    """x in [low, high] with function(x) = target, by Newton steps held inside a shrinking bracket.

    `function` returns value and slope and rises over the bracket. A step that would leave the
    bracket, or cross most of it, becomes a bisection, so a flat stretch slows it down and never
    throws it out. A target beyond the ends gives the nearer end.
    """

    def step(x: Any, low: Any, high: Any, _: Any, count: Any) -> tuple[Any, ...]:
        value, slope = function(x)
        above = value > target
        high = xp.where(above, x, high)
        low = xp.where(above, low, x)
        move = (target - value) / slope
        newton = x + move
        trusted = (newton >= low) & (newton <= high) & (xp.abs(move) <= LONGEST * (high - low))
        following = xp.where(trusted, newton, 0.5 * (low + high))
        return following, low, high, following - x, count + 1.0

    def unsettled(x: Any, low: Any, high: Any, move: Any, count: Any) -> Any:
        return (xp.abs(move) > SETTLED * xp.abs(x)) & (count < MOST_STEPS)

    nought = 0.0 * target
    state = (start + nought, low + nought, high + nought, nought + math.inf, nought)
    return repeat_until_settled(step, unsettled, state, xp)[0]


def inverse(
    formula: Callable[[Any, Any, Any], Any],
    c: Any,
    target: Any,
    low: Any,
    high: Any,
    start: Any,
    xp: Any,
) -> Any:
    """x in [low, high] with formula(c, x, xp) = target; see `invert_monotone`, the slope being a jet's.

    Where the target is a jet itself, the answer carries its derivatives: those of the formula's
    inverse, not of the steps that led there.
    """
    if isinstance(target, Jet):
        low, high, start = (constant(bound).value for bound in (low, high, start))
        x = inverse(formula, c, target.value, low, high, start, xp.xp)
        return target.chain(x, 1.0 / formula(c, *variables(x), xp).partials[0])

    def value_and_slope(x: Any) -> tuple[Any, Any]:
        jet = formula(as_jets(c), *variables(x), JetNamespace(xp))
        return jet.value, jet.partials[0]

    return invert_monotone(value_and_slope, target, low, high, start, xp)


def invert_in_disk(
    formula: Callable[[Any, Any, Any, Any], tuple[Any, Any]],
    c: Any,
    u: Any,
    v: Any,
    radius: Any,
    reach: Any,
    xp: Any,
) -> tuple[Any, Any, Any]:
    """The point (a, b) of the disk with formula(c, a, b, xp) = (u, v), and whether there is one.

    Newton's method from (u, v), each step shortened until it lessens the distance to the target.
    The formula must be monotone on the disk of that radius (the symmetric part of its Jacobian
    positive definite): then there is at most one such point. `reach` bounds the disk's image.
    """
    jets, constants = JetNamespace(xp), as_jets(c)

    def within(a: Any, b: Any) -> tuple[Any, Any]:
        square = a * a + b * b
        inside = square <= radius * radius
        shrink = radius / xp.sqrt(square)
        return xp.where(inside, a, shrink * a), xp.where(inside, b, shrink * b)

    def step(a: Any, b: Any, da: Any, db: Any, miss: Any, count: Any) -> tuple[Any, ...]:
        a_new, b_new = within(a + da, b + db)
        p, q = formula(constants, *variables(a_new, b_new), jets)
        (pa, pb), (qa, qb) = p.partials, q.partials
        e, f = u - p.value, v - q.value
        per_determinant = 1.0 / (pa * qb - pb * qa)
        miss_new = e * e + f * f
        nearer = miss_new < miss
        return (
            xp.where(nearer, a_new, a),
            xp.where(nearer, b_new, b),
            xp.where(nearer, (qb * e - pb * f) * per_determinant, 0.25 * da),
            xp.where(nearer, (pa * f - qa * e) * per_determinant, 0.25 * db),
            xp.where(nearer, miss_new, miss),
            count + 1.0,
        )

    def unsettled(a: Any, b: Any, da: Any, db: Any, miss: Any, count: Any) -> Any:
        moving = xp.abs(da) + xp.abs(db) > SETTLED * (xp.abs(a) + xp.abs(b))
        return (moving | (count < 1.0)) & (count < MOST_STEPS)

    size = u * u + v * v
    nought = 0.0 * size
    steps_taken = xp.where(size <= reach * reach, nought, nought + MOST_STEPS)
    state = (*within(u, v), nought, nought, nought + math.inf, steps_taken)
    a, b, _, _, miss, _ = repeat_until_settled(step, unsettled, state, xp)
    return a, b, miss <= PIXEL_SLACK * PIXEL_SLACK * xp.maximum(1.0, size)
