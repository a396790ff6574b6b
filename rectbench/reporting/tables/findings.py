"""What a part tells in a sentence: who leads, where an order turns, how far a perspective image is best."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from statistics import median

from rectbench.metrics.view import PERSPECTIVE, PROJECTION
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Part
from rectbench.reporting.asked import methods_part
from rectbench.reporting.charts.critical_difference import LEAST_RIGS
from rectbench.reporting.curves import RigCurves, ranked_share, rig_curves, shares
from rectbench.reporting.shares import measure
from rectbench.reporting.tables.captions import counted, listed
from rectbench.reporting.tables.numbers import change, shown
from rectbench.reporting.tables.summaries import is_too_wide
from rectbench.runs.run import Run
from rectbench.runs.units import by_rig, floor_of
from rectbench.statistics.bayes import EQUIVALENT, signed_rank
from rectbench.statistics.intervals import Interval, geometric_interval
from rectbench.statistics.ranking import rank

_MOST_NAMES = 4
"""Longer lists of rigs are counted."""
_WHOLE = 100
"""Percent."""
_NONE = 1e-9
"""Distortion and differences up to this are none."""
_LIKELY = 0.9
"""A probability worth a clause."""


def findings(run: Run) -> dict[str, tuple[str, ...]]:
    """By part, who leads, where the two that lead change places, and how far a perspective image is best.

    The last is told of the part with the most rigs alone.
    """
    parts = {part.group: methods_part(part) for part in run.parts}
    widest = max(filter(None, parts.values()), key=lambda part: len(part.rigs), default=None)
    return {
        group: tuple(
            filter(None, [leading(part), turn(part), perspective_limit(part) if part is widest else ""])
        )
        for group, part in parts.items()
        if part
    }


@dataclass(frozen=True)
class _Leaders:
    """The two methods that lead a ranking, and their values by rig."""

    first: str
    second: str
    values: Mapping[str, Mapping[str, float]]
    are_told_apart: bool


def _leaders(part: Part) -> _Leaders | None:
    """None where fewer than two methods are ranked."""
    column = part.catalogue.ranking
    values = by_rig(part.select(pose=part.geometric_pose), column)
    found = rank(values, floor=floor_of(column), unit="rig")
    if len(found.ranks) < 2:
        return None
    first, second = found.order[:2]
    shared = values[first].keys() & values[second].keys()
    own = {m: {rig: value for rig, value in values[m].items() if rig in shared} for m in (first, second)}
    # Whoever is told to be better than the second is the first.
    return _Leaders(first, second, own, found.ranks[second][0] > 1)


def leading(part: Part) -> str:
    """Who leads, by how much on the same rigs, and how surely; empty where nothing is ranked."""
    two = _leaders(part)
    if two is None:
        return ""
    column, share, least = (
        part.catalogue.ranking,
        ranked_share(part.catalogue),
        floor_of(part.catalogue.ranking),
    )
    own, other = two.values[two.first], two.values[two.second]
    ratios = geometric_interval(max(other[rig], least) / max(own[rig], least) for rig in own)
    where = "" if share is None else f" at {share} % of the view"
    who = f"{two.first} and {two.second} are not told apart{where}"
    if two.are_told_apart:
        who = f"{two.first} is ahead of {two.second}{where}"
    more = f"{two.second}'s {measure(column)} is {_more(ratios, two)}"
    return f"{who}: {more}; {_ahead(two, column)}.{_odds(two, column)}"


def _more(ratios: Interval, two: _Leaders) -> str:
    """How much more, and between what, such as 11 % more (interval over rigs: −1 % to +26 %)."""
    more = f"{change(ratios.estimate).lstrip('+')} more" if round(100 * (ratios.estimate - 1)) else "as large"
    if is_too_wide(ratios):
        return f"{more} ({ratios.units} rigs: too few to tell)"
    corrected = not two.are_told_apart and ratios.low > 1
    alone = ", were these two the only methods" if corrected else ""
    return f"{more} (interval over rigs: {change(ratios.low)} to {change(ratios.high)}{alone})"


def _ahead(two: _Leaders, column: Column) -> str:
    """On how many rigs the first one is ahead, and where it is behind."""
    own, other = two.values[two.first], two.values[two.second]
    alike = [rig for rig in own if shown(own[rig], column) == shown(other[rig], column)]
    behind = [rig for rig in own if rig not in alike and own[rig] > other[rig]]
    ahead = len(own) - len(alike) - len(behind)
    told = f"{two.first} is ahead on {ahead} of {len(own)} rigs"
    told += f", behind on {listed(behind)}" if behind else ""
    return told + (f", alike on {listed(alike)}" if alike else "")


def _odds(two: _Leaders, column: Column) -> str:
    """What a signed-rank test makes of methods that the t test does not tell apart; mostly nothing."""
    if two.are_told_apart or len(two.values[two.first]) < LEAST_RIGS:
        return ""
    (belief,) = signed_rank(two.values, floor=floor_of(column), unit="rig")
    odds, likely = max((belief.a_better, two.first), (belief.b_better, two.second))
    if odds < _LIKELY:
        return ""
    return (
        " That is by a t test, which goes by how large the differences of rigs are; by their ranks alone, "
        f"{likely} is better by {100 * EQUIVALENT:g} % or more with probability {min(odds, 0.99):.2f}."
    )


def turn(part: Part) -> str:
    """Up to which view the second of the ranking has less than the first; empty where it nowhere has."""
    two = _leaders(part)
    if two is None:
        return ""
    rigs, views, throughout = 0, [], []
    for one in rig_curves(part):
        inner, outer = (_least(one, [method]) for method in (two.second, two.first))
        if not inner or not outer:
            continue
        rigs += 1
        share = _crossing(one, inner, outer, [two.second])
        view = one.view_deg(share) if share else None
        if share == _WHOLE:
            throughout.append(one.rig)
        elif view is not None:
            views.append(view)
    if not views:
        return ""
    median_of = " (median)" if len(views) > 1 else ""
    always = f", on {listed(throughout)} in the whole view" if throughout else ""
    less = f"{two.second} has less {measure(part.catalogue.ranking)} than {two.first}"
    return (
        f"In the inner part of the view {less}: on {len(views)} of {counted(rigs, 'rig')} up to "
        f"{median(views):.0f}° across{median_of}{always}."
    )


def reversals(values: Mapping[str, Mapping[str, float]], column: Column) -> Iterator[str]:
    """A sentence for each two methods of which each is ahead on some rig.

    `values` are by method and rig, the methods in their order; what reads the same is a tie.
    """
    for one, other in combinations(values, 2):
        rigs = [rig for rig in values[one] if rig in values[other]]
        alike = [rig for rig in rigs if shown(values[one][rig], column) == shown(values[other][rig], column)]
        differing = [rig for rig in rigs if rig not in alike]
        ahead = [r for r in differing if (values[one][r] < values[other][r]) == (column.better == "lower")]
        behind = [rig for rig in differing if rig not in ahead]
        first, second = (one, other) if len(ahead) >= len(behind) else (other, one)
        wins, losses = sorted((ahead, behind), key=len, reverse=True)
        if losses:
            ties = f", alike on {listed(alike)}" if alike else ""
            won = f"{first} is ahead of {second} on {len(wins)} of {len(rigs)} rigs"
            yield f"{won}, behind on {listed(losses)}{ties}."


@dataclass(frozen=True)
class _Limit:
    """Up to which share (%) and view a perspective image is the best on a rig: share 0 if it never is.

    `then` is what is best beyond: at the end of the view, or from its middle on where share is 0.
    """

    share: float
    view_deg: float
    then: str


def perspective_limit(part: Part) -> str:
    """Up to which view a perspective image has the least log distortion; empty if nothing tells.

    Of each rig it is where the best perspective method's curve crosses that of the best other one, or where
    no perspective image shows more.
    """
    perspective = _perspective_methods(part)
    others = tuple(m for m in part.methods if m not in perspective)
    limits = {one.rig: _limit(one, perspective, others) for one in rig_curves(part)}
    least = min(shares(part.catalogue), default=0)
    found = {rig: limit for rig, limit in limits.items() if limit}
    text = _limit_text(found, least)
    lacking = len(part.rigs) - len(found)
    if text and lacking:
        text += f" On {lacking} of {len(part.rigs)} rigs no perspective image was to be had."
    return text


def _limit(one: RigCurves, perspective: Sequence[str], others: Sequence[str]) -> _Limit | None:
    best, rival = (_least(one, methods) for methods in (perspective, others))
    if not best or not rival:
        return None
    share = _crossing(one, best, rival, perspective)
    if share == 0:
        return _Limit(0, 0, rival[min(rival)][1])
    view = one.view_deg(share)
    return None if view is None else _Limit(share, view, rival[max(rival)][1])


def _perspective_methods(part: Part) -> tuple[str, ...]:
    told: dict[str, set[object]] = {}
    for r in part.results:
        if r.ok:
            told.setdefault(r.method, set()).add(r.notes.get(PROJECTION))
    return tuple(method for method, projections in told.items() if projections == {PERSPECTIVE})


def _least(one: RigCurves, methods: Sequence[str]) -> dict[int, tuple[float, str]]:
    """By share, the least value of these methods and whose it is."""
    points = [(share, value, m) for m in methods for share, value in one.curves.get(m, {}).items()]
    return {
        share: min((v, m) for s, v, m in points if s == share) for share in sorted({s for s, _, _ in points})
    }


def _crossing(
    one: RigCurves,
    best: Mapping[int, tuple[float, str]],
    rival: Mapping[int, tuple[float, str]],
    perspective: Sequence[str],
) -> float:
    """The share (%) up to which `best` is below `rival`: 0 if it never is, the last one if always."""
    leads = {share: _lead(best[share][0], rival[share][0]) for share in rival if share in best}
    ends = sorted(rival)
    if not leads or min(leads) != ends[0] or leads[ends[0]] <= 0:
        return 0.0
    for share, following in pairwise(ends):
        if following not in leads:
            kept = max(one.kept.get(m, share) for m in perspective)
            return min(max(kept, share), following)
        if leads[following] <= 0:
            return share + (following - share) * leads[share] / (leads[share] - leads[following])
    return ends[-1]


def _lead(value: float, against: float) -> float:
    """How far a value is below another one, as a logarithm; 0 where rounding alone tells them apart."""
    lead = math.log(max(against, _NONE) / max(value, _NONE))
    return lead if abs(lead) > _NONE else 0.0


def _limit_text(limits: Mapping[str, _Limit], least: int) -> str:
    """A sentence for each kind of rig, the larger groups first; `least` is the smallest share (%)."""
    never = {rig: one for rig, one in limits.items() if one.share == 0}
    always = {rig: one for rig, one in limits.items() if one.share == _WHOLE}
    crossing = {rig: one for rig, one in limits.items() if rig not in (*never, *always)}
    best = "a perspective image has the least log distortion"
    cases = [
        (
            never,
            f"{_winners(never)} has less log distortion than any perspective image, even on the inmost "
            f"{least} % of the view",
        ),
        (always, f"{best} in the whole view"),
        (crossing, f"{best} {_views(crossing)}, {_winners(crossing)} beyond"),
    ]
    told = sorted((case for case in cases if case[0]), key=lambda case: -len(case[0]))
    return " ".join(f"On {_which(list(rigs), len(limits))} {text}." for rigs, text in told)


def _views(limits: Mapping[str, _Limit]) -> str:
    views = [one.view_deg for one in limits.values()]
    if not views:
        return ""
    low, high = f"{min(views):.0f}°", f"{max(views):.0f}°"
    up_to = low if low == high else f"{low} to {high}"
    middle = "" if low == high else f" (median {median(views):.0f}°)"
    return f"up to {up_to} across{middle}"


def _winners(limits: Mapping[str, _Limit]) -> str:
    return " or ".join(method for method, _ in Counter(one.then for one in limits.values()).most_common())


def _which(rigs: Sequence[str], total: int) -> str:
    """Which of the rigs; long lists are counted."""
    if len(rigs) == total and total > 1:
        return "both rigs" if total == 2 else f"all {total} rigs"
    return listed(rigs) if len(rigs) <= _MOST_NAMES else f"{len(rigs)} of {total} rigs"
