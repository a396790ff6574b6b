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
    ALL_MOTIONS,
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
    """The ranking column, a row a rig, a column a method; then the same for each motion. None for one rig."""
    results, ranking = run.select(pose=run.geometric_pose), run.catalogue.ranking
    if len(run.rigs) < 2 or ranking.key not in run.metrics:
        return None
    found = standing(summaries_of(run, results, [ranking]), results, run.catalogue)
    methods = [s.method for s in found.summaries]
    views = measured(run, [run.catalogue.column(view_key(ranked_share(run.catalogue)))])
    rows = (*_rig_rows(run, results, methods, views), _mean_row(found, ranking, len(views)))
    sections = [Section(ALL_MOTIONS if len(run.motions) > 1 else "", rows)]
    if len(run.motions) > 1:
        by_motion = {motion: run.select(results, motion=motion) for motion in run.motions}
        sections += [Section(m, _rig_rows(run, own, methods, views)) for m, own in by_motion.items()]
    has_gaps = any(
        entry.text.startswith("(") for section in sections for row in section.rows for entry in row
    )
    gaps = "In brackets: the share of the view that a method keeps, where it has no number."
    return Table(
        kind="rigs",
        part=run.group,
        name=named(run, "rigs"),
        title=titled(run, f"{capitalised(ranked_by(run.catalogue))}, rig by rig"),
        caption=f"{run.geometric_pose.capitalize()} pose, pairs of a rig averaged. The last row over all is "
        f"the average over {units_text(results)}, with its 95 % interval where they are three or more.",
        headings=(text_heading("rig"), *map(heading, views), *(Heading(m, m) for m in methods)),
        sections=tuple(sections),
        notes=(*reversals(found.values, ranking), *[gaps] * has_gaps),
    )


def _rig_rows(
    run: Run, results: Sequence[Result], methods: Sequence[str], views: Sequence[Column]
) -> tuple[tuple[Entry, ...], ...]:
    by_rig = {rig: run.select(results, rig=rig) for rig in run.rigs}
    return tuple(_rig_row(run, rig, own, methods, views) for rig, own in by_rig.items() if own)


def _rig_row(
    run: Run, rig: str, results: Sequence[Result], methods: Sequence[str], views: Sequence[Column]
) -> tuple[Entry, ...]:
    ranking = run.catalogue.ranking
    entries = [_value_or_kept(run.select(results, method=m), ranking) for m in methods]
    whole = [entry.value is not None for entry in entries]
    fields_of_view = (number(averaged(view, results).value, view) for view in views)
    return words(rig), *fields_of_view, *with_best(entries, ranking, whole)


def _value_or_kept(results: Sequence[Result], ranking: Column) -> Entry:
    """The value where all pairs have one; else how much of the view is kept, in brackets."""
    found, kept = averaged(ranking, results), averaged(_KEPT, results)
    if results and found.count == len(results):
        return number(found.value, ranking)
    return Entry(MISSING if kept.value is None else f"({shown(kept.value, _KEPT)}\u00a0%)")


def _mean_row(found: Standing, ranking: Column, views: int) -> tuple[Entry, ...]:
    entries = []
    for summary in found.summaries:
        mean = summary.averages[ranking.key]
        within = interval_text(mean, ranking)
        if summary.method in found.behind:
            entries.append(Entry(MISSING))
        else:
            entries.append(number(mean.value, ranking, f" ({within})" if within else ""))
    rule = {"geometric": "geometric mean"}.get(ranking.average, "mean")
    return words(rule), *[Entry("")] * views, *entries


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
