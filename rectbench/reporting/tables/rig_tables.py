"""Distortion rig by rig: the ranking column with a row a rig, and each protocol with a section a rig."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.curves import KEPT, ranked_by, ranked_share, ranking_stem, view_key
from rectbench.reporting.names import named, slug
from rectbench.reporting.tables.captions import averages_text, capitalised, units_text
from rectbench.reporting.tables.findings import reversals
from rectbench.reporting.tables.numbers import MISSING, shown
from rectbench.reporting.tables.standings import Standing, standing
from rectbench.reporting.tables.summaries import averaged
from rectbench.reporting.tables.table import (
    Entry,
    Heading,
    Section,
    Table,
    number,
    text_heading,
    with_best,
    words,
)
from rectbench.reporting.tables.tabulation import (
    ALL_RIGS,
    heading,
    interval_text,
    measured,
    methods_table,
    summaries_of,
    titled,
    topic_columns,
)
from rectbench.runs.run import Run

_KEPT = Column.share(KEPT, "view kept", "higher", "")
_SHARES = (
    "A share of the view is that of the source pixels nearest to its middle, the same for all methods; shown "
    "is all that the method itself shows."
)
_PROTOCOLS = (
    "Of all that the method shows. Native: each method's own scale; rescaled: the one scale best for L; "
    "stretched: the best scales of width and height."
)


def rig_table(run: Run) -> Table | None:
    """The ranking column, a row a rig (and motion), a column a method; None where that is a single row."""
    results, ranking = run.select(pose=run.geometric_pose), run.catalogue.ranking
    places = list(dict.fromkeys((r.rig, r.motion) for r in results))
    if len(places) < 2 or ranking.key not in run.metrics:
        return None
    found = standing(summaries_of(run, results, [ranking]), results, run.catalogue)
    methods = [s.method for s in found.summaries]
    views = measured(run, [run.catalogue.column(view_key(ranked_share(run.catalogue)))])
    rows = tuple(_rig_row(run, place, methods, views) for place in places)
    has_gaps = any(entry.value is None and entry.text != MISSING for row in rows for entry in row)
    gaps = "In brackets: the share of the view that a method keeps, where it has no number."
    words_of = ("rig", "motion") if len(run.motions) > 1 else ("rig",)
    return Table(
        kind="rigs",
        part=run.group,
        name=named(run, "rigs"),
        title=titled(run, f"{capitalised(ranked_by(run.catalogue))}, rig by rig"),
        caption=f"{run.geometric_pose.capitalize()} pose, pairs of a rig averaged. The last row is the "
        f"average over {units_text(results)}, with its 95 % interval where they are three or more.",
        headings=(*map(text_heading, words_of), *map(heading, views), *(Heading(m, m) for m in methods)),
        sections=(Section("", rows), Section("", (_mean_row(found, ranking, len(words_of), len(views)),))),
        notes=(*reversals(found.values, ranking), *[gaps] * has_gaps),
    )


def _rig_row(
    run: Run, place: tuple[str, str], methods: Sequence[str], views: Sequence[Column]
) -> tuple[Entry, ...]:
    ranking = run.catalogue.ranking
    here = run.select(pose=run.geometric_pose, rig=place[0], motion=place[1])
    entries = [_value_or_kept(run.select(here, method=m), ranking) for m in methods]
    whole = [entry.value is not None for entry in entries]
    named_by = place if len(run.motions) > 1 else place[:1]
    return (
        *map(words, named_by),
        *(number(averaged(view, here).value, view) for view in views),
        *with_best(entries, ranking, whole),
    )


def _value_or_kept(results: Sequence[Result], ranking: Column) -> Entry:
    """The value where all pairs have one; else how much of the view is kept, in brackets."""
    found, kept = averaged(ranking, results), averaged(_KEPT, results)
    if results and found.count == len(results):
        return number(found.value, ranking)
    return Entry(MISSING if kept.value is None else f"({shown(kept.value, _KEPT)}\u00a0%)")


def _mean_row(found: Standing, ranking: Column, labels: int, views: int) -> tuple[Entry, ...]:
    entries = []
    for summary in found.summaries:
        mean = summary.averages[ranking.key]
        within = interval_text(mean, ranking)
        if summary.method in found.behind:
            entries.append(Entry(MISSING))
        else:
            entries.append(number(mean.value, ranking, f" ({within})" if within else ""))
    rule = {"geometric": "geometric mean"}.get(ranking.average, "mean")
    blanks = [words("")] * (labels - 1) + [Entry("")] * views
    return words(rule), *blanks, *entries


def distortion_tables(run: Run) -> Iterator[Table]:
    """The ranking measure on shares of the view, then distortion under each protocol; a section a rig."""
    columns, stem = topic_columns(run, "Distortion"), ranking_stem(run.catalogue)
    of_view = [column for column in columns if column.key.startswith(stem)]
    others = [column for column in columns if column not in of_view]
    if of_view:
        yield _by_rig(run, of_view, slug(stem), f"{capitalised(stem.replace('_', ' '))} by view", _SHARES)
    if others:
        yield _by_rig(run, others, "distortion", "Distortion by protocol", _PROTOCOLS)


def _by_rig(run: Run, columns: Sequence[Column], stem: str, title: str, about: str) -> Table:
    results = run.select(pose=run.geometric_pose)
    by_rig = {rig: run.select(results, rig=rig) for rig in run.rigs}
    return replace(
        methods_table(run, columns, {ALL_RIGS: results, **by_rig} if len(by_rig) > 1 else by_rig),
        kind="distortion",
        name=named(run, stem),
        title=titled(run, title),
        caption=f"{run.geometric_pose.capitalize()} pose. {averages_text(results, columns)} {about}",
    )
