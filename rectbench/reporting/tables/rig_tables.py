"""Distortion rig by rig: the ranking column with a row a rig, and each protocol with a section a rig."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.curves import ranked_by, ranked_share, ranking_stem, view_key
from rectbench.reporting.footnotes import with_footnotes
from rectbench.reporting.names import named, slug
from rectbench.reporting.shares import is_of_own_view
from rectbench.reporting.tables.captions import averages_text, capitalised, units_text
from rectbench.reporting.tables.findings import reversals
from rectbench.reporting.tables.numbers import MISSING
from rectbench.reporting.tables.standings import KEEPS, Standing, lacking, standing
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
    INTERVAL_LEVEL,
    interval_text,
    measured,
    methods_table,
    summaries_of,
    titled,
    topic_columns,
)
from rectbench.runs.run import Run

MOST_METHODS = 14
_SHARES = (
    "A share of the view is that of the source pixels nearest to its middle, the same for all methods. "
    "Shown, area and shape are over what each method itself shows, be it little, and name no best method."
)
_PROTOCOLS = (
    "Over what each method itself shows, be it little, and so without a best one. Native: each method's own "
    "scale; rescaled: the one scale best for L; stretched: the best scales of width and height."
)


def rig_table(run: Run) -> Table | None:
    """The ranking column, a row a rig, a column a method; then the same for each motion.

    Rigs stand in the order of their field of view. None for one rig, and for more methods than a page has
    room for beside each other: their distortion by view has a section a rig.
    """
    results, ranking = run.select(pose=run.geometric_pose), run.catalogue.ranking
    if len(run.rigs) < 2 or len(run.methods) > MOST_METHODS or ranking.key not in run.metrics:
        return None
    found = standing(summaries_of(run, results, [ranking]), results, run.catalogue)
    methods = [s.method for s in found.summaries]
    share = ranked_share(run.catalogue)
    views = measured(run, [run.catalogue.column(view_key(share))])
    rows = (*_rig_rows(run, results, methods, views), _mean_row(found, ranking, len(views)))
    sections = [Section(ALL_MOTIONS if len(run.motions) > 1 else "", rows)]
    if len(run.motions) > 1:
        by_motion = {motion: run.select(results, motion=motion) for motion in run.motions}
        sections += [Section(m, _rig_rows(run, own, methods, views)) for m, own in by_motion.items()]
    view_heads = (
        Heading("field of view [°]", view.key, meaning=f"Horizontal, of the {share} % of the view.")
        for view in views
    )
    table = Table(
        kind="rigs",
        part=run.group,
        name=named(run, "rigs"),
        title=titled(run, f"{capitalised(ranked_by(run.catalogue))}, rig by rig"),
        caption=_rig_caption(run, results, found, has_view=bool(views)),
        headings=(text_heading("rig"), *view_heads, *(Heading(m, m) for m in methods)),
        sections=tuple(sections),
        notes=tuple(reversals(found.values, ranking)),
    )
    return with_footnotes(table)


def _rig_caption(run: Run, results: Sequence[Result], found: Standing, has_view: bool) -> str:
    ranking, pose = run.catalogue.ranking, run.geometric_pose
    told = [
        f"A row is the average over the pairs of a rig, {pose} pose"
        + ("; rigs of the narrowest view come first." if has_view else "."),
        f"The last row is the {_rule(ranking)} over {units_text(results)}"
        + (f", its {INTERVAL_LEVEL} interval in brackets." if _has_intervals(found, ranking) else "."),
    ]
    if any(why.startswith(KEEPS) for why in found.behind.values()):
        told.append(f"“{KEEPS} N %” stands where a method shows N % of the view, too little for a number.")
    return " ".join(told)


def _has_intervals(found: Standing, ranking: Column) -> bool:
    ranked = (s for s in found.summaries if s.method not in found.behind)
    return any(interval_text(s.averages[ranking.key], ranking) for s in ranked)


def _rule(ranking: Column) -> str:
    return {"geometric": "geometric mean"}.get(ranking.average, "mean")


def _rig_rows(
    run: Run, results: Sequence[Result], methods: Sequence[str], views: Sequence[Column]
) -> tuple[tuple[Entry, ...], ...]:
    by_rig = {rig: own for rig in run.rigs if (own := run.select(results, rig=rig))}

    def width(rig: str) -> float:
        return sum(averaged(view, by_rig[rig]).value or 0.0 for view in views)

    return tuple(_rig_row(run, rig, by_rig[rig], methods, views) for rig in sorted(by_rig, key=width))


def _rig_row(
    run: Run, rig: str, results: Sequence[Result], methods: Sequence[str], views: Sequence[Column]
) -> tuple[Entry, ...]:
    ranking = run.catalogue.ranking
    entries = [_value_or_why_none(run.select(results, method=m), ranking) for m in methods]
    whole = [entry.value is not None for entry in entries]
    fields_of_view = (number(averaged(view, results).value, view) for view in views)
    return words(rig), *fields_of_view, *with_best(entries, ranking, whole)


def _value_or_why_none(results: Sequence[Result], ranking: Column) -> Entry:
    """The value where all pairs have one; else how much of the view is kept, or what else is amiss."""
    why = lacking(results, ranking) if results else MISSING
    return Entry(why) if why else number(averaged(ranking, results).value, ranking)


def _mean_row(found: Standing, ranking: Column, views: int) -> tuple[Entry, ...]:
    entries = []
    for summary in found.summaries:
        mean = summary.averages[ranking.key]
        within = interval_text(mean, ranking)
        if summary.method in found.behind:
            entries.append(Entry(MISSING))
        else:
            entries.append(number(mean.value, ranking, f" ({within})" if within else ""))
    return words(_rule(ranking)), *[Entry("")] * views, *entries


def distortion_tables(run: Run) -> Iterator[Table]:
    """The ranking measure on shares of the view, then distortion under each protocol; a section a rig."""
    columns, stem = topic_columns(run, "Distortion"), ranking_stem(run.catalogue)
    of_view = [c for c in columns if c.key.startswith(stem) or not is_of_own_view(c)]
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
