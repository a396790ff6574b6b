"""Why a method has no number to be ranked by: it shows too little of the view, or its rows are off."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.curves import KEPT
from rectbench.reporting.tables.captions import counted
from rectbench.reporting.tables.numbers import MISSING, two_digits

MISFIT, MISFIT_LIMIT_PX = "row_misfit_px", 2.0
"""The column of how far a map puts rows off, and beyond what it is no rectification."""
ROWS_OFF, KEEPS = "rows off by", "keeps"


def is_misfit(result: Result) -> bool:
    """Whether the map is no rectification of the pair."""
    return result.metrics.get(MISFIT, 0.0) > MISFIT_LIMIT_PX


def lacking(results: Sequence[Result], column: Column) -> str:
    """Why a method has no number of a column on all of these pairs, and on how many where it has some.

    "rows off by 3.4 px" is the worst of them, "keeps 43 % on 2 of 12" the mean of the two, in whole percent
    downwards. Empty where every pair has a number, a dash where nothing is known of those without.
    """
    without = [r for r in results if column.key not in r.metrics]
    if not without:
        return ""
    crooked = [r for r in without if is_misfit(r)]
    kept = [r for r in without if r.metrics.get(KEPT, 1.0) < 1]
    failed = [r for r in without if not r.ok]
    if crooked:
        said, about = f"{ROWS_OFF} {two_digits(max(r.metrics[MISFIT] for r in crooked))} px", crooked
    elif kept:
        share = math.fsum(r.metrics[KEPT] for r in kept) / len(kept)
        said, about = f"{KEEPS} {math.floor(100 * share + 1e-6)} %", kept
    elif failed:
        return f"{counted(len(failed), 'cell')} failed"
    else:
        return MISSING
    return said if len(about) == len(results) else f"{said} on {len(about)} of {len(results)}"
