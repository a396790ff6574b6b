"""Evaluates a formula at points: by NumPy where there are few, by a compiled kernel where there are many."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rectbench import llvm
from rectbench.formulas.namespaces import NUMPY, drjit_namespace, is_number
from rectbench.types import BoolArray, Constants, FloatArray

KERNEL_THRESHOLD = 1_000
"""Points from which a compiled kernel is used. It beats NumPy from some hundreds on, its launch included;
but each formula of each kind of lens is first compiled, once a machine, which takes as long as many calls."""


def opaque(tree: Any) -> Any:
    """Constants as Dr.Jit variables: as literals, each new camera would be a new kernel to compile."""
    import drjit as dr
    from drjit.llvm import Float64

    if isinstance(tree, float):  # most are
        return dr.opaque(Float64, tree)
    if isinstance(tree, tuple):
        return tuple(map(opaque, tree))
    if isinstance(tree, Mapping):
        return SimpleNamespace(**{name: opaque(value) for name, value in tree.items()})
    variable = Float64(tree if isinstance(tree, np.ndarray) else float(tree))
    dr.make_opaque(variable)
    return variable


def namespaced(tree: Any) -> Any:
    """Constants with attribute access, as the formulas read them."""
    if isinstance(tree, float):  # most are
        return tree
    if isinstance(tree, tuple):
        return tuple(map(namespaced, tree))
    if isinstance(tree, Mapping):
        return SimpleNamespace(**{name: namespaced(value) for name, value in tree.items()})
    return tree


def evaluate(
    formula: Callable[..., tuple[Any, ...]], constants: Constants, *columns: FloatArray
) -> tuple[NDArray[Any], ...]:
    """`formula(c, *columns, xp)` on flat float64 columns, compiled where there are many.

    The choice between NumPy and a kernel depends on the number of points alone, so the same call
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
    outputs = tuple(Float64(out) if is_number(out) else out for out in outputs)
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
    for numbers in (*columns, *values):
        ok = ok & np.isfinite(numbers)
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
    outputs: Any = dr.ravel(jit.ArrayXf64([xp.where(ok, value, math.nan) for value in values]))
    dr.eval(outputs, ok)
    return outputs.numpy().reshape(count, len(values)), ok.numpy()
