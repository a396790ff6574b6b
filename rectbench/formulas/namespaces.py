"""The language of formulas on plain arrays: NumPy's, and Dr.Jit's, which becomes one parallel kernel."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from numbers import Real
from types import ModuleType
from typing import Any

import numpy as np

from rectbench import llvm
from rectbench.formulas.protocol import ArrayFunctions, Formulas


def _functions_of(module: ModuleType, own: Mapping[str, Callable[..., Any]]) -> Formulas:
    """A module's functions by the names of the language, those in `own` before the module's."""
    names = [name for name in vars(ArrayFunctions) if not name.startswith("_")]
    functions = {name: staticmethod(own.get(name) or getattr(module, name)) for name in names}
    formulas: Formulas = type(f"{module.__name__}_formulas", (Formulas,), functions)()
    return formulas


def _interval(knots: Any, x: Any) -> Any:
    return np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(knots) - 2)


def _take(table: Any, number: Any) -> Any:
    return table[np.nan_to_num(number, nan=0.0).astype(np.intp)]


NUMPY = _functions_of(np, {"interval": _interval, "take": _take})


def is_number(x: Any) -> bool:
    """Whether x is one plain number: of those alone Dr.Jit makes int32 or float32, too few digits."""
    return isinstance(x, Real) and not isinstance(x, bool)


@cache
def drjit_namespace() -> Formulas:
    """The language on Dr.Jit's float64 arrays; what Dr.Jit lacks, or takes otherwise, is stated here."""
    llvm.require()
    import drjit as dr
    from drjit.llvm import Float64, UInt32

    def where(condition: Any, x: Any, y: Any) -> Any:
        return dr.select(condition, Float64(x) if is_number(x) else x, y)

    def keep_nan(x: Any, value: Any) -> Any:
        return dr.select(dr.isnan(x), x, value)

    def atan2(y: Any, x: Any) -> Any:
        # Of NaN Dr.Jit makes 0, and of y = -0 it takes the upper side of the cut.
        return keep_nan(x + y, dr.copysign(dr.atan2(y, x), y))

    def log1p(x: Any) -> Any:
        return dr.select(dr.abs(x) < 0.5, 2.0 * dr.atanh(x / (2.0 + x)), dr.log(1.0 + x))

    def expm1(x: Any) -> Any:
        return dr.select(dr.abs(x) < 1.0, 2.0 * dr.sinh(0.5 * x) * dr.exp(0.5 * x), dr.exp(x) - 1.0)

    def interval(knots: Any, x: Any) -> Any:
        def halved(low: Any, high: Any) -> tuple[Any, Any]:
            middle = (low + high) >> 1
            above = dr.gather(Float64, knots, middle) <= x
            return dr.select(above, middle, low), dr.select(above, high, middle)

        # The table's length is no literal: one kernel serves all of them.
        first = dr.zeros(UInt32, dr.width(x))
        ends = first, first + dr.opaque(UInt32, dr.width(knots) - 1)
        return dr.while_loop(ends, lambda low, high: high - low > 1, halved)[0]

    own: dict[str, Callable[..., Any]] = {
        "interval": interval,
        "take": lambda table, number: dr.gather(Float64, table, UInt32(number)),
        "where": where,
        "hypot": lambda x, y: dr.sqrt(x * x + y * y),  # dr.hypot guards against overflow: no ray comes near
        "pow": dr.power,
        "atan": lambda x: keep_nan(x, dr.atan(x)),
        "atan2": atan2,
        "sign": lambda x: where(x > 0.0, 1.0, where(x < 0.0, -1.0, dr.abs(x))),  # 0 and NaN stay
        "expm1": expm1,
        "log1p": log1p,
    }
    return _functions_of(dr, own)
