"""What is claimed, and what the run says about it: the verdicts, and every measurement behind them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rectbench.plugins.metric import Column
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, whole, words
from rectbench.reporting.tables.tabulation import counted
from rectbench.runs.run import Run

if TYPE_CHECKING:
    from rectbench.runs.judging import Judged, Measured


def claims_tables(run: Run) -> Iterator[Table]:
    """What is claimed and the verdict; then every measurement behind it."""
    from rectbench.runs.judging import judged_claims

    if claims := run.record.spec.claims:
        judged = judged_claims(claims, run.results, run.table.columns)
        yield verdicts_table(judged)
        yield measurements_table(judged)


def verdicts_table(judged: Sequence[Judged]) -> Table:
    """A row a claim: what is said, whether it holds, why."""
    rows = tuple(
        (
            whole(i),
            words(claim.name),
            words(claim.says),
            _verdict(claim.verdict),
            words(claim.because),
        )
        for i, claim in enumerate(judged, 1)
    )
    return Table(
        kind="claims",
        name="claims",
        title="Claims and verdicts",
        caption="A claim is held where each of its clauses is, not held where one is not; a clause depends "
        "where ways to measure it disagree.",
        headings=(
            Heading("", "number"),
            Heading("claim", "claim", numeric=False),
            Heading("what is said", "says", numeric=False, wraps=True),
            Heading("verdict", "verdict", numeric=False),
            Heading("why", "because", numeric=False, wraps=True),
        ),
        sections=(Section("", rows),),
    )


def measurements_table(judged: Sequence[Judged]) -> Table:
    """Every measurement of every claim, a section a claim."""
    return Table(
        kind="measurements",
        name="claims-measured",
        title="What was measured for each claim",
        caption="Means with 95 % bootstrap intervals over pairs, and over the seeds of each. Held: the whole "
        "interval is as expected; not held: none of it; else it depends.",
        headings=(
            Heading("clause", "clause", numeric=False),
            Heading("measured", "measured", numeric=False),
            Heading("mean", "mean"),
            Heading("from", "low", meaning="Lower end of the 95 % interval."),
            Heading("to", "high", meaning="Upper end of the 95 % interval."),
            Heading("expected", "expected", numeric=False),
            Heading("pairs", "pairs", numeric=False, meaning="Pairs whose own mean is as expected."),
            Heading("verdict", "verdict", numeric=False),
        ),
        sections=tuple(
            Section(f"{i}. {claim.name}: {claim.verdict}", tuple(map(_measured_row, claim.tests)))
            for i, claim in enumerate(judged, 1)
        ),
    )


def _measured_row(test: Measured) -> tuple[Entry, ...]:
    failed = f", {counted(test.failed, 'cell')} failed" if test.failed else ""
    pairs = f"{test.pairs_held} of {test.pairs}{failed}"
    return (
        words(test.clause),
        words(test.label),
        *_numbers(test.mean, test.low, test.high),
        words(test.expected),
        words(pairs),
        _verdict(test.verdict),
    )


def _numbers(*values: float) -> list[Entry]:
    """Three numbers of one kind: whole ones, as counts of pairs are, stay so."""
    shown_as = Column("", "", is_count=all(math.isnan(value) or value.is_integer() for value in values))
    return [number(value, shown_as) for value in values]


def _verdict(verdict: str) -> Entry:
    return Entry(verdict, verdict, failed=verdict in ("not held", "not measured"))
