"""Excess over the floor: how far a rectification is above the least distortion that scan lines can have."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

from rectbench.margin import MARGIN_DEG
from rectbench.metrics.distortion import distortion_column, distortion_of
from rectbench.metrics.log_distortion import RANKING_SHARE
from rectbench.metrics.row_misfit import case_row_misfit
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.metric import Case, Column, Metric
from rectbench.plugins.rectifier import METHODS, Problem
from rectbench.registry import registry
from rectbench.rigs import Rig
from rectbench.scored import Delivered, ScoredView
from rectbench.warps import lattice_pixels

LOWEST = "optimal"
"""The method that is the floor."""
FITTED_PIXELS, INTERVALS = 1_500, 5
"""Of an image. Twice as many pixels and one more interval lower the floor of log distortion by 0.1 % at most,
and that of L by 1.7 %, on seven fisheye rigs, and take twice as long."""
NONE = 1e-3
"""A floor below this is as good as none, and nothing is a multiple of it: of parallel pinholes it is 0."""


class Floor(NamedTuple):
    """The least that is found of both measures on A_0.95 of a rig's view."""

    log_distortion: float
    distortion: float
    """L, at the best scale."""


def log_distortion_at(delivered: Delivered) -> float:
    """On the share of the view that methods are ranked on."""
    return delivered.log_distortion(RANKING_SHARE)


def distortion_at(delivered: Delivered) -> float:
    """L there after the one scale that is best, which no method has to choose for L; NaN as the other's."""
    if not delivered.keeps(RANKING_SHARE):
        return math.nan
    return float(distortion_of(delivered.within(RANKING_SHARE), "rescaled"))


@lru_cache(maxsize=16)
def floor_of(rig: Rig, margin_deg: float = MARGIN_DEG) -> Floor:
    """That of a rig, by the lookup tables of `optimal`, fitted to A_0.95 for each measure by itself.

    NaN where the fit does not show all of it.

    >>> import rectbench as rb
    >>> floor = floor_of(rb.load_rig("t265").scaled(0.25))
    >>> round(floor.log_distortion, 2), round(floor.distortion, 2)
    (0.19, 0.12)
    """
    view = ScoredView.of(rig, margin_deg=margin_deg)
    lattices = [(side, lattice_pixels(side.camera, FITTED_PIXELS)) for side in (view.left, view.right)]
    left, right = (pixels[side.within(pixels, RANKING_SHARE)] for side, pixels in lattices)
    plugin, problem = registry(METHODS).get(LOWEST), Problem(rig.trimmed(margin_deg), left, right)

    def fitted(objective: str) -> Delivered:
        told = {"objective": objective, "intervals": INTERVALS, "search": "quick"}
        return Delivered.of(fit(plugin, problem, checked_options(plugin, told)), view)

    return Floor(log_distortion_at(fitted("log")), distortion_at(fitted("L")))


class ExcessOverFloor(Metric):
    """How far both measures of distortion are above the least that any map to scan lines can have."""

    name, topic = "floor", "Distortion"
    fits = (LOWEST,)
    columns = (
        Column.share(
            "excess_over_floor",
            "excess over floor",
            "lower",
            "How far log distortion on 95 % of the view is above the floor: the least that any rectification "
            "to scan lines can have there, each line as is best for it, found to within about a hundredth of "
            "itself. Empty where that is as good as 0.",
            shown="page",
        ),
        Column.share(
            "excess_over_floor_distortion",
            "excess over floor, L",
            "lower",
            "The same of the paper's L, each method at the one scale that is best for it.",
        ),
        distortion_column(
            "floor_log_distortion",
            "floor",
            "The least log distortion on 95 % of the view that any rectification to scan lines can have.",
            shown="rows",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Of both images together, over the floor of the true rig; that alone where nothing is comparable."""
        floor = floor_of(case.rig, case.rect.rig.margin_deg or MARGIN_DEG)
        found = {"floor_log_distortion": floor.log_distortion}
        if case.once(case_row_misfit).rectifies:
            pairs = {
                "excess_over_floor": (log_distortion_at(case.delivered), floor.log_distortion),
                "excess_over_floor_distortion": (distortion_at(case.delivered), floor.distortion),
            }
            found |= {key: value / least - 1 for key, (value, least) in pairs.items() if least > NONE}
        return {key: value for key, value in found.items() if math.isfinite(value)}
