"""Derivatives of a pixel by the lens's own parameters, by which a calibration's uncertainty is propagated.

A parameter goes by its name in the model; an entry of a sequence by name and place, such as `poly.0`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rectbench.cameras.camera import Camera
from rectbench.cameras.lens import lens_named
from rectbench.cameras.parameters import Parameter
from rectbench.cameras.projection import as_points
from rectbench.errors import UnknownName
from rectbench.formulas.evaluation import evaluate_points
from rectbench.formulas.jets import Jet, JetNamespace, constant
from rectbench.formulas.protocol import Formulas
from rectbench.types import Constants, FloatArray

DERIVED_STEP = 1e-6
"""Step, relative to a parameter or to 1, of the central differences of what a model derives from it."""


def parameter_names(camera: Camera) -> tuple[str, ...]:
    """The names of all numbers that make the lens, in its model's order."""
    names: list[str] = []
    for name, value in camera.params.items():
        names += [f"{name}.{place}" for place in range(len(value))] if isinstance(value, tuple) else [name]
    return tuple(names)


def with_changes(camera: Camera, changes: Mapping[str, float]) -> Camera:
    """The camera with these amounts added to its parameters.

    Raises UnknownName for a parameter that its model has not, InvalidInput where they make no camera.
    """
    return replace(camera, params=_changed(camera, changes)) if changes else camera


def projection_by_parameters(camera: Camera, rays: ArrayLike, names: Sequence[str]) -> FloatArray:
    """d(pixel)/d(parameter) [..., 2, P] of fixed rays [..., 3], for P names; NaN outside the domain."""
    rays = as_points(rays, 3, "rays")

    def formula(c: Any, x: Any, y: Any, z: Any, xp: Formulas) -> tuple[Any, ...]:
        by_u, by_v, ok = parameter_partials(camera, c, len(names), x, y, z, xp)
        return *by_u, *by_v, ok

    partials, _ = evaluate_points(formula, parameter_constants(camera, names), rays)
    return partials.reshape(*rays.shape[:-1], 2, len(names))


def parameter_constants(camera: Camera, names: Sequence[str]) -> Constants:
    """The constants of `parameter_partials`: the camera's own, and the slope of each by each parameter.

    A parameter's slope by itself is 1. What the model derives from its parameters, once a camera, is
    differenced: those are a few numbers, and smooth wherever a pixel depends on them.
    """
    columns = [_slopes(camera, name) for name in names]
    return {"value": camera.constants, "slope": _transposed(camera.constants, columns)}


def parameter_partials(
    camera: Camera, c: Any, count: int, x: Any, y: Any, z: Any, xp: Formulas
) -> tuple[tuple[Any, ...], tuple[Any, ...], Any]:
    """The partial derivatives of u and of v by the parameters, and the mask, as part of a formula.

    `count` is how many parameters the slopes among the constants `c` are by.
    """
    ray = (constant(x), constant(y), constant(z))
    u, v, ok = camera.project_formula(_jets(c.value, c.slope), *ray, JetNamespace(xp))
    none = (0.0 * x,) * count  # of a coordinate that depends on none of them, as v on fx
    return constant(u).partials or none, constant(v).partials or none, ok


def _changed(camera: Camera, changes: Mapping[str, float]) -> dict[str, Parameter]:
    known = parameter_names(camera)
    params = dict(camera.params)
    for name, change in changes.items():
        if name not in known:
            raise UnknownName(f"parameter of {camera.model}", name, known)
        whole, _, place = name.partition(".")
        if place:
            entries = list(params[whole])
            entries[int(place)] += change
            params[whole] = tuple(entries)
        else:
            params[whole] += change
    return params


def _slopes(camera: Camera, name: str) -> Constants:
    """d(constant)/d(parameter) of all of the camera's constants."""
    whole, _, place = name.partition(".")
    value = camera.params[whole]
    number = value[int(place)] if place else value
    step = DERIVED_STEP * max(1.0, abs(number))
    derive = lens_named(camera.model).derive
    more, less = (derive(SimpleNamespace(**_changed(camera, {name: move}))) for move in (step, -step))
    own = {key: _like(held, 0.0) for key, held in camera.params.items()}
    own[whole] = tuple(float(i == int(place)) for i in range(len(value))) if place else 1.0
    fixed = {name: held for name, held in camera.constants.items() if name in ("cos_max_angle", "blind")}
    return {**own, **_difference(more, less, 2 * step), **_difference(fixed, fixed, 1.0)}


def _difference(a: Any, b: Any, step: float) -> Any:
    if isinstance(a, Mapping):
        return {name: _difference(value, b[name], step) for name, value in a.items()}
    if isinstance(a, tuple):
        return tuple(_difference(p, q, step) for p, q in zip(a, b, strict=True))
    # An edge of the domain may lie at infinity; no pixel depends on where it is.
    return (a - b) / step if np.isfinite(a) and np.isfinite(b) else 0.0


def _like(value: Any, number: float) -> Any:
    return tuple(number for _ in value) if isinstance(value, tuple) else number


def _transposed(constants: Any, columns: Sequence[Any]) -> Any:
    """For each constant its slopes by all parameters, none where it depends on none of them."""
    if isinstance(constants, Mapping):
        return {name: _transposed(held, [c[name] for c in columns]) for name, held in constants.items()}
    if isinstance(constants, tuple):
        return tuple(_transposed(held, [c[i] for c in columns]) for i, held in enumerate(constants))
    return tuple(columns) if any(columns) else ()


def _jets(values: Any, slopes: Any) -> Any:
    if isinstance(values, SimpleNamespace):
        return SimpleNamespace(
            **{name: _jets(value, getattr(slopes, name)) for name, value in vars(values).items()}
        )
    if isinstance(values, tuple):
        return tuple(_jets(value, slope) for value, slope in zip(values, slopes, strict=True))
    return Jet(values, slopes)
