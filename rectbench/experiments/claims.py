"""Claims somebody made, and what the rows of a run say about them.

A claim is stated before the run: which column, which method, against whom, and within which bounds it
would hold. What is judged is the 95 % bootstrap interval of the measured value over pairs, and over the
seeds of each: wholly within the bounds it is held, wholly outside not held; anything else depends. A
cell that failed keeps a statement from being held. Statements of one clause measure the same thing in
several ways: where these disagree, the clause depends. A claim is held where each of its clauses is, and
not held where one of them is not.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from rectbench.types import FloatArray

Verdict = Literal["held", "not held", "depends", "not measured"]
Row = Mapping[str, Any]

RESAMPLES = 4000
QUANTILES = (0.025, 0.975)


class Statement(BaseModel):
    """One measurable sentence of a claim: a quantity, and the bounds within which the sentence is true."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    label: str = Field(description="What is measured, under which protocol.")
    clause: str = Field(default="", description="The part of the claim that it measures.")
    group: str = Field(default="", description="The part of the report it speaks of.")
    metric: str = Field(description="A column of the rows.")
    method: str
    options: Mapping[str, Any] = Field(default_factory=dict, description="Options its rows have, at least.")
    against: str | None = Field(default=None, description="The method it is compared with.")
    rivals: tuple[str, ...] = Field(default=(), description="The methods to win against.")
    against_group: str | None = Field(default=None, description="Where that one's rows are, if elsewhere.")
    measure: Literal["value", "ratio", "wins", "share"] = Field(
        default="value",
        description="The mean; the geometric mean of the ratio to `against`; the number of pairs where "
        "the method has the least value of all `rivals`; the share of cells whose ratio is within `within`.",
    )
    within: tuple[float, float] | None = None
    above: float | None = Field(default=None, description="True where the quantity is at least this.")
    below: float | None = Field(default=None, description="True where the quantity is at most this.")

    @model_validator(mode="after")
    def _can_be_false(self) -> Statement:
        if self.above is None and self.below is None:
            raise ValueError(f"statement '{self.label}' has neither above nor below; expected a bound")
        least, most = self.bounds
        if not least <= most:
            raise ValueError(f"statement '{self.label}' is true from {least} to {most}; expected a range")
        if bool(self.rivals) != (self.measure == "wins"):
            raise ValueError(f"statement '{self.label}' is a {self.measure}; `rivals` are for wins")
        if (self.against is None) != (self.measure in ("value", "wins")):
            raise ValueError(
                f"statement '{self.label}' is a {self.measure}; `against` is for ratio and share"
            )
        if (self.within is None) != (self.measure != "share"):
            raise ValueError(f"statement '{self.label}' is a {self.measure}; `within` is for share")
        return self

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value for which the statement is true."""
        return (
            -math.inf if self.above is None else self.above,
            math.inf if self.below is None else self.below,
        )

    @property
    def expected(self) -> str:
        """The bounds in words."""
        if self.above is not None and self.below is not None:
            return f"{self.above:g} to {self.below:g}"
        return f"≥ {self.above:g}" if self.above is not None else f"≤ {self.below:g}"


class Claim(BaseModel):
    """What somebody says, as statements that can be measured, and what each verdict would mean."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    says: str = Field(description="The claim in a sentence.")
    statements: tuple[Statement, ...] = Field(min_length=1)
    because: Mapping[Verdict, str] = Field(description="One sentence why, for each verdict it may get.")


@dataclass(frozen=True)
class Measured:
    """What the rows say about one statement."""

    label: str
    clause: str
    """The part of the claim it measures; empty where the claim is one."""
    quantity: str
    """What the number is: a column, or a ratio of two methods' columns."""
    mean: float
    low: float
    high: float
    """The 95 % bootstrap interval."""
    expected: str
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

    name: str
    says: str
    verdict: Verdict
    because: str
    tests: tuple[Measured, ...]


def judged_claims(claims: Iterable[Claim | Mapping[str, Any]], rows: Sequence[Row]) -> tuple[Judged, ...]:
    """Judge claims, as models or as run.json holds them, by the rows of a run."""
    models = [c if isinstance(c, Claim) else Claim.model_validate(c) for c in claims]
    return tuple(_judged(claim, rows) for claim in models)


def _judged(claim: Claim, rows: Sequence[Row]) -> Judged:
    tests = tuple(_measured(statement, rows) for statement in claim.statements)
    clauses: dict[str, set[Verdict]] = {}
    for statement, test in zip(claim.statements, tests, strict=True):
        clauses.setdefault(statement.clause, set()).add(test.verdict)
    verdicts = {verdicts.pop() if len(verdicts) == 1 else "depends" for verdicts in clauses.values()}
    verdict: Verdict = "depends"
    if len(verdicts) == 1:
        (verdict,) = verdicts
    elif "not held" in verdicts:
        verdict = "not held"
    return Judged(claim.name, claim.says, verdict, claim.because.get(verdict, ""), tests)


def _measured(statement: Statement, rows: Sequence[Row]) -> Measured:
    by_pair, failed = _numbers(statement, rows)
    cells = sum(map(len, by_pair))
    mean = low = high = math.nan
    verdict: Verdict = "not measured"
    if len(by_pair) >= _pairs_needed(statement):
        mean = float(_statistic(statement)(_stacked(by_pair)))
        low, high = _interval(by_pair, _statistic(statement)) if cells > 1 else (mean, mean)
        verdict = _verdict(statement, low, high, failed)
    if cells == 1:  # one number has no interval
        low = high = math.nan
    return Measured(
        label=statement.label,
        clause=statement.clause,
        quantity=_quantity(statement),
        mean=mean,
        low=low,
        high=high,
        expected=statement.expected,
        verdict=verdict,
        pairs_held=_pairs_held(statement, by_pair),
        pairs=len(by_pair),
        cells=cells,
        failed=failed,
    )


def _pairs_needed(statement: Statement) -> float:
    """Of how many pairs a statement speaks at least; a run of fewer does not measure it."""
    return max(1.0, statement.above or 0.0) if statement.measure == "wins" else 1.0


def _quantity(statement: Statement) -> str:
    if statement.measure == "wins":
        return f"pairs on which {statement.method} has the least {statement.metric}"
    if statement.against is None:
        return f"{statement.metric} of {statement.method}"
    ratio = f"{statement.metric}, {statement.method} / {statement.against}"
    return f"share of {ratio} in {statement.within}" if statement.measure == "share" else ratio


def _numbers(statement: Statement, rows: Sequence[Row]) -> tuple[list[FloatArray], int]:
    """The numbers [cells, columns] a statement stands on, one array a pair, and how many cells have none."""
    if all(row.get(statement.metric) is None for row in rows):
        return [], 0  # a column nobody asked for is no failure
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


def _numbers_of(row: Row, others: Sequence[Row], statement: Statement) -> list[float]:
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


def _speaks_of(row: Row, statement: Statement) -> bool:
    options = json.loads(row.get("options") or "{}")
    return (
        row["method"] == statement.method
        and (row.get("group") or "") == statement.group
        and statement.options.items() <= options.items()
    )


def _others(statement: Statement, rows: Sequence[Row]) -> dict[tuple[str, str, str, str, int], list[Row]]:
    """The rows to compare with, by place: those of `against`, or of the rivals."""
    group = statement.group if statement.against_group is None else statement.against_group
    found: dict[tuple[str, str, str, str, int], list[Row]] = {}
    for row in rows:
        named = row["method"] == statement.against
        rival = row["method"] in statement.rivals and row["method"] != statement.method
        if (row.get("group") or "") == group and (named or rival):
            found.setdefault(_place(row), []).append(row)
    return found


def _place(row: Row) -> tuple[str, str, str, str, int]:
    """Where methods are compared: the pair, and the seed."""
    return row["scene"], row["rig"], row["motion"], row["pose"], int(row["seed"])


def _value(row: Row, metric: str) -> float:
    value = row.get(metric)
    return float(value) if row["status"] == "ok" and value is not None else math.nan


Statistic = Callable[[FloatArray], FloatArray]
"""From numbers [..., pairs, cells, columns], NaN where a pair has fewer cells, to one number [...]."""


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


def _stacked(by_pair: Sequence[FloatArray]) -> FloatArray:
    """[pairs, cells, columns], NaN below the cells of a pair with fewer than the others."""
    most = max(map(len, by_pair))
    missing = [((0, most - len(numbers)), (0, 0)) for numbers in by_pair]
    padded = [np.pad(n, space, constant_values=math.nan) for n, space in zip(by_pair, missing, strict=True)]
    return np.stack(padded)


def _interval(by_pair: Sequence[FloatArray], statistic: Statistic) -> tuple[float, float]:
    """Percentiles of the statistic over resampled pairs, and resampled cells of each.

    The seeds of a pair are no independent pairs: to draw from all cells alike would make intervals
    narrower than they are.
    """
    rng, numbers = np.random.default_rng(0), _stacked(by_pair)
    counts = np.array([len(numbers) for numbers in by_pair])
    pairs = rng.integers(len(by_pair), size=(RESAMPLES, len(by_pair), 1))
    cells = rng.random((RESAMPLES, *numbers.shape[:2])) * counts[pairs]
    low, high = np.quantile(statistic(numbers[pairs, cells.astype(np.intp)]), QUANTILES)
    return float(low), float(high)


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
