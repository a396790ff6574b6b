"""The tables of what a report judges: claims, what each stands on, each rig by itself, the source's parts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from rectbench.experiments.claims import SourcePart
from rectbench.plugins.metric import Column
from rectbench.reporting.names import slug
from rectbench.reporting.tables.table import (
    Entry,
    Heading,
    Section,
    Table,
    number,
    text_heading,
    whole,
    words,
)
from rectbench.runs.run import Run

if TYPE_CHECKING:
    from rectbench.runs.judging import Judged, Measured

_NUMBER = Column("", "")
_SHARE = Column.share("", "", None, "")


def claims_tables(run: Run) -> Iterator[Table]:
    """Claims and verdicts, every measurement behind them, each rig by itself; then the source's parts."""
    from rectbench.runs.judging import judged_claims

    spec = run.record.spec
    if spec.claims:
        judged = judged_claims(spec.claims, run.results, run.table.columns)
        yield verdicts_table(judged)
        yield measurements_table(judged)
        yield from (by_rig_table(i, one) for i, one in enumerate(judged, 1) if _rigs_of(one))
    if spec.source_parts:
        yield source_parts_table(spec.source_parts)


def verdicts_table(judged: Sequence[Judged]) -> Table:
    """A row a claim: what is said, whether it holds, clause by clause, and why."""
    rows = tuple(
        (
            whole(i),
            words(one.claim.name),
            words(one.claim.says),
            _verdict(one.verdict),
            words("; ".join(f"{clause}: {verdict}" for clause, verdict in one.clauses.items() if clause)),
            words(one.because),
        )
        for i, one in enumerate(judged, 1)
    )
    return Table(
        kind="claims",
        name="claims",
        title="Claims and verdicts",
        caption="A claim is held where each of its clauses is, and not held where one is not. It depends "
        "where ways to measure a clause answer differently. It is undecided where the rigs are too few, or "
        "too different from one another, to say.",
        headings=(
            Heading("", "number"),
            text_heading("claim"),
            text_heading("what is said", "says", wraps=True),
            text_heading("verdict"),
            text_heading("clauses", wraps=True),
            text_heading("why", "because", wraps=True),
        ),
        sections=(Section("", rows),),
    )


def measurements_table(judged: Sequence[Judged]) -> Table:
    """Every measurement of every claim, a section a claim."""
    return Table(
        kind="measurements",
        name="claims-measured",
        title="What was measured for each claim",
        caption="Means over rigs, geometric ones of ratios, with 95 % t intervals over rigs; a rig's "
        "motions, scenes and seeds are one value of it. Held: the whole interval is as expected; not held: "
        "none of it; else undecided. Of a count, the share of the rigs with its exact interval; held where "
        "it reaches the share that is claimed, not held where an exact binomial test refutes that share "
        "(p < 0.05).",
        headings=(
            text_heading("clause"),
            text_heading("measured", wraps=True),
            Heading("mean", "mean"),
            Heading("from", "low", meaning="Lower end of the 95 % interval."),
            Heading("to", "high", meaning="Upper end of the 95 % interval."),
            text_heading("expected"),
            Heading("rigs", "rigs", numeric=False, meaning="Rigs whose own value is as expected."),
            text_heading("verdict"),
            text_heading("remark", wraps=True),
        ),
        sections=tuple(
            Section(f"{i}. {one.claim.name}: {one.verdict}", tuple(map(_measured_row, one.tests)))
            for i, one in enumerate(judged, 1)
        ),
    )


def _measured_row(test: Measured) -> tuple[Entry, ...]:
    found, statement = test.interval, test.statement
    shown_as = _SHARE if statement.measure == "count" else _NUMBER
    suffix = "\u00a0%" if shown_as is _SHARE else ""
    remarks = ["" if statement.judges else "to compare with", test.remark]
    if test.absent:
        remarks.append(f"no image, or none that shows that much, on {', '.join(test.absent)}")
    return (
        words(statement.clause),
        words(statement.label),
        *(number(value, shown_as, suffix) for value in (found.estimate, found.low, found.high)),
        words(statement.expected),
        words(f"{test.rigs_held} of {len(test.by_rig)}"),
        _verdict(test.verdict),
        words("; ".join(filter(None, remarks))),
    )


def by_rig_table(place: int, judged: Judged) -> Table:
    """What was measured for a claim on each rig; the `place` is the claim's among all."""
    rigs = _rigs_of(judged)
    rows = tuple(
        (
            words(test.statement.label),
            words(test.statement.expected),
            *(number(test.by_rig.get(rig), _NUMBER) for rig in rigs),
        )
        for test in judged.tests
        if test.by_rig
    )
    return Table(
        kind="by-rig",
        name=slug("claims-by-rig", judged.claim.name),
        title=f"{place}. {judged.claim.name}, on each rig",
        caption="Means over a rig's motions, scenes and seeds. Of a count, the largest ratio to any rival: "
        "below 1 the method is the least; 0 where no rival's image shows that much of the view.",
        headings=(
            text_heading("measured"),
            text_heading("expected"),
            *(Heading(rig, rig) for rig in rigs),
        ),
        sections=(Section("", rows),),
    )


def _rigs_of(judged: Judged) -> list[str]:
    return list(dict.fromkeys(rig for test in judged.tests for rig in test.by_rig))


def source_parts_table(parts: Sequence[SourcePart]) -> Table:
    """What the source has, part by part, and what became of it."""
    return Table(
        kind="source-parts",
        name="source-parts",
        title="The source, part by part",
        caption="What is done as there, what is done otherwise, and what cannot be done.",
        headings=(
            text_heading("part", wraps=True),
            text_heading("status"),
            text_heading("where it is, or why", "why", wraps=True),
        ),
        sections=(Section("", tuple((words(p.name), words(p.status), words(p.why)) for p in parts)),),
    )


def _verdict(verdict: str) -> Entry:
    return Entry(verdict, verdict, failed=verdict in ("not held", "not measured"))
