"""Inverts the maps of the projection models, to machine precision, in any namespace."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from rectbench.formulas.domain import PIXEL_SLACK
from rectbench.formulas.jets import Jet, JetNamespace, as_jets, constant, variables, without_partials
from rectbench.formulas.namespaces import NUMPY
from rectbench.formulas.protocol import Formulas

MOST_STEPS = 80
"""Bisection alone takes 53 steps; Newton's rarely more than six."""
ROUNDING = 2e-16
"""A target missed by this little, relative to its size, cannot be told from one that is hit."""
SETTLED = 4e-16
"""A step this small, relative to where it stands, is rounding."""


def repeat_until_settled(
    step: Callable[..., tuple[Any, ...]],
    unsettled: Callable[..., Any],
    state: tuple[Any, ...],
    given: tuple[Any, ...],
    xp: Formulas,
) -> tuple[Any, ...]:
    """Repeat ``state = step(*state, *given)`` on each element while ``unsettled(*state)`` holds there.

    An element stops by itself, so its digits do not depend on its neighbours. In a kernel this is a
    real loop, which compiles faster and ends sooner than unrolled steps.
    """
    if xp is not NUMPY:
        import drjit as dr

        return dr.while_loop(state, unsettled, lambda *state: step(*state, *given))
    arrays = np.broadcast_arrays(*state, *given)
    shape, flat = arrays[0].shape, [np.array(values, dtype=float).ravel() for values in arrays]
    found, moving, given = flat[: len(state)], tuple(flat[: len(state)]), tuple(flat[len(state) :])
    place = np.arange(found[0].size)
    while place.size:
        active = unsettled(*moving)
        if not active.all():  # a few elements take ten times the steps of the others, which go on alone
            for values, ended in zip(found, moving, strict=True):
                values[place] = ended
            still = np.flatnonzero(active)
            place, moving, given = (
                place[still],
                tuple(values[still] for values in moving),
                tuple(values[still] for values in given),
            )
        moving = step(*moving, *given)
    return tuple(values.reshape(shape) for values in found)


def invert_monotone(
    function: Callable[..., tuple[Any, Any]],
    target: Any,
    low: Any,
    high: Any,
    start: Any,
    xp: Formulas,
    given: tuple[Any, ...] = (),
) -> Any:
    """x in [low, high] with function(x, *given) = target, by Newton steps held inside a shrinking bracket.

    `function` returns value and slope and rises over the bracket; what it is `given` are numbers that differ
    from element to element. A step that would leave the
    bracket, or turn back by more than half of the last one (two points can call each other for
    ever), becomes a bisection: a flat stretch slows it down and never throws it out. A target beyond
    the ends gives the nearer end.
    """

    def step(x: Any, low: Any, high: Any, last: Any, count: Any, target: Any, *given: Any) -> tuple[Any, ...]:
        value, slope = function(x, *given)
        miss = target - value
        high = xp.where(miss < 0.0, x, high)
        low = xp.where(miss < 0.0, low, x)
        move = xp.where(xp.abs(miss) <= ROUNDING * xp.abs(target), 0.0, miss / slope)
        newton = x + move
        onward = (move * last >= 0.0) | (xp.abs(move) <= 0.5 * xp.abs(last))
        trusted = (newton >= low) & (newton <= high) & onward
        following = xp.where(trusted, newton, 0.5 * (low + high))
        return following, low, high, following - x, count + 1.0

    def unsettled(x: Any, low: Any, high: Any, move: Any, count: Any) -> Any:
        return (xp.abs(move) > SETTLED * xp.abs(x)) & (count < MOST_STEPS)

    zero = 0.0 * target
    low, high = low + zero, high + zero
    state = (start + zero, low, high, 4.0 * (high - low), zero)
    return repeat_until_settled(step, unsettled, state, (target, *given), xp)[0]


def inverse(
    formula: Callable[[Any, Any, Any], Any],
    c: Any,
    target: Any,
    high: Any,
    most: Any,
    start: Any,
    xp: Formulas,
) -> Any:
    """x in [0, high] with formula(c, x, xp) = target; the formula rises from 0 there, up to `most`.

    See `invert_monotone`; the slope is a jet's. A target beyond `most` gives `high`. Where the target
    or the constants are jets, the answer carries their derivatives: those of the inverse, not of the
    steps to it. From f(c, x) = target, dx = (d target - ∂f/∂c dc) / (∂f/∂x).
    """
    if isinstance(target, Jet) and isinstance(xp, JetNamespace):
        high, most, start = (constant(number).value for number in (high, most, start))
        plain = without_partials(c)
        x = inverse(formula, plain, target.value, high, most, start, xp.xp)
        slope = formula(plain, *variables(x), xp).partials[0]
        return (target - formula(c, constant(x), xp)).chain(x, 1.0 / slope)

    jets, constants = JetNamespace(xp), as_jets(c)

    def value_and_slope(x: Any) -> tuple[Any, Any]:
        jet = formula(constants, *variables(x), jets)
        return jet.value, jet.partials[0]

    reached, start = xp.minimum(target, most), xp.minimum(start, high)
    return invert_monotone(value_and_slope, reached, 0.0, high, start, xp)


def invert_in_disk(
    formula: Callable[[Any, Any, Any, Any], tuple[Any, Any]],
    c: Any,
    u: Any,
    v: Any,
    radius: Any,
    reach: Any,
    xp: Formulas,
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

    def step(a: Any, b: Any, da: Any, db: Any, miss: Any, count: Any, u: Any, v: Any) -> tuple[Any, ...]:
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
    zero = 0.0 * size
    steps_taken = xp.where(size <= reach * reach, zero, zero + MOST_STEPS)
    state = (*within(u, v), zero, zero, zero + math.inf, steps_taken)
    a, b, _, _, miss, _ = repeat_until_settled(step, unsettled, state, (u, v), xp)
    return a, b, miss <= PIXEL_SLACK * PIXEL_SLACK * xp.maximum(1.0, size)
