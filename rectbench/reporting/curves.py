"""Distortion as a function of the view: what each method has on growing shares of it, rig by rig."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rectbench.plugins.catalogue import Catalogue
from rectbench.plugins.result import Part, Result
from rectbench.reporting.tables.summaries import averaged

KEPT = "view_kept"
"""The column of the largest share of the view that a method shows all of."""
FLOOR = "floor_log_distortion"
"""The column of the least that rectifications to scan lines can have where methods are ranked."""


@dataclass(frozen=True)
class RigCurves:
    """The curves of all methods on one rig.

    Parameters
    ----------
    rig : its name.
    views_deg : horizontal field of view of a share (%) of the view, average over motions; empty where it
        was not measured.
    curves : by method, log distortion by share (%), ascending; it ends where the method keeps no more on
        some pair.
    kept : by method, the largest share (%) that it keeps on every pair of the rig, where measured.
    floor : the least log distortion that scan lines can have where methods are ranked, where measured.
    """

    rig: str
    views_deg: Mapping[int, float]
    curves: Mapping[str, Mapping[int, float]]
    kept: Mapping[str, float]
    floor: float | None = None

    def view_deg(self, share: float) -> float | None:
        """The view of a share between two measured ones, linear between them; None outside of them."""
        below = max((s for s in self.views_deg if s <= share), default=None)
        above = min((s for s in self.views_deg if s >= share), default=None)
        if below is None or above is None:
            return None
        part = (share - below) / (above - below) if above > below else 0.0
        return self.views_deg[below] + part * (self.views_deg[above] - self.views_deg[below])


def ranking_stem(catalogue: Catalogue) -> str:
    """What the columns of the ranking measure begin with.

    >>> from rectbench.plugins.catalogue import known
    >>> ranking_stem(known())
    'log_distortion'
    """
    return re.sub(r"_\d+$", "", catalogue.ranking.key)


def shares(catalogue: Catalogue) -> dict[int, str]:
    """The columns of the ranking measure on a share of the view, by that share (%), ascending.

    >>> from rectbench.plugins.catalogue import known
    >>> shares(known())[95]
    'log_distortion_95'
    """
    stem = ranking_stem(catalogue)
    found = {
        int(match[1]): column.key
        for column in catalogue.columns
        if (match := re.fullmatch(rf"{re.escape(stem)}_(\d+)", column.key))
    }
    return dict(sorted(found.items()))


def ranked_share(catalogue: Catalogue) -> int | None:
    """The share (%) of the view that methods are ranked at; None where the ranking column is of no share.

    >>> from rectbench.plugins.catalogue import known
    >>> ranked_share(known())
    95
    """
    key = catalogue.ranking.key
    return next((share for share, name in shares(catalogue).items() if name == key), None)


def ranked_by(catalogue: Catalogue) -> str:
    """What methods are ranked by, in words.

    >>> from rectbench.plugins.catalogue import known
    >>> ranked_by(known())
    'log distortion at 95 % of the view'
    """
    share, heading = ranked_share(catalogue), catalogue.ranking.heading
    return heading if share is None else f"{heading.partition(',')[0]} at {share} % of the view"


def view_key(share: int | None) -> str:
    """The column of the field of view that a share (%) of the source pixels lies in."""
    return f"view_{share}_deg"


def rig_curves(part: Part) -> tuple[RigCurves, ...]:
    """Of each rig under the pose under which distortion is shown; rigs without any curve are left out."""
    exact, columns = part.select(pose=part.geometric_pose), shares(part.catalogue)
    found = (_of_rig(part, rig, part.select(exact, rig=rig), columns) for rig in part.rigs)
    return tuple(one for one in found if any(one.curves.values()))


def _of_rig(part: Part, rig: str, results: Sequence[Result], columns: Mapping[int, str]) -> RigCurves:
    by_method = {m: own for m in part.methods if (own := part.select(results, method=m))}
    views = {share: averaged(part.catalogue.column(view_key(share)), results).value for share in columns}
    kept = {m: [r.metrics[KEPT] for r in own if KEPT in r.metrics] for m, own in by_method.items()}
    return RigCurves(
        rig,
        {share: view for share, view in views.items() if view is not None},
        {m: _curve(part, own, columns) for m, own in by_method.items()},
        {m: 100 * min(of_pairs) for m, of_pairs in kept.items() if of_pairs},
        averaged(part.catalogue.column(FLOOR), results).value,
    )


def _curve(part: Part, results: Sequence[Result], columns: Mapping[int, str]) -> dict[int, float]:
    """A point where every pair has one: the mean over others would be of other pairs."""
    points = {share: averaged(part.catalogue.column(key), results) for share, key in columns.items()}
    return {
        share: point.value
        for share, point in points.items()
        if point.value is not None and point.count == len(results)
    }
