"""The main tables: methods by their key metrics, averaged over the rigs, in the order in which they stand."""

from __future__ import annotations

from rectbench.plugins.metric import Column
from rectbench.reporting.asked import methods_part
from rectbench.reporting.names import named
from rectbench.reporting.tables.captions import averages_text
from rectbench.reporting.tables.numbers import MISSING
from rectbench.reporting.tables.standings import Standing, behind_text, standing
from rectbench.reporting.tables.summaries import Summary
from rectbench.reporting.tables.table import Entry, Heading, Section, Table
from rectbench.reporting.tables.tabulation import (
    INTERVAL_LEVEL,
    METHOD_HEADINGS,
    NOT_OK_HEADING,
    PARTIAL,
    heading,
    interval_text,
    measured,
    method_rows,
    summaries_of,
    titled,
    view_text,
)
from rectbench.runs.run import Run

_Field = tuple[Heading, list[Entry]]
"""A column of a table."""
INTERVAL = "_interval"
"""Ends the name of the column that holds another one's intervals."""


def main_tables(run: Run) -> list[Table]:
    """Methods by key metrics, averaged over rigs, the one that ranks first; a table a part and pose."""
    return [
        _main_table(methods, pose)
        for part in run.parts
        if (methods := methods_part(part)) and is_ranked(methods)
        for pose in methods.poses
    ]


def is_ranked(run: Run) -> bool:
    """Whether there is anything to rank methods by, or nothing at all to show but their failure."""
    return not run.group or run.catalogue.ranking.key in run.metrics or not run.metrics


def _main_table(run: Run, pose: str) -> Table:
    results, ranking = run.select(pose=pose), run.catalogue.ranking
    columns = [
        column
        for column in measured(run, run.catalogue.shown("summary", "page"))
        if not (run.has_truth and column.without_truth)
    ]
    found = standing(summaries_of(run, results, columns), results, run.catalogue)
    failing = any(not s.complete for s in found.summaries)
    heads = [*METHOD_HEADINGS, *map(heading, columns), *[NOT_OK_HEADING] * failing]
    rows = method_rows(found.summaries, columns, results, failing)
    fields = {
        head.key: (head, list(entries)) for head, entries in zip(heads, zip(*rows, strict=True), strict=True)
    }
    first: list[_Field] = []
    if found.ranks:
        first.append((_rank_heading(ranking), [_rank_entry(found, s) for s in found.summaries]))
    first.append(fields.pop("method"))
    if ranking.key in fields:
        head, entries = fields.pop(ranking.key)
        first.append(
            (head, [_ranked_entry(found, *own) for own in zip(found.summaries, entries, strict=True)])
        )
        first += filter(None, [_interval_field(found, ranking)])
    placed = [*first, *fields.values()]
    scene = "scene" if run.has_truth else "photographed pair"
    told = [found.design, found.order, averages_text(results, columns, scene), view_text(run, results)]
    notes = [behind_text(found, run.catalogue), found.caveat, f"{PARTIAL}." if failing else ""]
    return Table(
        kind="main",
        part=run.group,
        name=named(run, "main", pose),
        title=titled(run, f"Methods under the {pose} pose"),
        caption=" ".join(filter(None, told)),
        headings=tuple(head for head, _ in placed),
        sections=(Section("", tuple(zip(*(entries for _, entries in placed), strict=True))),),
        notes=tuple(filter(None, notes)),
    )


def _rank_heading(ranking: Column) -> Heading:
    return Heading("rank", "rank", meaning=f"The places that the rigs leave possible, by {ranking.heading}.")


def _rank_entry(found: Standing, summary: Summary) -> Entry:
    places = found.ranks.get(summary.method)
    if places is None:
        return Entry(MISSING)
    first, last = places
    text = str(first) if first == last else f"{first}–{last}"
    return Entry(text, text, beside={"first": float(first), "last": float(last)})


def _ranked_entry(found: Standing, summary: Summary, entry: Entry) -> Entry:
    """The ranking number; why there is none on some pair, for the average over the others is no answer."""
    why = found.behind.get(summary.method)
    return (
        entry if why is None else Entry(why, beside={k: v for k, v in entry.beside.items() if k == "count"})
    )


def _interval_field(found: Standing, column: Column) -> _Field | None:
    """The intervals of the ranking column; None where the rigs are too few for any."""
    texts = [
        "" if s.method in found.behind else interval_text(s.averages[column.key], column)
        for s in found.summaries
    ]
    if not any(texts):
        return None
    meaning = (
        f"Of {column.heading}, {INTERVAL_LEVEL}: where the mean over many more rigs of these kinds would lie."
    )
    head = Heading("its interval", f"{column.key}{INTERVAL}", meaning=meaning, is_stored=False)
    return head, [Entry(text or MISSING, text or None) for text in texts]
