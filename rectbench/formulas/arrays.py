"""One formula for NumPy arrays, Dr.Jit arrays and derivatives.

A projection formula is written once against a namespace ``xp`` with the array-API names (``sin``,
``atan2``, ``where`` ...). `NUMPY` evaluates it on float64 arrays, `drjit_namespace()` compiles it
to one parallel kernel, and `JetNamespace` carries first derivatives along (forward mode, as
Ceres' jets do).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from rectbench import llvm
from rectbench.types import BoolArray, Constants, FloatArray

KERNEL_THRESHOLD = 20_000
"""Points from which a compiled kernel beats NumPy, its launch included."""

NUMPY: Any = np


@cache
def drjit_namespace() -> Any:
    """Dr.Jit under the array-API names the formulas use."""
    llvm.require()
    import drjit as dr

    def hypot(a: Any, b: Any) -> Any:
        return dr.sqrt(a * a + b * b)  # dr.hypot guards against overflow, which no ray comes near

    names = ("sin", "cos", "tan", "asin", "acos", "atan2", "sqrt", "minimum", "maximum", "abs", "isfinite")
    same = {name: getattr(dr, name) for name in names}
    return SimpleNamespace(where=dr.select, hypot=hypot, **same)


def repeat_until_settled(
    step: Callable[..., tuple[Any, ...]],
    unsettled: Callable[..., Any],
    state: tuple[Any, ...],
    xp: Any,
) -> tuple[Any, ...]:
    """Repeat ``state = step(*state)`` on each element for as long as ``unsettled(*state)`` holds there.

    An element stops by itself, so its digits do not hang on its neighbours. In a kernel this is a
    real loop, which compiles faster and ends sooner than unrolled steps.
    """
    if xp is not NUMPY:
        import drjit as dr

        looped: tuple[Any, ...] = dr.while_loop(state, unsettled, step)
        return looped
    while np.any(active := unsettled(*state)):
        following = step(*state)
        state = tuple(np.where(active, new, old) for new, old in zip(following, state, strict=True))
    return state


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
        return Jet(value, tuple(slope * d for d in self.partials))

    def __add__(self, other: Any) -> Jet:
        b = constant(other)
        return Jet(self.value + b.value, _sum(self.partials, b.partials))

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.value, tuple(-d for d in self.partials))

    def __sub__(self, other: Any) -> Jet:
        return self + (-constant(other))

    def __rsub__(self, other: Any) -> Jet:
        return constant(other) + (-self)

    def __mul__(self, other: Any) -> Jet:
        b = constant(other)
        return Jet(
            self.value * b.value,
            _sum(tuple(d * b.value for d in self.partials), tuple(self.value * d for d in b.partials)),
        )

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Jet:
        b = constant(other)
        quotient = self.value / b.value
        return Jet(
            quotient,
            _sum(
                tuple(d / b.value for d in self.partials),
                tuple(-quotient / b.value * d for d in b.partials),
            ),
        )

    def __rtruediv__(self, other: Any) -> Jet:
        return constant(other) / self

    def __lt__(self, other: Any) -> Any:
        return self.value < constant(other).value

    def __le__(self, other: Any) -> Any:
        return self.value <= constant(other).value

    def __gt__(self, other: Any) -> Any:
        return self.value > constant(other).value

    def __ge__(self, other: Any) -> Any:
        return self.value >= constant(other).value


def constant(x: Any) -> Jet:
    """`x` as a jet: itself if it is one, else a constant, whose derivatives are nought."""
    return x if isinstance(x, Jet) else Jet(x)


def _sum(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[Any, ...]:
    if not a or not b:
        return a or b
    return tuple(p + q for p, q in zip(a, b, strict=True))


class JetNamespace:
    """The array-API names on jets whose values live in the namespace `xp`."""

    def __init__(self, xp: Any) -> None:
        self.xp = xp

    def sin(self, x: Any) -> Jet:
        a = constant(x)
        return a.chain(self.xp.sin(a.value), self.xp.cos(a.value))

    def cos(self, x: Any) -> Jet:
        a = constant(x)
        return a.chain(self.xp.cos(a.value), -self.xp.sin(a.value))

    def tan(self, x: Any) -> Jet:
        a = constant(x)
        tangent = self.xp.tan(a.value)
        return a.chain(tangent, 1.0 + tangent * tangent)

    def asin(self, x: Any) -> Jet:
        a = constant(x)
        return a.chain(self.xp.asin(a.value), 1.0 / self.xp.sqrt(1.0 - a.value * a.value))

    def acos(self, x: Any) -> Jet:
        a = constant(x)
        return a.chain(self.xp.acos(a.value), -1.0 / self.xp.sqrt(1.0 - a.value * a.value))

    def sqrt(self, x: Any) -> Jet:
        a = constant(x)
        root = self.xp.sqrt(a.value)
        return a.chain(root, 0.5 / root)

    def hypot(self, x: Any, y: Any) -> Jet:
        a, b = constant(x), constant(y)
        length = self.xp.hypot(a.value, b.value)
        across, along = a.chain(length, a.value / length), b.chain(length, b.value / length)
        return Jet(length, _sum(across.partials, along.partials))

    def atan2(self, y: Any, x: Any) -> Jet:
        a, b = constant(y), constant(x)
        square = a.value * a.value + b.value * b.value
        angle = self.xp.atan2(a.value, b.value)
        rise, run = a.chain(angle, b.value / square), b.chain(angle, -a.value / square)
        return Jet(angle, _sum(rise.partials, run.partials))

    def abs(self, x: Any) -> Jet:
        a = constant(x)
        return a.chain(self.xp.abs(a.value), self.xp.where(a.value < 0.0, -1.0, 1.0))

    def where(self, condition: Any, x: Any, y: Any) -> Jet:
        a, b = constant(x), constant(y)
        zeros = tuple(0.0 for _ in a.partials or b.partials)
        pairs = zip(a.partials or zeros, b.partials or zeros, strict=True)
        return Jet(
            self.xp.where(condition, a.value, b.value),
            tuple(self.xp.where(condition, p, q) for p, q in pairs),
        )

    def minimum(self, x: Any, y: Any) -> Jet:
        a, b = constant(x), constant(y)
        return self.where(a.value <= b.value, a, b)

    def maximum(self, x: Any, y: Any) -> Jet:
        a, b = constant(x), constant(y)
        return self.where(a.value >= b.value, a, b)


@overload
def variables(x: Any, /) -> tuple[Jet]: ...
@overload
def variables(x: Any, y: Any, /) -> tuple[Jet, Jet]: ...
@overload
def variables(x: Any, y: Any, z: Any, /) -> tuple[Jet, Jet, Jet]: ...
def variables(*values: Any) -> tuple[Jet, ...]:
    """Jets of the given arrays, each the independent variable of its own partial derivative."""
    return tuple(
        Jet(value, tuple(1.0 if i == j else 0.0 for j in range(len(values))))
        for i, value in enumerate(values)
    )


def as_jets(tree: Any) -> Any:
    """Constants of a formula as jets: a Dr.Jit array refuses to add a jet that stands to its right."""
    if isinstance(tree, SimpleNamespace):
        return SimpleNamespace(**{name: as_jets(value) for name, value in vars(tree).items()})
    if isinstance(tree, tuple):
        return tuple(as_jets(value) for value in tree)
    return constant(tree)


def without_partials(tree: Any) -> Any:
    """The same constants as jets that hang on nothing."""
    if isinstance(tree, SimpleNamespace):
        return SimpleNamespace(**{name: without_partials(value) for name, value in vars(tree).items()})
    if isinstance(tree, tuple):
        return tuple(without_partials(value) for value in tree)
    return Jet(constant(tree).value)


def opaque(tree: Any) -> Any:
    """Constants as Dr.Jit variables: as literals, each new camera would be a new kernel to compile."""
    import drjit as dr
    from drjit.llvm import Float64

    if isinstance(tree, Mapping):
        return SimpleNamespace(**{name: opaque(value) for name, value in tree.items()})
    if isinstance(tree, tuple):
        return tuple(opaque(value) for value in tree)
    variable = Float64(float(tree))
    dr.make_opaque(variable)
    return variable


def namespaced(tree: Any) -> Any:
    """Constants with attribute access, as the formulas read them."""
    if isinstance(tree, Mapping):
        return SimpleNamespace(**{name: namespaced(value) for name, value in tree.items()})
    if isinstance(tree, tuple):
        return tuple(namespaced(value) for value in tree)
    return tree


def evaluate(
    formula: Callable[..., tuple[Any, ...]], constants: Constants, *columns: FloatArray
) -> tuple[NDArray[Any], ...]:
    """`formula(c, *columns, xp)` on flat float64 columns, compiled where there are many.

    The choice between NumPy and a kernel hangs on the number of points alone, so the same call
    gives the same digits again. Returns one flat array (float64, or bool for masks) an output.
    """
    if not _compiled(columns[0].size):
        with np.errstate(all="ignore"):
            outputs = formula(namespaced(constants), *columns, NUMPY)
            return tuple(np.broadcast_to(np.asarray(out), columns[0].shape) for out in outputs)
    xp = drjit_namespace()
    import drjit as dr
    from drjit.llvm import Float64

    outputs = formula(opaque(constants), *(Float64(column) for column in columns), xp)
    outputs = tuple(Float64(out) if isinstance(out, float) else out for out in outputs)
    dr.eval(*outputs)
    return tuple(np.broadcast_to(out.numpy(), columns[0].shape) for out in outputs)


def evaluate_points(
    formula: Callable[..., tuple[Any, ...]], constants: Constants, points: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """`formula(c, *coordinates, xp)` at points [..., k]; its last output is the mask of valid ones.

    Returns the other outputs [..., m] and the mask [...]. A point with a coordinate or an output
    that is not finite is invalid too; the outputs of an invalid point are NaN.
    """
    flat = np.ascontiguousarray(points).reshape(-1, points.shape[-1])
    outputs, ok = (_by_kernel if _compiled(len(flat)) else _by_numpy)(formula, constants, flat)
    shape = points.shape[:-1]
    return outputs.reshape(*shape, outputs.shape[-1]), ok.reshape(shape)


def _compiled(count: int) -> bool:
    return count >= KERNEL_THRESHOLD and llvm.available()


def _by_numpy(
    formula: Callable[..., tuple[Any, ...]], constants: Constants, points: FloatArray
) -> tuple[FloatArray, BoolArray]:
    columns = [np.ascontiguousarray(column) for column in points.T]
    with np.errstate(all="ignore"):
        *values, ok = formula(namespaced(constants), *columns, NUMPY)
    outputs = np.empty((len(points), len(values)))
    for i, value in enumerate(values):
        outputs[:, i] = value
    ok = ok & np.isfinite(points).all(axis=-1) & np.isfinite(outputs).all(axis=-1)
    outputs[~ok] = np.nan
    return outputs, ok


def _by_kernel(
    formula: Callable[..., tuple[Any, ...]], constants: Constants, points: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """The same in one kernel, NaN and layout included: a pass over the memory costs more than a formula."""
    xp = drjit_namespace()
    import drjit as dr
    from drjit import llvm as jit

    count, width = points.shape
    columns = dr.unravel(getattr(jit, f"Array{width}f64"), jit.Float64(points.ravel()))
    *values, ok = formula(opaque(constants), *columns, xp)
    for number in (*columns, *values):
        ok = ok & dr.isfinite(number)
    outputs: Any = dr.ravel(jit.ArrayXf64([dr.select(ok, value, math.nan) for value in values]))
    dr.eval(outputs, ok)
    return outputs.numpy().reshape(count, len(values)), ok.numpy()
