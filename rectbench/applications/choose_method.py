"""Which rectifier is the best for a rig: all that apply, measured in the frame that is asked for.

The rule: of the methods whose rows are as good as the best ones', the one with the least log distortion on
the same source pixels: the share of the view nearest to its middle that is asked for, or the asked field of
view.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from rectbench.errors import InvalidInput, Unsupported, argument
from rectbench.experiments.execution.outcomes import outcome_of
from rectbench.margin import MARGIN_DEG
from rectbench.metrics import frame_costs, row_error, row_misfit
from rectbench.plugins.defaults import CONTENDERS
from rectbench.plugins.fitting import checked_options, fit
from rectbench.plugins.rectifier import METHODS, Problem, Rectifier, is_built_in, pose_problem
from rectbench.registry import Plugin, registry
from rectbench.rigs import Rig
from rectbench.scored import Delivered, ScoredPixels, ScoredView, check_agreement
from rectbench.scored.differences import differences
from rectbench.types import BoolArray, FloatArray, Images, Matches
from rectbench.warps import (
    Framing,
    MonotoneSpline,
    Rectification,
    SplineSurface,
    centre_rays,
    framed,
    rectifying_rotations,
)
from rectbench.warps.frame import angles
from rectbench.warps.jacobians import LogStretches
from rectbench.warps.lookup.resampling import SIDES

COVERAGE = 0.95
"""The share of the source pixels that every method is made to show where nothing else is asked."""
ROWS_AS_GOOD_PX = 0.25
"""Rows count as good as the best ones while their median error is no more than this above, source pixels."""
RANKING = "log_distortion_on_view"
ROWS = "row_error_source_median_px"


@dataclass(frozen=True, eq=False)
class Candidate:
    """One method and what was measured of it; where it does not apply, the reason."""

    method: str
    rectification: Rectification | None = None
    measured: Mapping[str, float] = field(default_factory=dict)
    status: str = "ok"
    reason: str = ""


@dataclass(frozen=True, eq=False)
class Choice:
    """The methods that were tried, and the best of them; see `best_method`.

    >>> import rectbench as rb
    >>> rb.best_method(rb.load_rig("mynteye").scaled(0.25), methods=["abraham"]).table["status"].tolist()
    ['ok']
    """

    candidates: tuple[Candidate, ...]
    """The best first; then by rank, those that do not apply last."""
    framing: Framing

    @property
    def best(self) -> Candidate:
        """The chosen one."""
        return self.candidates[0]

    @property
    def rectification(self) -> Rectification:
        """The chosen method's, in the frame that was asked for."""
        assert self.best.rectification is not None  # `best_method` raises where no method applies
        return self.best.rectification

    @property
    def table(self) -> pd.DataFrame:
        """One row a method: method, status, reason and what was measured."""
        rows = ((c, {"method": c.method, "status": c.status, "reason": c.reason}) for c in self.candidates)
        return pd.DataFrame([about | dict(c.measured) for c, about in rows])

    @property
    def why(self) -> str:
        """The rule and how it fell out, in a sentence."""
        parts = [
            f"{self.best.method} has the least log distortion, {self.best.measured[RANKING]:.3f}, "
            f"on {_shown(self.framing)}"
        ]
        others = [c for c in self.candidates[1:] if c.rectification is not None]
        if rivals := [c for c in others if _rows_are_good(c, self.candidates)]:
            parts.append(f"next is {rivals[0].method} with {rivals[0].measured[RANKING]:.3f}")
        if gain := self._gain_of_freedom(rivals):
            parts.append(gain)
        if worse := [c.method for c in others if c not in rivals]:
            names = " and ".join(worse)
            parts.append(f"not counting {names}, whose rows are over {ROWS_AS_GOOD_PX:g} px worse")
        return "; ".join(parts)

    def _gain_of_freedom(self, rivals: Sequence[Candidate]) -> str:
        """How much less a free optimum has than the best map that a few numbers tell; empty of such a map."""
        closed = [c for c in rivals if c.rectification and not has_splines(c.rectification.left.target)]
        if not closed or not has_splines(self.rectification.left.target):
            return ""
        gain = 1 - self.best.measured[RANKING] / closed[0].measured[RANKING]
        return f"its free curves gain {gain:.0%} over {closed[0].method}, the best closed form"


def best_method(
    rig: Rig,
    *,
    framing: Framing | None = None,
    images: Images | None = None,
    matches: Matches | None = None,
    trusted: Matches | None = None,
    methods: Sequence[str] | None = None,
    seed: int = 0,
    margin_deg: float = MARGIN_DEG,
) -> Choice:
    """Try the methods that apply to a rig, and choose.

    Parameters
    ----------
    rig : the calibrated rig.
    framing : what each method is made to show, a coverage or a field of view, and how large. 95 % of the
        source pixels where it does not say what.
    images, matches : what methods may work from beside the rig, see `rectify`.
    trusted : correspondences by which rows are judged: of matches, or of the corners of a board. Without
        them all rows count as good.
    methods : names to try; by default the contenders among the built-in ones, and all others.
    seed : of the methods' random choices.
    margin_deg : nearer to the epipoles than this the view is trimmed, see `rectify`.

    Raises InvalidInput for a framing in which methods cannot be compared, Unsupported with the reasons
    where no method applies.

    >>> import rectbench as rb
    >>> rb.best_method(rb.load_rig("mynteye").scaled(0.25), methods=["abraham", "conventional"]).best.method
    'abraham'
    """
    chosen = framing or Framing()
    if chosen.crop is not None:
        same = f"methods are compared where all show the same, not in the crop {chosen.crop}"
        raise InvalidInput(f"{same}; expected {argument('coverage')} or {argument('fov_deg')}")
    if chosen.size is not None and chosen.focal_px is not None:
        both = f"{argument('size')} and {argument('focal_px')}"
        raise InvalidInput(f"{both} together say what is shown; expected one of them to compare in")
    if chosen.fov_deg is None and chosen.coverage is None:
        chosen = replace(chosen, coverage=COVERAGE)
    problem = pose_problem(rig, images=images, matches=matches, seed=seed, margin_deg=margin_deg)
    found = registry(METHODS)
    own = [p for p in found.plugins() if p.name in CONTENDERS or not is_built_in(p)]
    plugins = own if methods is None else [found.get(name) for name in methods]
    view = ScoredView.of(rig, margin_deg=margin_deg)
    tried = [_tried(plugin, problem, view, chosen, trusted) for plugin in plugins]
    if not any(candidate.rectification for candidate in tried):
        by_reason: dict[str, list[str]] = {}
        for candidate in tried:
            by_reason.setdefault(candidate.reason, []).append(candidate.method)
        reasons = "; ".join(f"{', '.join(methods)}: {reason}" for reason, methods in by_reason.items())
        if len(by_reason) == 1 and len(tried) > 1:
            (reasons,) = by_reason
        raise Unsupported(f"no method applies to rig {rig.name}: {reasons}")
    return Choice(tuple(sorted(tried, key=lambda candidate: _rank(candidate, tried))), chosen)


def has_splines(target: Any) -> bool:
    """Whether a map is made of splines, by the parts of its target, rather than of a few numbers."""
    if isinstance(target, MonotoneSpline | SplineSurface):
        return True
    parts = fields(target) if is_dataclass(target) else ()
    return any(has_splines(getattr(target, part.name)) for part in parts)


def uncalibrated_methods() -> list[str]:
    """The methods that need no calibration: they work from matches or images alone."""
    return [plugin.name for plugin in registry(METHODS).plugins() if "pose" not in plugin.value.needs]


def _tried(
    plugin: Plugin[Rectifier],
    problem: Problem,
    view: ScoredView,
    framing: Framing,
    trusted: Matches | None,
) -> Candidate:
    try:
        own = fit(plugin, problem, checked_options(plugin, {}))
        delivered = Delivered.of(own, view)
        check_agreement(own, delivered)
        rows = row_misfit(own, delivered, problem.rig, works_from=plugin.value.needs)
        rect = framed(own, framing)
        measured = frame_costs(rect, problem.rig)
        measured[RANKING] = log_distortion_where(own, delivered, framing) if rows.rectifies else math.nan
        if trusted is not None:
            measured[ROWS] = row_error(rect, *trusted).columns()[ROWS]
    except Exception as error:  # a plugin may raise anything, and the others are still to be tried
        outcome = outcome_of(error)
        return Candidate(plugin.name, status=outcome.status, reason=outcome.reason)
    lacks = "" if math.isfinite(measured[RANKING]) else f"does not map all of {_shown(framing)}"
    return Candidate(plugin.name, rect, measured, reason=rows.reason or lacks)


def log_distortion_where(rect: Rectification, delivered: Delivered, framing: Framing) -> float:
    """Log distortion on the part of the view that a framing speaks of.

    On the share of the view nearest to its middle for a coverage, else on the pixels within the field of
    view. By the lookup tables where these show it all, else by differences of the map over a pixel, whatever
    its own frame shows. NaN where the rectification does not map all of it.
    """
    shown, weights, asked_px = [], [], []
    for name, R_epi_cam in zip(SIDES, rectifying_rotations(rect.rig), strict=True):
        side = delivered.side(name)
        asked = _asked(side.scored.pixels, side.scored, framing, rect.rig, R_epi_cam)
        shown.append(side.shown[asked])
        asked_px.append(side.scored.pixels[asked])
        middles = side.pieces.middles.T
        weights.append(side.pieces.areas_px * _asked(middles, side.scored, framing, rect.rig, R_epi_cam))
    if np.concatenate(shown).all():
        return delivered.log_stretches.distortion(np.concatenate(weights))[0]
    J = np.concatenate(
        [
            differences(rect.warp(side), px, turn_px=rect.turn_px)[1]
            for side, px in zip(SIDES, asked_px, strict=True)
        ]
    )
    return LogStretches.of(J).distortion()[0] if np.isfinite(J).all() else math.nan


def _asked(
    pixels: FloatArray, scored: ScoredPixels, framing: Framing, rig: Rig, R_epi_cam: FloatArray
) -> BoolArray:
    """Mask [N] of the source pixels [N, 2] that a framing speaks of."""
    if framing.fov_deg is None:
        return scored.within(pixels, framing.coverage or 1.0)
    rays, seen = scored.camera.unproject(pixels)
    off = np.stack(angles(rays @ R_epi_cam.T), axis=-1) - np.mean(angles(centre_rays(rig)), axis=-1)
    asked: BoolArray = seen & np.all(np.abs(off) <= np.radians(framing.fov_deg) / 2, axis=-1)
    return asked


def _rank(candidate: Candidate, all_tried: Sequence[Candidate]) -> tuple[bool, bool, float]:
    value = candidate.measured.get(RANKING, math.inf)
    distortion = value if math.isfinite(value) else math.inf
    return candidate.rectification is None, not _rows_are_good(candidate, all_tried), distortion


def _rows_are_good(candidate: Candidate, all_tried: Sequence[Candidate]) -> bool:
    known = [c.measured[ROWS] for c in all_tried if math.isfinite(c.measured.get(ROWS, math.nan))]
    return not known or candidate.measured.get(ROWS, math.inf) <= min(known) + ROWS_AS_GOOD_PX


def _shown(framing: Framing) -> str:
    if framing.fov_deg is not None:
        across, down = framing.fov_deg
        return f"the same view of {across:g}x{down:g}°"
    return f"the {framing.coverage:.0%} of the source pixels nearest to the middle of the view"
