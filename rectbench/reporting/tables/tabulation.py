"""What tables of methods are made of: their columns, a row a method, the best of each column marked."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from rectbench.margin import MARGIN_DEG
from rectbench.metrics.coverage import TRIMMED, trimmed_text
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.asked import part_title
from rectbench.reporting.shares import reads
from rectbench.reporting.tables.captions import capitalised, counted
from rectbench.reporting.tables.numbers import MISSING, shown_roughly
from rectbench.reporting.tables.summaries import Averaged, Summary, is_too_wide, summarise
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, text_heading, with_best
from rectbench.runs.run import Run

INTERVAL_LEVEL = "95 % confidence"
METHOD_HEADINGS = text_heading("method"), Heading("ok", "ok", meaning="Cells measured of cells planned.")
NOT_OK_HEADING = Heading("not ok", "not_ok", numeric=False, meaning="How the other cells ended.")

ALL_RIGS, ALL_MOTIONS = "all rigs", "all motions"
"""The sections that a table of many begins with; the page folds those behind it."""
PARTIAL = (
    "A method with failed cells is averaged over its measured cells alone. These are other pairs than its "
    "neighbours', so that its averages win no column"
)


def measured(run: Run, columns: Iterable[Column]) -> list[Column]:
    """Those of the columns that the run has."""
    return [column for column in columns if column.key in run.metrics]


def topic_columns(run: Run, topic: str) -> list[Column]:
    """The measured columns that a topic's table shows."""
    return measured(run, run.catalogue.shown("topic", "page", "summary", topic=topic))


def methods_table(run: Run, columns: Sequence[Column], sections: Mapping[str, Sequence[Result]]) -> Table:
    """Averages of the columns, a row a method, in a section of results each."""
    failing = any(not r.ok for results in sections.values() for r in results)
    return Table(
        name="",
        title="",
        caption="",
        headings=(*METHOD_HEADINGS, *map(heading, columns), *[NOT_OK_HEADING] * failing),
        sections=tuple(
            Section(title, method_rows(summaries_of(run, results, columns), columns, results, failing))
            for title, results in sections.items()
            if results
        ),
        notes=(f"{PARTIAL}.",) if failing else (),
        part=run.group,
    )


def summaries_of(run: Run, results: Sequence[Result], columns: Sequence[Column]) -> list[Summary]:
    """Of the methods that any of the results is of, in the run's order."""
    mine = {method: [r for r in results if r.method == method] for method in run.methods}
    return [summarise(method, own, columns) for method, own in mine.items() if own]


def method_rows(
    summaries: Sequence[Summary], columns: Sequence[Column], results: Sequence[Result], failing: bool
) -> tuple[tuple[Entry, ...], ...]:
    """A row a summary: the method, how many cells were measured, its averages, and how others ended."""
    fields = [_averaged_field(summaries, column) for column in columns]
    return tuple(
        (
            Entry(s.method, s.method),
            _ok_entry(s),
            *(f[i] for f in fields),
            *[_not_ok_entry(s, results)] * failing,
        )
        for i, s in enumerate(summaries)
    )


def titled(run: Run, title: str) -> str:
    """A table's title, with the part's before it."""
    part = part_title(run)
    if part.casefold() == title.casefold():
        return title
    return f"{part}: {title[0].lower()}{title[1:]}" if part else title


def heading(shown_as: Column) -> Heading:
    """What stands above a column, with an arrow towards the better values."""
    return Heading(head_text(shown_as), shown_as.key, meaning=shown_as.meaning)


def head_text(shown_as: Column) -> str:
    """Heading, unit and arrow."""
    arrow = {"lower": "\u00a0↓", "higher": "\u00a0↑", None: ""}[shown_as.better]
    unit = f" [{shown_as.unit}]" if shown_as.unit else ""
    return reads(shown_as) + unit + arrow


def interval_text(averaged: Averaged, shown_as: Column) -> str:
    """The interval of an average, in the column's shown unit, or that it is too wide to tell anything.

    Empty where there is none: over two rigs, of a maximum, of infinite values.
    """
    found = averaged.interval
    if found is None or not math.isfinite(found.low):
        return ""
    if is_too_wide(found):
        return f"{counted(found.units, 'rig')}: too few to tell"
    return f"{shown_roughly(found.low, shown_as)}–{shown_roughly(found.high, shown_as)}"


def _ok_entry(summary: Summary) -> Entry:
    text = f"{summary.ok}/{summary.cells}"
    return Entry(text, text, failed=not summary.complete)


def _not_ok_entry(summary: Summary, results: Sequence[Result]) -> Entry:
    ended = [r.status for r in results if r.method == summary.method and not r.ok]
    text = ", ".join(f"{ended.count(status)} {status}" for status in dict.fromkeys(ended))
    return Entry(text or MISSING, text, failed=bool(text))


def _averaged_field(summaries: Sequence[Summary], shown_as: Column) -> list[Entry]:
    """One metric down the methods. Averages over fewer cells than planned compete for no prize."""
    of_methods = [summary.averages[shown_as.key] for summary in summaries]
    is_partial = any(a.count < s.cells for a, s in zip(of_methods, summaries, strict=True))
    entries = []
    for summary, averaged in zip(summaries, of_methods, strict=True):
        short = averaged.count < summary.ok
        entry = number(averaged.value, shown_as, f" ({averaged.count}/{summary.cells})" if short else "")
        within = interval_text(averaged, shown_as)
        hint = f"{INTERVAL_LEVEL} interval: {within}" if within else ""
        entries.append(replace(entry, hint=hint, beside=_beside(averaged, is_partial)))
    eligible = [s.complete and s.averages[shown_as.key].count == s.cells for s in summaries]
    return with_best(entries, shown_as, eligible)


def _beside(averaged: Averaged, is_partial: bool) -> dict[str, float]:
    """What the CSV tells of an average: the ends of its interval; over how many cells, where any lack one."""
    found = averaged.interval
    told = {} if found is None else {"low": found.low, "high": found.high}
    told = {end: value for end, value in told.items() if math.isfinite(value)}
    return {**told, **({"count": float(averaged.count)} if is_partial else {})}


def view_text(run: Run, results: Iterable[Result]) -> str:
    """How much of the views was trimmed, and where, in a sentence; nothing where nothing was."""
    of_rig: dict[str, list[float]] = {}
    for r in results:
        if r.ok:
            of_rig.setdefault(r.rig, []).append(r.metrics.get(TRIMMED, 0.0))
    shares = [share for found in of_rig.values() if (share := max(found))]
    if not shares:
        return ""
    told = trimmed_text(sum(shares) / len(shares), run.record.spec.margin_deg or MARGIN_DEG)
    return f"{capitalised(told)}, on {len(shares)} of {counted(len(of_rig), 'rig')}."
