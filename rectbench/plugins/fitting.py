"""From a method's name and options to a checked rectification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from pydantic import ValidationError

from rectbench.errors import InvalidInput, InvalidResult, UnknownName, Unsupported
from rectbench.plugins.rectifier import Options, Problem, Rectifier
from rectbench.registry import Plugin
from rectbench.warps import Rectification, Warp
from rectbench.warps.rectification import in_frame


def checked_options(plugin: Plugin[Rectifier], given: Mapping[str, Any]) -> Options:
    """The method's options, those not given at their defaults.

    Raises UnknownName for one the method has not, InvalidInput for a value it cannot have.
    """
    options: type[Options] = plugin.value.Options
    try:
        return options.model_validate(dict(given))
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        name = ".".join(str(part) for part in fault["loc"])
        if fault["type"] == "extra_forbidden":
            raise UnknownName(f"option of {plugin.name}", name, options.model_fields) from None
        expected = fault["msg"].removeprefix("Input should be ").removeprefix("Value error, ")
        raise InvalidInput(
            f"{plugin.name}: option {name} is {fault['input']!r}; expected {expected}"
        ) from None


def fit(plugin: Plugin[Rectifier], problem: Problem, options: Options) -> Rectification:
    """The method's answer, checked; raises InvalidResult for one of the wrong type, shape or values.

    Raises Unsupported where the method works from images and the problem has none.
    """
    if "images" in plugin.value.needs and problem.images is None:
        raise Unsupported(f"{plugin.name} works from images, and there are none")
    return checked_result(plugin.name, plugin.value.fit(problem, options), problem)


def checked_result(method: str, result: object, problem: Problem) -> Rectification:
    """A copy of `result`, so that what a method does to its own afterwards changes nothing.

    Raises InvalidResult unless it is a rectification of the problem's rig with usable numbers.
    """
    if type(result) is not Rectification:  # a subclass may show its user another map than it is scored by
        raise InvalidResult(f"{method} returned {type(result).__name__}; expected a Rectification itself")
    for side in ("left", "right"):
        camera, pixels = getattr(problem.rig, side), getattr(problem, f"pixels_{side}")
        warp = getattr(result, side)
        if not isinstance(warp, Warp):
            raise InvalidResult(f"{method}: the {side} warp is {type(warp).__name__}; expected a Warp")
        # A map that keeps the epipoles apart may show what is trimmed too.
        if warp.source not in (camera, camera.whole):
            raise InvalidResult(f"{method}: the {side} warp starts from another camera than the rig's")
        mapped = np.asarray(warp.forward(pixels))
        if mapped.shape != pixels.shape:
            raise InvalidResult(f"{method}: {side}.forward gives {mapped.shape} for {pixels.shape} pixels")
        if np.isinf(mapped).any() or not np.isfinite(mapped).any():
            raise InvalidResult(f"{method}: {side}.forward gives no finite pixel, or an infinite one")
        if not in_frame(mapped, result.size).any():
            raise InvalidResult(f"{method}: no {side} pixel lands in the rectified image: it is empty")
    return replace(result, left=replace(result.left), right=replace(result.right))
