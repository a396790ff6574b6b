"""What the rows of a run say about the claims of its report.

The unit is the rig: what was measured on one, over its motions, scenes and seeds, is one value of it. What is
judged is the 95 % t interval of the mean over rigs (of logarithms, for a ratio): wholly within the bounds the
statement is held, wholly outside not held, else undecided, as it is on fewer than three rigs. A count is held
where as large a share of the rigs as claimed is reached, and not held where an exact binomial test refutes
that share. A cell that failed keeps a statement from being held.

Statements of one clause measure the same thing in several ways: it is held where all of them are, depends
where some are and some are not, and is not held where some are not and none is. A claim is held where each of
its clauses is, and not held where one of them is not.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from rectbench.errors import InvalidInput
from rectbench.experiments.claims import Claim, Statement, Verdict
from rectbench.plugins.result import Result
from rectbench.runs.units import place_of
from rectbench.statistics.intervals import (
    ALPHA,
    Interval,
    count_interval,
    counted,
    geometric_interval,
    mean_interval,
    nested_means,
)
from rectbench.statistics.paired import TIE

_Numbers = dict[tuple[Hashable, ...], float]
"""The number of each cell by its place, its pose and the method's options."""


@dataclass(frozen=True)
class Measured:
    """What the rows say about one statement."""

    statement: Statement
    interval: Interval
    """The mean over rigs with its 95 % interval; of a count, the share of the rigs."""
    verdict: Verdict
    by_rig: Mapping[str, float] = field(default_factory=dict)
    """The value of each rig; of a count, own value over the least of the rivals'."""
    rigs_held: int = 0
    """On how many rigs the value is as expected."""
    failed: int = 0
    """Cells that hold no measurement."""
    absent: tuple[str, ...] = ()
    """Rigs without a value: a method does not serve them, or its images do not show that much."""
    remark: str = ""
    """Why it is undecided, and how probable a count is."""


@dataclass(frozen=True)
class Judged:
    """A claim and its verdict."""

    claim: Claim
    verdict: Verdict
    clauses: Mapping[str, Verdict]
    tests: tuple[Measured, ...]

    @property
    def because(self) -> str:
        """Why it is so, as the claim states for this verdict; else what the measurements lack."""
        if self.verdict in self.claim.because:
            return self.claim.because[self.verdict]
        undecided = [t for t in self.tests if t.statement.judges and t.verdict == "undecided"]
        return "; ".join(dict.fromkeys(t.remark for t in undecided if t.remark))


def judged_claims(
    claims: Iterable[Claim], rows: Sequence[Result], columns: Collection[str]
) -> tuple[Judged, ...]:
    """Judge claims by the rows of a run, whose table has the `columns`."""
    return tuple(_judged(claim, rows, columns) for claim in claims)


def _judged(claim: Claim, rows: Sequence[Result], columns: Collection[str]) -> Judged:
    # A column that nobody asked for is no failure.
    tests = tuple(_measured(s, rows if s.metric in columns else ()) for s in claim.statements)
    ways: dict[str, list[Verdict]] = {}
    for test in tests:
        if test.statement.judges:
            ways.setdefault(test.statement.clause, []).append(test.verdict)
    clauses = {clause: _of_ways(verdicts) for clause, verdicts in ways.items()}
    return Judged(claim, _of_clauses(list(clauses.values())), clauses, tests)


def _of_ways(verdicts: Collection[Verdict]) -> Verdict:
    """Of ways to measure one thing: refuted where it is by some and held by none."""
    if len(set(verdicts)) == 1:
        return next(iter(verdicts))
    if "not held" in verdicts:
        return "depends" if "held" in verdicts else "not held"
    return "undecided"


def _of_clauses(verdicts: Collection[Verdict]) -> Verdict:
    """Of sentences that all have to be true."""
    if len(set(verdicts)) == 1:
        return next(iter(verdicts))
    decided: tuple[Verdict, ...] = ("not held", "depends")
    return next((verdict for verdict in decided if verdict in verdicts), "undecided")


def _measured(statement: Statement, rows: Sequence[Result]) -> Measured:
    own = _rows_of(rows, statement.group, statement.method, statement.options)
    if statement.measure == "value":
        found = _alone(statement, own)
    elif statement.measure == "count":
        found = _against_each(statement, own, _rivals(statement, rows))
    else:
        group, method = statement.speaks_of[1]
        found = _against(statement, own, _rows_of(rows, group, method, statement.against_options))
    if not found.by_rig:
        verdict: Verdict = "undecided" if found.failed or found.absent else "not measured"
        remark = "no rig has a value" if verdict == "undecided" else ""
        return Measured(statement, _NOTHING, verdict, failed=found.failed, absent=found.absent, remark=remark)
    judge = _counted if statement.measure == "count" else _averaged
    interval, rigs_held, verdict, remark = judge(statement, found.by_rig)
    if verdict == "held" and found.failed:
        verdict, remark = "undecided", f"cells that failed: {found.failed}"
    return Measured(statement, interval, verdict, found.by_rig, rigs_held, found.failed, found.absent, remark)


_NOTHING = Interval(math.nan, math.nan, math.nan, 0)
_Judgement = tuple[Interval, int, Verdict, str]


def _averaged(statement: Statement, by_rig: Mapping[str, float]) -> _Judgement:
    over_rigs = geometric_interval if statement.measure == "ratio" else mean_interval
    interval = over_rigs(by_rig.values())
    least, most = statement.bounds
    held = sum(least <= value <= most for value in by_rig.values())
    if math.isnan(interval.low):
        return interval, held, "undecided", f"{counted(len(by_rig), 'rig')}: too few for an interval"
    if interval.high < least or interval.low > most:
        return interval, held, "not held", ""
    if least <= interval.low and interval.high <= most:
        return interval, held, "held", ""
    return interval, held, "undecided", f"{counted(len(by_rig), 'rig')}: the interval reaches beyond a bound"


def _counted(statement: Statement, by_rig: Mapping[str, float]) -> _Judgement:
    """Of a count: `by_rig` holds the largest ratio to a rival, below 1 where the method is least."""
    from scipy.stats import binom

    rigs, least = len(by_rig), sum(ratio < 1 - TIE for ratio in by_rig.values())
    claimed, needed = statement.bounds[0], statement.of or 1
    by_chance = float(binom.sf(least - 1, rigs, 1 / (1 + len(statement.rivals))))
    as_few = float(binom.cdf(least, rigs, claimed))
    verdict: Verdict = "undecided"
    remark = f"as few if the claim were true: p = {as_few:.2g}"
    if claimed == 1:
        remark = f"claimed of all, not so on {rigs - least}"
    if as_few < ALPHA:
        verdict = "not held"
    elif rigs < needed:
        remark = f"{counted(rigs, 'rig')} of the {needed} that it speaks of"
    elif least / rigs >= claimed:
        verdict, remark = "held", f"as many by chance: p = {by_chance:.2g}"
    return count_interval(least, rigs), least, verdict, remark


@dataclass(frozen=True)
class _Found:
    """The value of each rig, how many cells failed, and rigs of which some image does not show enough."""

    by_rig: Mapping[str, float]
    failed: int
    absent: tuple[str, ...]


def _alone(statement: Statement, own: Sequence[Result]) -> _Found:
    numbers: _Numbers = {
        (*_place(row), row.cell.options): _number(row, statement) for row in own if not _has_failed(row)
    }
    return _found(numbers, sum(map(_has_failed, own)))


def _against(statement: Statement, own: Sequence[Result], others: Sequence[Result]) -> _Found:
    """Ratios, or whether they are within; cells that have no partner say nothing."""
    partners = {_place(other): other for other in others}
    if len(partners) < len(others):
        raise InvalidInput(
            f"statement '{statement.label}' compares with several sets of options of {statement.against}; "
            "expected against_options that name one"
        )
    pairs = [(row, partners[_place(row)]) for row in own if _place(row) in partners]
    sound = [(row, other) for row, other in pairs if not (_has_failed(row) or _has_failed(other))]
    failed = len(pairs) - len(sound)
    numbers: _Numbers = {
        (*_place(row), row.cell.options): _log_ratio(_number(row, statement), _number(other, statement))
        for row, other in sound
    }
    if statement.within is not None:
        low, high = map(_log, statement.within)
        shares: _Numbers = {key: _share(low <= value <= high, value) for key, value in numbers.items()}
        return _found(shares, failed)
    found = _found(numbers, failed)
    return replace(found, by_rig={rig: math.exp(value) for rig, value in found.by_rig.items()})


def _against_each(statement: Statement, own: Sequence[Result], rivals: Sequence[Sequence[Result]]) -> _Found:
    """The largest ratio to any rival that has a number, infinite where they alone have one.

    A rig on which no rival has one says nothing.
    """
    if not all(rivals) or not own:
        return _Found({}, 0, ())
    alone = _alone(statement, own)
    against = [(_against(statement, own, rows), _alone(statement, rows)) for rows in rivals]
    contested = {rig for _, rival in against for rig in rival.by_rig}
    by_rig = {
        rig: max(found.by_rig.get(rig, 0.0) for found, _ in against) if math.isfinite(own_value) else math.inf
        for rig, own_value in alone.by_rig.items()
        if rig in contested
    }
    lost = {rig: math.inf for rig in alone.absent if rig in contested}
    failed = alone.failed + sum(rival.failed for _, rival in against)
    absent = tuple(rig for rig in (*alone.by_rig, *alone.absent) if rig not in contested)
    return _Found({**by_rig, **lost}, failed, absent)


def _found(numbers: _Numbers, failed: int) -> _Found:
    by_rig = {str(rig): value for rig, value in nested_means(numbers).items()}
    absent = dict.fromkeys(str(key[0]) for key in numbers if key[0] not in by_rig)
    return _Found(by_rig, failed, tuple(absent))


def _has_failed(row: Result) -> bool:
    """What a method cannot serve is no failure of the measurement: it has no value there."""
    return row.status not in ("ok", "unsupported")


def _number(row: Result, statement: Statement) -> float:
    value = row.metrics.get(statement.metric, math.nan)
    if statement.over is None:
        return value
    whole = row.metrics.get(statement.over, math.nan)
    return value / whole if whole else math.nan


def _log_ratio(own: float, other: float) -> float:
    """NaN where either is no positive number; nothing is that much less than infinity."""
    return math.log(own / other) if 0 < own < math.inf and 0 < other < math.inf else math.nan


def _log(bound: float) -> float:
    return math.log(bound) if bound > 0 else -math.inf


def _share(is_within: bool, value: float) -> float:
    return math.nan if math.isnan(value) else float(is_within)


def _rows_of(rows: Sequence[Result], group: str, method: str, options: Mapping[str, object]) -> list[Result]:
    return [
        row
        for row in rows
        if row.cell.method == method and row.group == group and options.items() <= row.options.items()
    ]


def _rivals(statement: Statement, rows: Sequence[Result]) -> list[list[Result]]:
    """The rows of each rival under each of its sets of options; a method is no rival of its own."""
    found: list[list[Result]] = []
    for group, method in statement.speaks_of[1:]:
        if method != statement.method:
            of_method = _rows_of(rows, group, method, {})
            variants = dict.fromkeys(row.cell.options for row in of_method)
            found += [[row for row in of_method if row.cell.options == each] for each in variants or [""]]
    return found


def _place(row: Result) -> tuple[Hashable, ...]:
    """Where methods are compared: the rig first, as the unit, and the pose."""
    return (*place_of(row), row.pose)
