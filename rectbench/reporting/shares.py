"""Columns of a share of the view, and those of all that each method itself shows: how they are told apart."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from rectbench.plugins.metric import Column

_SHARE = re.compile(r", (\d+) %(?: of the view)?")
_OWN_VIEW = re.compile(r"(log_)?distortion|row_error|sampling")


def share_of(column: Column) -> int | None:
    """The share (%) of the view that a column is of; None where it is of none.

    >>> share_of(Column("log_distortion_95", "log distortion, 95 %")), share_of(Column("fit_s", "fit"))
    (95, None)
    """
    found = _SHARE.search(column.heading)
    return int(found[1]) if found and re.search(rf"_{found[1]}(_|$)", column.key) else None


def measure(column: Column) -> str:
    """What is measured, without what of the view it is over.

    >>> measure(Column("log_distortion_95", "log distortion, 95 %"))
    'log distortion'
    """
    return column.heading.partition(",")[0]


def is_of_own_view(column: Column) -> bool:
    """Whether a number is over what each method itself shows, so that it may be low for showing little.

    >>> is_of_own_view(Column("distortion_native", "distortion, native"))
    True
    >>> is_of_own_view(Column("log_distortion_95", "log distortion, 95 %"))
    False
    """
    return share_of(column) is None and _OWN_VIEW.match(column.key) is not None


def reads(column: Column) -> str:
    """The heading, with what a share is of: as it stands it may be taken for a percentile's or interval's.

    >>> reads(Column("row_error_95_mean_px", "row error, 95 %", "px")), reads(Column("fit_s", "fit", "ms"))
    ('row error, 95\\xa0% of view', 'fit')
    """
    return column.heading if share_of(column) is None else re.sub(r" %$", "\u00a0% of view", column.heading)


@dataclass(frozen=True)
class Explained:
    """A column of the glossary, or several that differ in their share of the view alone.

    Parameters
    ----------
    column : the first of them, with what they share as its heading and meaning.
    keys : their names in the rows, as a reader can expand them.
    """

    column: Column
    keys: str


def explained(columns: Iterable[Column]) -> list[Explained]:
    """Entries of a glossary, columns of one thing on several shares of the view folded into one."""
    groups: dict[str, list[Column]] = {}
    for column in columns:
        groups.setdefault(_stem(column), []).append(column)
    return [_entry(group) for group in groups.values()]


def _stem(column: Column) -> str:
    share = share_of(column)
    return column.key if share is None else re.sub(rf"_{share}(?=_|$)", "_N", column.key, count=1)


def _entry(group: list[Column]) -> Explained:
    shares = [str(share) for column in group if (share := share_of(column)) is not None]
    first = group[0]
    if len(group) < 2:
        return Explained(replace(first, heading=reads(first)), first.key)
    ranks = [f" Methods are ranked by it at {share_of(column)} %." for column in group if column.ranks]
    folded = replace(
        first,
        heading=re.sub(rf"\b{shares[0]} %( of the view)?", "N % of view", first.heading),
        meaning=re.sub(rf"\b{shares[0]} %", "N %", first.meaning) + "".join(ranks),
    )
    return Explained(folded, f"{_stem(first)}, N = {', '.join(shares)}")
