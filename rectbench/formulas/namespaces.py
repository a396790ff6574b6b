"""The language of formulas on plain arrays: NumPy's, and Dr.Jit's, which becomes one parallel kernel."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
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


NUMPY = _functions_of(np, {})


@cache
def drjit_namespace() -> Formulas:
    """The language on Dr.Jit's float64 arrays; what Dr.Jit lacks, or takes otherwise, is stated here."""
    llvm.require()
    import drjit as dr
    from drjit.llvm import Float64

    def where(condition: Any, x: Any, y: Any) -> Any:
        # Of two plain numbers Dr.Jit would make float32.
        return dr.select(condition, Float64(x) if isinstance(x, float) else x, y)

    own: dict[str, Callable[..., Any]] = {
        "where": where,
        "hypot": lambda x, y: dr.sqrt(x * x + y * y),  # dr.hypot guards against overflow: no ray comes near
        "pow": dr.power,
        "sign": lambda x: dr.select(x > 0.0, Float64(1.0), dr.select(x < 0.0, Float64(-1.0), 0.0 * x)),
        "expm1": lambda x: 2.0 * dr.sinh(0.5 * x) * dr.exp(0.5 * x),
        "log1p": lambda x: 2.0 * dr.atanh(x / (2.0 + x)),
    }
    return _functions_of(dr, own)
