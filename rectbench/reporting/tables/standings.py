"""Where methods stand: their order, their ranks as far as the rigs tell, and what is to be said of both."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rectbench.metrics.row_misfit import LARGEST_BEND_PX
from rectbench.plugins.catalogue import Catalogue
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.curves import KEPT, ranked_by, ranked_share
from rectbench.reporting.tables.captions import capitalised, listed
from rectbench.reporting.tables.numbers import MISSING, two_digits
from rectbench.reporting.tables.summaries import Summary, averaged
from rectbench.runs.units import by_rig, floor_of
from rectbench.statistics.ranking import Ranking, rank, signed_rank_caveat

_KEPT = Column(KEPT, "view kept")
RECTIFIES, BENT, MISFIT = "rectifies", "row_bend_px", "row_misfit"
"""The columns of whether a map is a rectification, and of how far it puts rows off."""
ROWS, KEEPS = "rows", "keeps"
_TWICE = 2.0
"""Ratios up to this are told as a difference in percent, larger ones as a factor."""


@dataclass(frozen=True)
class Standing:
    """The methods of a table, best first.

    Parameters
    ----------
    summaries : in their order: by the ranking column, behind them those without a number on every pair, the
        fewer failures and the more of the view they keep the nearer.
    ranks : the first and the last place of each method; empty where nothing is told.
    design : what these rigs can tell apart, a sentence.
    order : by what the methods stand in their order, a sentence.
    behind : why each of the methods without a number on every pair has none, such as "keeps 43 %".
    values : of the others, by method and rig.
    caveat : what the rigs are too few for; empty where they are not.
    """

    summaries: tuple[Summary, ...]
    ranks: Mapping[str, tuple[int, int]]
    design: str
    order: str
    behind: Mapping[str, str]
    values: Mapping[str, Mapping[str, float]]
    caveat: str


def standing(summaries: Sequence[Summary], results: Sequence[Result], catalogue: Catalogue) -> Standing:
    """Of the methods that are summarised, by the ranking column of their results."""
    column = catalogue.ranking
    values = by_rig(results, column)
    found = rank(values, floor=floor_of(column), unit="rig")
    rigs = {rig for numbers in values.values() for rig in numbers}
    behind = set(found.behind)
    own = {method: [r for r in results if r.method == method] for method in values}

    def nearness(summary: Summary) -> tuple[bool, int, int, int, float, str]:
        method = summary.method
        if method not in behind:
            return False, found.order.index(method), 0, 0, 0.0, method
        kept = averaged(_KEPT, own[method]).value or 0.0
        return True, sum(map(is_misfit, own[method])), summary.failed, -len(values[method]), -kept, method

    ordered = tuple(sorted(summaries, key=nearness))
    is_of_view = bool(rigs) or any(KEPT in r.metrics for r in results)
    return Standing(
        summaries=ordered,
        ranks=found.ranks,
        design=_design_text(found) if rigs else "",
        order=_order_text(found, catalogue) if len(behind) < len(ordered) else "",
        behind={
            s.method: lacking(own[s.method], column) for s in ordered if is_of_view and s.method in behind
        },
        values={s.method: values[s.method] for s in ordered if s.method not in behind},
        caveat=f"{caveat}." if (caveat := signed_rank_caveat(found.units, "rig")) and found.ranks else "",
    )


def _design_text(found: Ranking) -> str:
    if found.reason:
        return f"{capitalised(found.reason)}."
    if found.resolves is None:
        return ""
    rigs = f"{found.units} rigs"
    if found.units < found.of:
        rigs = f"{found.units} of {found.of} rigs, which all ranked methods serve,"
    return (
        f"{_ratio_text(found.resolves)} between two methods shows on {rigs} with 80 % power; where no "
        "difference shows, methods share their places, such as 1–2."
    )


def _ratio_text(ratio: float) -> str:
    if not math.isfinite(ratio):
        return "No difference"
    if ratio < _TWICE:
        return f"A difference of {two_digits(100 * (ratio - 1))} %"
    return f"A factor of {two_digits(ratio)}"


def _order_text(found: Ranking, catalogue: Catalogue) -> str:
    return f"{'Ranked by' if found.ranks else 'In the order of'} {ranked_by(catalogue)}."


def behind_text(found: Standing, catalogue: Catalogue) -> str:
    """Why methods stand below the others without a rank; empty where none does."""
    share = ranked_share(catalogue)
    if not found.behind:
        return ""
    if share is None:
        return (
            f"Without {catalogue.ranking.heading} on every pair, and so without a rank: "
            f"{listed(list(found.behind))}."
        )
    crooked = [method for method, why in found.behind.items() if why.startswith(ROWS)]
    short = [method for method in found.behind if method not in crooked]
    told = []
    if short:
        told.append(
            f"Without a rank, as less than {share} % of the view is shown on some pair, or nothing: "
            f"{listed(short)}. What shows more of it stands nearer to the ranked ones."
        )
    if crooked:
        told.append(
            f"Not ranked, for their rows are no epipolar planes of the rig, which is no rectification: "
            f"{listed(crooked)}."
        )
    return " ".join(told)


def is_misfit(result: Result) -> bool:
    """Whether the map is no rectification of the pair."""
    return result.metrics.get(RECTIFIES, 1.0) < 1


def _rows_off(results: Sequence[Result]) -> str:
    """The worst of them: rows that are bent, in pixels, or that do not meet, in percent of the width."""
    bent_px, misfit = (max(r.metrics.get(key, 0.0) for r in results) for key in (BENT, MISFIT))
    if bent_px > LARGEST_BEND_PX:
        return f"{ROWS} bent by {two_digits(bent_px)} px"
    return f"{ROWS} {two_digits(100 * misfit)} % apart"


def lacking(results: Sequence[Result], column: Column) -> str:
    """Why a method has no number of a column on all of these pairs, and on how many where it has some.

    "rows bent by 3.4 px" is the worst of them, "keeps 43 % on 2 of 12" the mean of the two, in whole percent
    downwards, "unsupported" how most of them ended. Empty where every pair has a number, a dash where
    nothing is known of those without.
    """
    without = [r for r in results if column.key not in r.metrics]
    if not without:
        return ""
    crooked = [r for r in without if is_misfit(r)]
    kept = [r for r in without if r.metrics.get(KEPT, 1.0) < 1]
    failed = [r.status for r in without if not r.ok]
    if crooked:
        said, count = _rows_off(crooked), len(crooked)
    elif len(failed) > len(kept):
        said, count = max(failed, key=failed.count), len(failed)
    elif kept:
        share = math.fsum(r.metrics[KEPT] for r in kept) / len(kept)
        said, count = f"{KEEPS}\u00a0{math.floor(100 * share + 1e-6)}\u00a0%", len(kept)
    else:
        return MISSING
    return said if count == len(results) else f"{said} on {count} of {len(results)}"
