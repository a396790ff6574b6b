"""What a part of a run tells in a sentence: where an order is reversed, where a perspective image ends."""

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
from rectbench.reporting.curves import RigCurves, rig_curves
from rectbench.reporting.tables.captions import listed
from rectbench.reporting.tables.numbers import shown

_MOST_NAMES = 4
"""Longer lists of rigs are counted."""
_WHOLE = 100
"""Percent."""
_NONE = 1e-9
"""Distortion and differences up to this are none."""


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
    return _limit_text({rig: limit for rig, limit in limits.items() if limit})


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


def _limit_text(limits: Mapping[str, _Limit]) -> str:
    """All rigs in a sentence, the larger groups of them first."""
    never = {rig: one for rig, one in limits.items() if one.share == 0}
    always = {rig: one for rig, one in limits.items() if one.share == _WHOLE}
    crossing = {rig: one for rig, one in limits.items() if rig not in (*never, *always)}
    cases = [
        (never, "in no view", f", {_winners(never)} having less from the middle on"),
        (always, "in the whole view", ""),
        (
            crossing,
            _views(crossing),
            f", {_winners(crossing)} having less in wider ones",
        ),
    ]
    cases = sorted((case for case in cases if case[0]), key=lambda case: -len(case[0]))
    told = [f"{views}{_where(list(rigs), len(limits))}{then}" for rigs, views, then in cases]
    start = "A perspective image has less log distortion than any other method "
    return f"{start}{'; '.join(told)}." if told else ""


def _views(limits: Mapping[str, _Limit]) -> str:
    views = [one.view_deg for one in limits.values()]
    if not views:
        return ""
    low, high = f"{min(views):.0f}°", f"{max(views):.0f}°"
    up_to = low if low == high else f"{low} to {high}"
    middle = "" if low == high else f" (median {median(views):.0f}°)"
    return f"in views of up to {up_to} across{middle}"


def _winners(limits: Mapping[str, _Limit]) -> str:
    return " or ".join(method for method, _ in Counter(one.then for one in limits.values()).most_common())


def _where(rigs: Sequence[str], total: int) -> str:
    """On which of the rigs; long lists are counted."""
    if len(rigs) == total:
        return "" if total == 1 else f" on {'both' if total == 2 else f'all {total}'} rigs"
    return f" on {listed(rigs)}" if len(rigs) <= _MOST_NAMES else f" on {len(rigs)} of {total} rigs"
