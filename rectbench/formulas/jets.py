"""Derivatives of formulas: numbers that carry their partial derivatives along, as Ceres' jets do.

Forward mode: a formula that is given jets in the place of arrays gives jets back.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import repeat
from operator import mul, neg, truediv
from types import SimpleNamespace
from typing import Any, overload

from rectbench.formulas.protocol import Formulas


class Jet:
    """A value and its partial derivatives; arithmetic applies the chain rule.

    `value` and each entry of `partials` are arrays of one namespace; a constant has no partials.
    Comparisons look at the value alone, so that a formula's branches and domains work unchanged.
    """

    __slots__ = ("partials", "value")
    __array_ufunc__ = None  # an ndarray on the left must leave the operation to the jet

    def __init__(self, value: Any, partials: tuple[Any, ...] = ()) -> None:
        self.value = value
        self.partials = partials

    def chain(self, value: Any, slope: Any) -> Jet:
        """f(self), given f's value and its slope there."""
        return Jet(value, _scaled(self.partials, slope))

    def __add__(self, other: Any) -> Jet:
        b = constant(other)
        return Jet(self.value + b.value, _sum(self.partials, b.partials))

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, tuple(map(neg, self.partials)))

    def __sub__(self, other: Any) -> Jet:
        return self + (-constant(other))

    def __rsub__(self, other: Any) -> Jet:
        return constant(other) + (-self)

    def __mul__(self, other: Any) -> Jet:
        b = constant(other)
        partials = _sum(_scaled(self.partials, b.value), _scaled(b.partials, self.value))
        return Jet(self.value * b.value, partials)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        b = constant(other)
        quotient = self.value / b.value
        over = tuple(map(truediv, self.partials, repeat(b.value)))
        return Jet(quotient, _sum(over, _scaled(b.partials, -quotient / b.value)) if b.partials else over)

    def __rtruediv__(self, other: Any) -> Jet:
        return constant(other) / self

    def __pow__(self, exponent: int) -> Jet:
        slope = exponent * self.value ** (exponent - 1) if exponent else 0.0
        return self.chain(self.value**exponent, slope)

    def __eq__(self, other: object) -> Any:  # on values, as the others; so jets have no hash
        return self.value == constant(other).value

    def __ne__(self, other: object) -> Any:
        return self.value != constant(other).value

    def __lt__(self, other: Any) -> Any:
        return self.value < constant(other).value

    def __le__(self, other: Any) -> Any:
        return self.value <= constant(other).value

    def __gt__(self, other: Any) -> Any:
        return self.value > constant(other).value

    def __ge__(self, other: Any) -> Any:
        return self.value >= constant(other).value


def constant(x: Any) -> Jet:
    """`x` as a jet: itself if it is one, else a constant, without partials."""
    return x if isinstance(x, Jet) else Jet(x)


def _scaled(partials: tuple[Any, ...], slope: Any) -> tuple[Any, ...]:
    return tuple(map(mul, partials, repeat(slope)))  # by the thousand: three times as quick as a generator


def _sum(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[Any, ...]:
    if not a or not b:
        return a or b
    return tuple([p + q for p, q in zip(a, b, strict=True)])


def _function(name: str, slope: Callable[[Formulas, Any, Any], Any]) -> Callable[[JetNamespace, Any], Jet]:
    """A function of one number on jets; `slope` is its derivative, of the namespace, x and f(x)."""

    def function(self: JetNamespace, x: Any, /) -> Jet:
        a = constant(x)
        value = getattr(self.xp, name)(a.value)
        return a.chain(value, slope(self.xp, a.value, value))

    return function


class JetNamespace(Formulas):
    """The language of formulas on jets whose values live in the namespace `xp`."""

    def __init__(self, xp: Formulas) -> None:
        self.xp = xp

    sin = _function("sin", lambda xp, x, y: xp.cos(x))
    cos = _function("cos", lambda xp, x, y: -xp.sin(x))
    tan = _function("tan", lambda xp, x, y: 1.0 + y * y)
    asin = _function("asin", lambda xp, x, y: 1.0 / xp.sqrt(1.0 - x * x))
    acos = _function("acos", lambda xp, x, y: -1.0 / xp.sqrt(1.0 - x * x))
    atan = _function("atan", lambda xp, x, y: 1.0 / (1.0 + x * x))
    sqrt = _function("sqrt", lambda xp, x, y: 0.5 / y)
    square = _function("square", lambda xp, x, y: 2.0 * x)
    exp = _function("exp", lambda xp, x, y: y)
    expm1 = _function("expm1", lambda xp, x, y: y + 1.0)
    log = _function("log", lambda xp, x, y: 1.0 / x)
    log1p = _function("log1p", lambda xp, x, y: 1.0 / (1.0 + x))
    sinh = _function("sinh", lambda xp, x, y: xp.cosh(x))
    cosh = _function("cosh", lambda xp, x, y: xp.sinh(x))
    tanh = _function("tanh", lambda xp, x, y: 1.0 - y * y)
    asinh = _function("asinh", lambda xp, x, y: 1.0 / xp.hypot(x, 1.0))
    acosh = _function("acosh", lambda xp, x, y: 1.0 / xp.sqrt((x - 1.0) * (x + 1.0)))
    atanh = _function("atanh", lambda xp, x, y: 1.0 / ((1.0 - x) * (1.0 + x)))
    abs = _function("abs", lambda xp, x, y: xp.where(x < 0.0, -1.0, 1.0))
    sign = _function("sign", lambda xp, x, y: 0.0)
    floor = _function("floor", lambda xp, x, y: 0.0)

    def hypot(self, x: Any, y: Any, /) -> Jet:
        a, b = constant(x), constant(y)
        length = self.xp.hypot(a.value, b.value)
        across, along = a.chain(length, a.value / length), b.chain(length, b.value / length)
        return Jet(length, _sum(across.partials, along.partials))

    def atan2(self, y: Any, x: Any, /) -> Jet:
        a, b = constant(y), constant(x)
        square = a.value * a.value + b.value * b.value
        angle = self.xp.atan2(a.value, b.value)
        rise, run = a.chain(angle, b.value / square), b.chain(angle, -a.value / square)
        return Jet(angle, _sum(rise.partials, run.partials))

    def pow(self, x: Any, y: Any, /) -> Jet:
        a, b = constant(x), constant(y)
        power = self.xp.pow(a.value, b.value)
        base = a.chain(power, b.value * self.xp.pow(a.value, b.value - 1.0))
        if not b.partials:
            return base
        return Jet(power, _sum(base.partials, b.chain(power, power * self.xp.log(a.value)).partials))

    def isfinite(self, x: Any, /) -> Any:
        return self.xp.isfinite(constant(x).value)

    def interval(self, knots: Any, x: Any, /) -> Jet:
        return Jet(self.xp.interval(constant(knots).value, constant(x).value))

    def take(self, table: Any, number: Any, /) -> Jet:
        return Jet(self.xp.take(constant(table).value, constant(number).value))

    def where(self, condition: Any, x: Any, y: Any, /) -> Jet:
        a, b = constant(x), constant(y)
        zeros = tuple(0.0 for _ in a.partials or b.partials)
        pairs = zip(a.partials or zeros, b.partials or zeros, strict=True)
        partials = tuple(self.xp.where(condition, p, q) for p, q in pairs)
        return Jet(self.xp.where(condition, a.value, b.value), partials)

    def minimum(self, x: Any, y: Any, /) -> Jet:
        a, b = constant(x), constant(y)
        return self.where(b < a, b, self.where(a <= b, a, a + b))  # neither: one is NaN

    def maximum(self, x: Any, y: Any, /) -> Jet:
        a, b = constant(x), constant(y)
        return self.where(b > a, b, self.where(a >= b, a, a + b))


@overload
def variables(x: Any, /) -> tuple[Jet]: ...
@overload
def variables(x: Any, y: Any, /) -> tuple[Jet, Jet]: ...
@overload
def variables(x: Any, y: Any, z: Any, /) -> tuple[Jet, Jet, Jet]: ...
def variables(*values: Any) -> tuple[Jet, ...]:
    """Jets of the given arrays, each the independent variable of its own partial derivative."""
    places = range(len(values))
    return tuple(Jet(value, tuple(float(i == j) for j in places)) for i, value in enumerate(values))


def as_jets(tree: Any) -> Any:
    """Constants of a formula as jets: a Dr.Jit array refuses to add a jet that stands to its right."""
    if isinstance(tree, SimpleNamespace):
        return SimpleNamespace(**{name: as_jets(value) for name, value in vars(tree).items()})
    if isinstance(tree, tuple):
        return tuple(as_jets(value) for value in tree)
    return constant(tree)


def without_partials(tree: Any) -> Any:
    """The same constants as jets that depend on nothing."""
    if isinstance(tree, SimpleNamespace):
        return SimpleNamespace(**{name: without_partials(value) for name, value in vars(tree).items()})
    if isinstance(tree, tuple):
        return tuple(without_partials(value) for value in tree)
    return Jet(constant(tree).value)
