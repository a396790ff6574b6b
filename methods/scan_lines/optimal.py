"""The least distortion that any map to scan lines can have: the floor under all of them."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any, Literal

import numpy as np

import rectbench as rb

from ._free_form import Columns, FreeForm, Intervals, Rows
from ._log_energy import WeightedPixels
from ._stretch_energies import StretchEnergy
from .abraham import Abraham
from .local_homography import LocalHomography
from .log_polar import LogPolar
from .polar import Polar
from .polar_optimal import ELSEWHERE, PolarOptimal

FITTED_PIXELS, LEVELS = 3500, 3
"""Pixels an image, where nobody asks for certain ones, and how often they get denser towards the epipoles."""
PIXELS_A_COEFFICIENT = 8
ROWS_FINER = 4
"""So many times the intervals of h, a surface, has g, a curve: where lines end its slope changes quickly."""
FIRST_INTERVALS, MOST_INTERVALS = 4, 16
ENOUGH_GAIN = 1e-3
"""Intervals are halved until that takes less than this share of the distortion away; starts agree to it."""
RIVALS: tuple[tuple[rb.Rectifier[Any], dict[str, str]], ...] = (
    *((Abraham(), {"law": law}) for law in ("equidistant", "stereographic", "equisolid", "orthographic")),
    (Abraham(), {"law": "cylindrical"}),
    (LogPolar(), {}),
    (Polar(), {}),
    (LocalHomography(), {}),
    (PolarOptimal(), {}),
)


class Options(rb.Options):
    objective: Literal["log", "L"] = rb.option(
        "log", "what is least: log distortion, or the paper's L with α1 = α2 = 0.5"
    )
    columns: Columns = rb.option(
        "full", "full: û = h(β, γ), each line as is best for it; separable: û = h(γ), all lines alike"
    )
    rows: Rows = rb.option(
        "shared", "per-image gives each image a g of its own, which rectifies nothing: for what sharing costs"
    )
    intervals: int | None = rb.option(
        None, "intervals of h along either angle; as many as gain anything where left out", ge=1, le=32
    )
    search: Literal["thorough", "quick"] = rb.option(
        "thorough",
        "thorough: from several starts, and never above another method; quick: from the best h(γ) alone",
    )


class Optimal(rb.Rectifier[Options]):
    """û = h(β, γ), v̂ = g(β): all that rows can be, as monotone splines of least distortion.

    No other map whose rows are epipolar planes is below it on the pixels that it is fitted to.
    """

    name = "optimal"
    references = (
        "Zhou, Dai and Li, Pixel-variant Local Homography for Fisheye Stereo Rectification "
        "Minimizing Resampling Distortion",
        "Ramsay, Monotone Regression Splines in Action, Statistical Science 3(4), 1988",
    )

    def fit(self, problem: rb.Problem, options: Options) -> rb.Rectification:
        """Newton's method from several starts, then on ever more intervals; a rival, where that is better."""
        rig, warps = problem.rig, problem.angle_warps()
        left, right = (
            fitted(warp, asked)
            for warp, asked in zip(warps, (problem.pixels_left, problem.pixels_right), strict=True)
        )
        energy = StretchEnergy(options.objective, warps, left, right)
        distortion = np.sqrt if options.objective == "log" else float
        view, focal_px = rb.view_angles(rig), rb.centre_resolution_px(rig)

        def form(intervals: int, columns: Columns = options.columns) -> FreeForm:
            both = Intervals(intervals, ROWS_FINER * intervals)
            return FreeForm(energy, view, both, focal_px, columns, options.rows)

        intervals = options.intervals or FIRST_INTERVALS
        splines, alike = form(intervals), form(intervals, "separable")
        found = splines.least(alike.refined(alike.least(alike.even()).z, splines))
        notes: dict[str, float | str] = {}
        if options.search == "thorough":
            found, other = sorted((found, splines.least(splines.even())), key=lambda fit: fit.energy)
            if (apart := distortion(other.energy) / distortion(found.energy) - 1) > ENOUGH_GAIN:
                notes["warning"] = f"two starts end {apart:.1%} apart: there may be less than was found"

        while options.intervals is None and intervals < MOST_INTERVALS:
            finer = form(2 * intervals)
            if finer.count * PIXELS_A_COEFFICIENT > energy.effective_count:
                break
            below = finer.least(splines.refined(found.z, finer))
            if distortion(below.energy) > (1 - ENOUGH_GAIN) * distortion(found.energy):
                break
            intervals, splines, found = 2 * intervals, finer, below

        best = rectification(rig, splines, found.z)
        least = energy.of_rectification(best)
        for name, rival in served(problem) if options.search == "thorough" else ():
            if (theirs := energy.of_rectification(rival)) < least:
                best, least, notes["taken_from"] = rival, theirs, name
        notes |= {
            "distortion": float(distortion(least)),
            "intervals": float(intervals),
            "coefficients": float(splines.count),
        }
        return replace(best, notes=notes)


def fitted(warp: rb.Warp, asked: np.ndarray) -> WeightedPixels:
    """The pixels asked for, and hardly any other; in the place of the usual grid more, and better spread."""
    usual = rb.evaluation_pixels(warp.source)
    if np.array_equal(asked, usual):
        return spread(warp, FITTED_PIXELS)
    weights = np.repeat([1.0, ELSEWHERE * len(asked) / len(usual)], [len(asked), len(usual)])
    return WeightedPixels(np.concatenate([asked, usual]), weights)


def spread(warp: rb.Warp, count: int) -> WeightedPixels:
    """Pixels, `count` of a full image, and more of less weight towards the epipoles, where distortion grows.

    Where lines are 2^k times as close as on the middle one, 4^k times as many of a lattice no two of which
    share a row: rows of a grid are nearly lines of one β, and between two of them g would be free.
    """
    pixels, weights = [], []
    for k in range(LEVELS):
        lattice = rb.lattice_pixels(warp.source, 4**k * count)
        gamma = warp.forward(lattice)[:, 0]
        closer = np.log2(1 / np.cos(gamma))
        there = (closer >= k) & ((closer < k + 1) | (k == LEVELS - 1))
        pixels.append(lattice[there])
        weights.append(np.full(there.sum(), 4.0**-k))
    return WeightedPixels(np.concatenate(pixels), np.concatenate(weights))


def rectification(rig: rb.Rig, splines: FreeForm, z: np.ndarray) -> rb.Rectification:
    """The free form's maps in a frame that just holds both images; what is far has about no disparity."""
    view, rows = splines.view, splines.profiles(z)
    height = float(max(v(v.high) for v in rows))  # from 0 on
    sides = (rig.left, rig.right), rb.rectifying_rotations(rig), splines.surfaces(z), rows
    warps = [
        rb.Warp(camera, R_rect_cam, rb.ScanLines(u, v.framed(0.0, 1.0)))
        for camera, R_rect_cam, u, v in zip(*sides, strict=True)
    ]
    offsets = 0.0, apart_px(rig, *warps)
    reached = []
    for warp, offset in zip(warps, offsets, strict=True):
        pixels, spacing_px = rb.outline_pixels(warp.source)
        columns = warp.forward(pixels)[:, 0] + offset
        reached += [np.nanmin(columns) - spacing_px, np.nanmax(columns) + spacing_px]
    start = float(min(reached))
    targets: list[rb.Target] = [
        warp.target.framed(start - offset, -0.5, 1.0, 1.0)
        for warp, offset in zip(warps, offsets, strict=True)
    ]
    if min(-view.beta.low, view.beta.high) >= np.pi:
        targets = [rb.Wrapped(target, -0.5, height) for target in targets]
    size = int(np.ceil(max(reached) - start)), int(np.ceil(height))
    return rb.Rectification.from_targets(rig, targets[0], targets[1], size)


def apart_px(rig: rb.Rig, left: rb.Warp, right: rb.Warp) -> float:
    """How much greater û is in the left image than in the right, of what both see far away: the median."""
    pixels = rb.evaluation_pixels(rig.left)
    rays = rig.left.unproject(pixels)[0] @ rig.R_right_left.T
    both = rig.right.sees(rays)
    columns = right.forward(rig.right.project(rays[both])[0])[:, 0]
    return float(np.nanmedian(left.forward(pixels[both])[:, 0] - columns)) if both.any() else 0.0


def served(problem: rb.Problem) -> Iterator[tuple[str, rb.Rectification]]:
    """What the other methods with epipolar planes as rows make of a problem, where they serve it."""
    for method, told in RIVALS:
        with suppress(rb.RectbenchError):
            yield " ".join((method.name, *told.values())), method.fit(problem, method.Options(**told))
    with suppress(rb.Unsupported):
        yield "conventional", perspective(problem.rig)


def perspective(rig: rb.Rig) -> rb.Rectification:
    """The rectification to planes at the sources' resolution: of parallel pinholes it is the floor."""
    frame, size = rb.PerspectiveFrame.of(rig), rb.perspective_size(rig)
    focal_px = rb.centre_resolution_px(rig)
    target = rb.Perspective.from_focal(focal_px, *((np.array(size) - 1) / 2 - focal_px * frame.middle))
    left, right = (
        rb.Warp(camera, R_rect_cam, target)
        for camera, R_rect_cam in ((rig.left, frame.R_rect_left), (rig.right, frame.R_rect_right))
    )
    return rb.Rectification(rig, left, right, size)
