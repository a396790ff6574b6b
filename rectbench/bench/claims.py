"""Claims somebody made, and what the rows of a run say about them.

A claim is stated before the run: which column, which method, against whom, and within which bounds it
would hold. What is judged is the 95 % bootstrap interval of the measured value: wholly within the
bounds it is held, wholly outside not held; anything else depends. A cell that failed keeps a
statement from being held.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from rectbench.cameras.arrays import FloatArray

Verdict = Literal["held", "not held", "depends", "not measured"]
Row = Mapping[str, Any]
Pair = tuple[str, str, str, str]
"""Scene, rig, motion, pose."""

RESAMPLES = 4000
QUANTILES = (0.025, 0.975)


class Statement(BaseModel):
    """One measurable sentence of a claim: a quantity, and the bounds within which the sentence is true."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    label: str = Field(description="What is measured, under which protocol.")
    group: str = Field(default="", description="The part of the report it speaks of.")
    metric: str = Field(description="A column of the rows.")
    method: str
    options: Mapping[str, Any] = Field(default_factory=dict, description="Options its rows have, at least.")
    against: str | None = Field(default=None, description="The method it is compared with.")
    against_group: str | None = Field(default=None, description="Where that one's rows are, if elsewhere.")
    measure: Literal["value", "ratio", "wins", "share"] = Field(
        default="value",
        description="The mean; the geometric mean of the ratio to `against`; the number of pairs where "
        "the method has the least value of its group; the share of cells whose ratio is within `within`.",
    )
    within: tuple[float, float] | None = None
    above: float | None = Field(default=None, description="True where the quantity is at least this.")
    below: float | None = Field(default=None, description="True where the quantity is at most this.")

    @model_validator(mode="after")
    def _can_be_false(self) -> Statement:
        if self.above is None and self.below is None:
            raise ValueError(f"statement '{self.label}' has neither above nor below; expected a bound")
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
    verdicts = {test.verdict for test in tests}
    verdict: Verdict = verdicts.pop() if len(verdicts) == 1 else "depends"
    return Judged(claim.name, claim.says, verdict, claim.because.get(verdict, ""), tests)


def _measured(statement: Statement, rows: Sequence[Row]) -> Measured:
    by_pair, failed = _numbers(statement, rows)
    pairs = list(by_pair.values())
    statistic = _STATISTICS[statement.measure]
    mean = low = high = math.nan
    verdict: Verdict = "not measured"
    if pairs:
        mean = float(statistic(pairs))
        low, high = _interval(pairs, statistic, stratified=statement.measure == "wins")
        verdict = _verdict(statement, low, high, failed)
    return Measured(
        label=statement.label,
        quantity=_quantity(statement),
        mean=mean,
        low=low,
        high=high,
        expected=statement.expected,
        verdict=verdict,
        pairs_held=_pairs_held(statement, pairs),
        pairs=len(pairs),
        cells=sum(map(len, pairs)),
        failed=failed,
    )


def _quantity(statement: Statement) -> str:
    if statement.measure == "wins":
        return f"pairs on which {statement.method} has the least {statement.metric}"
    if statement.against is None:
        return f"{statement.metric} of {statement.method}"
    ratio = f"{statement.metric}, {statement.method} / {statement.against}"
    return f"share of {ratio} in {statement.within}" if statement.measure == "share" else ratio


def _numbers(statement: Statement, rows: Sequence[Row]) -> tuple[dict[Pair, FloatArray], int]:
    """The numbers [cells, columns] a statement stands on, by pair, and how many cells have none."""
    others = _others(statement, rows)
    found: dict[Pair, list[list[float]]] = {}
    failed = 0
    for row in rows:
        if not _speaks_of(row, statement):
            continue
        numbers = _numbers_of(row, others.get(_place(row), []), statement)
        if all(map(math.isfinite, numbers)):
            found.setdefault(_place(row)[:4], []).append(numbers)
        else:
            failed += 1
    return {pair: np.array(numbers) for pair, numbers in found.items()}, failed


def _numbers_of(row: Row, others: Sequence[Row], statement: Statement) -> list[float]:
    own, rivals = _value(row, statement.metric), [_value(other, statement.metric) for other in others]
    if statement.measure == "value":
        return [own]
    if statement.measure == "wins":
        return [own, *rivals]
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
    """The rows to compare with, by place: those of `against`, or of all the group's other methods."""
    group = statement.group if statement.against_group is None else statement.against_group
    found: dict[tuple[str, str, str, str, int], list[Row]] = {}
    for row in rows:
        named = row["method"] == statement.against
        rival = statement.measure == "wins" and row["method"] != statement.method
        if (row.get("group") or "") == group and (named or rival):
            found.setdefault(_place(row), []).append(row)
    return found


def _place(row: Row) -> tuple[str, str, str, str, int]:
    """Where methods are compared: the pair, and the seed."""
    return row["scene"], row["rig"], row["motion"], row["pose"], int(row["seed"])


def _value(row: Row, metric: str) -> float:
    value = row.get(metric)
    return float(value) if row["status"] == "ok" and value is not None else math.nan


Statistic = Callable[[Sequence[FloatArray]], FloatArray]
"""From the numbers of each pair [..., cells, columns] to one number [...]."""


def _mean(pairs: Sequence[FloatArray]) -> FloatArray:
    mean: FloatArray = np.concatenate(pairs, axis=-2).mean(axis=(-2, -1))
    return mean


def _geometric_mean(pairs: Sequence[FloatArray]) -> FloatArray:
    mean: FloatArray = np.exp(_mean([np.log(values) for values in pairs]))
    return mean


def _wins(pairs: Sequence[FloatArray]) -> FloatArray:
    """On how many pairs the first column has the least mean."""
    won = [values.mean(axis=-2).argmin(axis=-1) == 0 for values in pairs]
    count: FloatArray = np.sum(won, axis=0, dtype=np.float64)
    return count


_STATISTICS: Mapping[str, Statistic] = {
    "value": _mean,
    "ratio": _geometric_mean,
    "share": _mean,
    "wins": _wins,
}


def _interval(pairs: Sequence[FloatArray], statistic: Statistic, *, stratified: bool) -> tuple[float, float]:
    """Percentiles of the statistic over resampled cells; `stratified` resamples those of each pair."""
    rng = np.random.default_rng(0)
    strata = pairs if stratified else [np.concatenate(pairs)]
    drawn = [values[rng.integers(len(values), size=(RESAMPLES, len(values)))] for values in strata]
    low, high = np.quantile(statistic(drawn), QUANTILES)
    return float(low), float(high)


def _verdict(statement: Statement, low: float, high: float, failed: int) -> Verdict:
    least, most = statement.bounds
    if high < least or low > most:
        return "not held"
    return "held" if least <= low and high <= most and not failed else "depends"


def _pairs_held(statement: Statement, pairs: Sequence[FloatArray]) -> int:
    statistic = _STATISTICS[statement.measure]
    if statement.measure == "wins":
        return round(float(statistic(pairs))) if pairs else 0
    least, most = statement.bounds
    return sum(least <= float(statistic([values])) <= most for values in pairs)
