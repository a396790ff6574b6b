"""One suite of checks that every rectifier passes, a third party's as the built-in ones."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rectbench.calibrations import load_rig
from rectbench.errors import InvalidResult, Unsupported
from rectbench.experiments.execution.outcomes import outcome_of
from rectbench.metrics import row_error
from rectbench.metrics.row_misfit import simulated_matches
from rectbench.pairs.rendering import placed
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import Problem, Rectifier, pose_problem
from rectbench.registry import Plugin
from rectbench.scored import Delivered, ScoredView, check_agreement
from rectbench.scored.agreement import PLACES
from rectbench.types import FloatArray
from rectbench.warps import Rectification, Warp

RIGS = ("perspective-toed-in", "bumblebee2", "t265", "sony-as200v", "mynteye", "kitti-360")
"""Perspective and fisheye, in several models, with parallel and turned axes."""
IMAGE_WIDTH = 320

CLOSURE_PX = 1e-6
DERIVATIVE_ERROR = 1e-5
"""Relative; what central differences of float64 leave over."""
ROW_ERROR_PX = 1e-6
STEPS_PX = 1e-3, 1e-5
"""The short one serves where a map grows without bounds, as a plane's does towards 90°."""
MATCHES, DISTANCES = 3000, (3.0, 1000.0)
"""Points all over the view, none that a method was given; how far away, in baselines."""
SCORED_SHARE = 0.05
"""A method maps at least this share of the evaluation pixels."""


@dataclass(frozen=True)
class CheckResult:
    """What one check found on one rig."""

    rig: str
    check: str
    result: Literal["passed", "failed", "unsupported"]
    detail: str


Check = Callable[[Plugin[Rectifier], Problem, Rectification], tuple[bool, str]]


def check_method(plugin: Plugin[Rectifier]) -> Iterator[CheckResult]:
    """All checks of a rectifier on several rigs, as they are done.

    A rig the method refuses as Unsupported fails nothing, but refusing all of them does.
    """
    yield _described(plugin)
    supported = False
    for name in RIGS:
        rig = placed(load_rig(name), "check", "as-calibrated", 0, IMAGE_WIDTH)
        problem = pose_problem(rig)
        try:
            rectification = fit(plugin, problem, checked_options(plugin, {}))
        except Unsupported as refusal:
            yield CheckResult(name, "fit", "unsupported", str(refusal))
            continue
        except Exception as error:  # a plugin may raise anything
            yield CheckResult(name, "fit", "failed", outcome_of(error).reason)
            continue
        supported = True
        yield CheckResult(name, "fit", "passed", f"{rectification.size[0]}x{rectification.size[1]} px")
        for check in _CHECKS:
            passed, detail = _found(check, plugin, problem, rectification)
            yield CheckResult(name, check.__name__.strip("_"), "passed" if passed else "failed", detail)
    if not supported:
        yield CheckResult("all", "fit", "failed", "the method serves none of the rigs")


def _found(
    check: Check, plugin: Plugin[Rectifier], problem: Problem, rect: Rectification
) -> tuple[bool, str]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # NaN is what stands for "no pixel here"
            return check(plugin, problem, rect)
    except Exception as error:  # a plugin's own warp may raise anything
        return False, outcome_of(error).reason


def _described(plugin: Plugin[Rectifier]) -> CheckResult:
    if not plugin.summary:
        lack = "the class has no docstring; expected one line that says what it is"
    elif not all(field.description for field in plugin.value.Options.model_fields.values()):
        lack = "an option has no description"
    else:
        return CheckResult("-", "described", "passed", plugin.summary)
    return CheckResult("-", "described", "failed", lack)


def _sides(problem: Problem, rect: Rectification) -> tuple[tuple[str, Warp, FloatArray], ...]:
    return ("left", rect.left, problem.pixels_left), ("right", rect.right, problem.pixels_right)


def _maps(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    width, height = rect.size
    for side in ("left", "right"):
        for table in rect.maps(side):
            if table.dtype != np.float32 or table.shape != (height, width):
                return False, f"{side}: {table.dtype} {table.shape}; expected float32 {(height, width)}"
            if not np.isfinite(table).all():
                return False, f"{side}: not finite"
    shares = [float(rect.valid("left").mean()), float(rect.valid("right").mean())]
    return min(shares) > 0, f"{shares[0]:.0%} and {shares[1]:.0%} of the output are valid"


def _closure(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    worst, mapped = 0.0, []
    for _, warp, pixels in _sides(problem, rect):
        there = warp.forward(pixels)
        known = np.isfinite(there).all(axis=-1)
        mapped.append(known.mean())
        off = np.linalg.norm(warp.inverse(there[known]) - pixels[known], axis=-1)
        worst = max(worst, float(np.nan_to_num(off, nan=np.inf).max(initial=0)))
    share = float(min(mapped))
    if share < SCORED_SHARE:
        return False, f"only {share:.0%} of the pixels are mapped"
    return worst <= CLOSURE_PX, f"{worst:.1e} px, {share:.0%} of the pixels mapped"


def _jacobian(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    worst = 0.0
    for side, warp, pixels in _sides(problem, rect):
        exact = warp.jacobian(pixels)
        if exact.shape != (len(pixels), 2, 2):
            return False, f"{side}: shape {exact.shape}; expected {(len(pixels), 2, 2)}"
        numerics = [_central_differences(warp, pixels, step_px, rect.turn_px) for step_px in STEPS_PX]
        inner = np.isfinite(numerics).all(axis=(0, 2, 3))
        if not np.isfinite(exact[inner]).all():
            return False, f"{side}: NaN where the warp has values"
        scale = np.abs(exact[inner]).max(axis=(1, 2))
        off = np.min([np.abs(exact - numeric)[inner].max(axis=(1, 2)) for numeric in numerics], axis=0)
        worst = max(worst, float((off / scale).max(initial=0)))
    return worst <= DERIVATIVE_ERROR, f"{worst:.1e} off central differences"


def _central_differences(warp: Warp, pixels: FloatArray, step_px: float, turn_px: float | None) -> FloatArray:
    """d(rectified)/d(source) [N, 2, 2]; NaN where there is none, and across the seam, where maps may bend."""
    steps = step_px * np.eye(2)
    moved = [warp.forward(pixels + step) - warp.forward(pixels - step) for step in steps]
    if turn_px is not None:
        for way in moved:
            way[np.abs(way[:, 1]) > turn_px / 2] = np.nan
    return np.stack(moved, axis=-1) / (2 * step_px)


def _orientation(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    shares = []
    for _, warp, pixels in _sides(problem, rect):
        determinant = np.linalg.det(warp.jacobian(pixels))
        shares.append(float((determinant[np.isfinite(determinant)] > 0).mean()))
    return min(shares) == 1, f"det J > 0 at {min(shares):.1%} of the mapped pixels"


def _rows(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    errors = row_error(rect, *simulated_matches(problem.rig, MATCHES, *DISTANCES)).rectified_px
    errors = errors[np.isfinite(errors)]
    if not errors.size:
        return False, "no correspondence is mapped in both images"
    worst = float(errors.max())
    if "pose" not in plugin.value.needs:
        return True, f"{worst:.1e} px; the method does not know the pose"
    if plugin.value.is_control:
        return True, f"{worst:.1e} px; a control, whose rows are no epipolar planes"
    return worst <= ROW_ERROR_PX, f"{worst:.1e} px with the exact pose"


def _agreement(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    delivered = Delivered.of(rect, ScoredView.of(problem.rig))
    try:
        check_agreement(rect, delivered)
    except InvalidResult as disagreement:
        return False, str(disagreement)
    return True, f"one map at {2 * PLACES} places; {delivered.kept_share:.0%} of the view kept"


def _repeatable(plugin: Plugin[Rectifier], problem: Problem, rect: Rectification) -> tuple[bool, str]:
    again = fit(plugin, problem, checked_options(plugin, {}))
    if again.size != rect.size:
        return False, f"{rect.size} px, then {again.size} px"
    for side in ("left", "right"):
        for first, second in zip(rect.maps(side), again.maps(side), strict=True):
            if not np.array_equal(first, second):
                return False, f"{side} maps differ by up to {float(np.abs(first - second).max()):.1e} px"
    return True, "the same maps twice"


_CHECKS: tuple[Check, ...] = (_maps, _closure, _jacobian, _orientation, _rows, _agreement, _repeatable)
