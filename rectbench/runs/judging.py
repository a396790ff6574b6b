"""What the rows of a run say about the claims of its report.

What is judged is the 95 % bootstrap interval of the measured value over pairs, and over the seeds of
each: wholly within the bounds the statement is held, wholly outside not held; anything else depends. A
cell that failed keeps a statement from being held. Statements of one clause measure the same thing in
several ways: where these disagree, the clause depends. A claim is held where each of its clauses is, and
not held where one of them is not.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from rectbench.experiments.claims import Claim, Statement, Verdict
from rectbench.plugins.result import Result
from rectbench.runs.bootstrap import Statistic, interval, stacked
from rectbench.types import FloatArray

CLAIM_RESAMPLES = 4000

Place = tuple[str, str, str, str, int]
"""Scene, rig, motion, pose, seed."""


@dataclass(frozen=True)
class Measured:
    """What the rows say about one statement."""

    statement: Statement
    mean: float
    low: float
    high: float
    """The 95 % bootstrap interval."""
    verdict: Verdict
    pairs_held: int
    """On how many pairs the mean over seeds is within the bounds."""
    pairs: int
    cells: int
    """How many cells, or paired cells, it stands on."""
    failed: int
    """How many more it should stand on."""


@dataclass(frozen=True)
class Judged:
    """A claim and its verdict."""

    claim: Claim
    verdict: Verdict
    tests: tuple[Measured, ...]

    @property
    def because(self) -> str:
        """Why it is so, as the claim states for this verdict."""
        return self.claim.because.get(self.verdict, "")


def judged_claims(
    claims: Iterable[Claim], rows: Sequence[Result], columns: Collection[str]
) -> tuple[Judged, ...]:
    """Judge claims by the rows of a run, whose table has the `columns`."""
    return tuple(_judged(claim, rows, columns) for claim in claims)


def _judged(claim: Claim, rows: Sequence[Result], columns: Collection[str]) -> Judged:
    # A column that nobody asked for is no failure.
    tests = tuple(_measured(s, rows if s.metric in columns else ()) for s in claim.statements)
    clauses: dict[str, set[Verdict]] = {}
    for statement, test in zip(claim.statements, tests, strict=True):
        clauses.setdefault(statement.clause, set()).add(test.verdict)
    verdicts = {verdicts.pop() if len(verdicts) == 1 else "depends" for verdicts in clauses.values()}
    verdict: Verdict = "depends"
    if len(verdicts) == 1:
        (verdict,) = verdicts
    elif "not held" in verdicts:
        verdict = "not held"
    return Judged(claim, verdict, tests)


def _measured(statement: Statement, rows: Sequence[Result]) -> Measured:
    by_pair, failed = _numbers(statement, rows)
    cells = sum(map(len, by_pair))
    mean = low = high = math.nan
    verdict: Verdict = "not measured"
    if len(by_pair) >= _pairs_needed(statement):
        mean = float(_statistic(statement)(stacked(by_pair)))
        low, high = interval(by_pair, _statistic(statement), CLAIM_RESAMPLES) if cells > 1 else (mean, mean)
        verdict = _verdict(statement, low, high, failed)
    if cells == 1:  # one number has no interval
        low = high = math.nan
    held = _pairs_held(statement, by_pair)
    return Measured(statement, mean, low, high, verdict, held, len(by_pair), cells, failed)


def _pairs_needed(statement: Statement) -> float:
    """Of how many pairs a statement speaks at least; a run of fewer does not measure it."""
    return max(1.0, statement.above or 0.0) if statement.measure == "wins" else 1.0


def _numbers(statement: Statement, rows: Sequence[Result]) -> tuple[list[FloatArray], int]:
    """The numbers [cells, columns] a statement stands on, one array a pair, and how many cells have none."""
    others = _others(statement, rows)
    found: dict[tuple[str, ...], list[list[float]]] = {}
    failed = 0
    for row in rows:
        if not _speaks_of(row, statement):
            continue
        numbers = _numbers_of(row, others.get(_place(row), []), statement)
        if all(map(math.isfinite, numbers)):
            found.setdefault(_place(row)[:4], []).append(numbers)
        else:
            failed += 1
    return [np.array(numbers) for numbers in found.values()], failed


def _numbers_of(row: Result, others: Sequence[Result], statement: Statement) -> list[float]:
    own, rivals = _value(row, statement.metric), [_value(other, statement.metric) for other in others]
    if statement.measure == "value":
        return [own]
    if statement.measure == "wins":
        return [own, *(rivals if len(rivals) == len(statement.rivals) else [math.nan])]
    ratio = own / rivals[0] if len(rivals) == 1 and rivals[0] else math.nan
    if statement.measure == "share" and math.isfinite(ratio):
        low, high = statement.within or statement.bounds
        return [float(low <= ratio <= high)]
    return [ratio]


def _speaks_of(row: Result, statement: Statement) -> bool:
    return (
        row.cell.method == statement.method
        and row.group == statement.group
        and statement.options.items() <= row.options.items()
    )


def _others(statement: Statement, rows: Sequence[Result]) -> dict[Place, list[Result]]:
    """The rows to compare with, by place: those of `against`, or of the rivals."""
    wanted = statement.speaks_of[1:]
    if statement.measure == "wins":  # no method is its own rival
        wanted = [(group, method) for group, method in wanted if method != statement.method]
    found: dict[Place, list[Result]] = {}
    for row in rows:
        if (row.group, row.cell.method) in wanted:
            found.setdefault(_place(row), []).append(row)
    return found


def _place(row: Result) -> Place:
    """Where methods are compared: the pair, and the seed."""
    return row.scene, row.rig, row.motion, row.pose, row.seed


def _value(row: Result, metric: str) -> float:
    return row.metrics.get(metric, math.nan) if row.ok else math.nan


def _mean(numbers: FloatArray) -> FloatArray:
    """The mean over pairs of the mean over the cells of each."""
    mean: FloatArray = np.nanmean(numbers[..., 0], axis=-1).mean(axis=-1)
    return mean


def _geometric_mean(numbers: FloatArray) -> FloatArray:
    mean: FloatArray = np.exp(_mean(np.log(numbers)))
    return mean


def _wins(numbers: FloatArray) -> FloatArray:
    """On how many pairs the first column has the least mean."""
    won = np.nanmean(numbers, axis=-2).argmin(axis=-1) == 0
    count: FloatArray = won.sum(axis=-1, dtype=np.float64)
    return count


def _statistic(statement: Statement) -> Statistic:
    return {"value": _mean, "ratio": _geometric_mean, "share": _mean, "wins": _wins}[statement.measure]


def _verdict(statement: Statement, low: float, high: float, failed: int) -> Verdict:
    least, most = statement.bounds
    if high < least or low > most:
        return "not held"
    return "held" if least <= low and high <= most and not failed else "depends"


def _pairs_held(statement: Statement, by_pair: Sequence[FloatArray]) -> int:
    each = [float(_statistic(statement)(numbers[None])) for numbers in by_pair]
    if statement.measure == "wins":
        return round(sum(each))
    least, most = statement.bounds
    return sum(least <= value <= most for value in each)
