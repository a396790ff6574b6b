"""The tables every run has: one a pose, one a pair of scene and rig, one by protocol, one of failures.

A report of several parts has them for each part, under names that hold the part's.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.asked import methods_part, part_title
from rectbench.reporting.names import named
from rectbench.reporting.tables.numbers import MISSING, three_digits
from rectbench.reporting.tables.summaries import Summary, ranked, summarise
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, text_heading, with_best
from rectbench.runs.run import Run

_METHOD_HEADINGS = text_heading("method"), Heading("ok", "ok", meaning="Cells measured of cells planned.")
_NOT_OK_HEADING = Heading("not ok", "not_ok", numeric=False, meaning="How the other cells ended.")

PARTIAL = (
    "A method with failed cells is averaged over its measured cells alone. These are other pairs than its "
    "neighbours', so that its averages win no column"
)


def main_tables(run: Run) -> list[Table]:
    """Methods by key metrics, averaged over every pair; one table a part and pose."""
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
    summaries = ranked(_summaries(run, results, columns), ranking.key)
    failing = any(not s.complete for s in summaries)
    headings = [Heading("rank", "rank", meaning=f"By {ranking.heading}; failures count before it.")]
    headings += [*_METHOD_HEADINGS, *map(heading, columns), *[_NOT_OK_HEADING] * failing]
    ranks = [
        Entry(str(i), i) if s.averages.get(ranking.key) and s.ok else Entry(MISSING)
        for i, s in enumerate(summaries, 1)
    ]
    rows = tuple(
        (rank, *row)
        for rank, row in zip(ranks, _method_rows(summaries, columns, results, failing), strict=True)
    )
    pairs = _pairs_text(results) if run.has_truth else _photographs_text(results)
    caption = f"Averages over {pairs}, ranked by {ranking.heading}."
    return Table(
        kind="main",
        part=run.group,
        name=named(run, "main", pose),
        title=titled(run, f"Methods under the {pose} pose"),
        caption=caption,
        headings=tuple(headings),
        sections=(Section("", rows),),
        notes=(f"{PARTIAL}, and it ranks last.",) if failing else (),
    )


def distortion_table(run: Run) -> Table:
    """Distortion under each protocol, a section a rig, averaged over that rig's pairs."""
    results = run.select(pose=run.geometric_pose)
    sections = {
        f"{rig}, {motion}" if len(run.motions) > 1 else rig: run.select(results, rig=rig, motion=motion)
        for rig, motion in product(run.rigs, run.motions)
    }
    table = methods_table(run, topic_columns(run, "Distortion"), sections)
    return replace(
        table,
        kind="distortion",
        name=named(run, "distortion"),
        title=titled(run, "Distortion by protocol"),
        caption=(
            f"Averages over the pairs of each rig, {run.geometric_pose} pose. Native: each method's own "
            "scale; rescaled: the one scale best for L; stretched: the best scales of width and height."
        ),
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
        headings=(*_METHOD_HEADINGS, *map(heading, columns), *[_NOT_OK_HEADING] * failing),
        sections=tuple(
            Section(title, _method_rows(_summaries(run, results, columns), columns, results, failing))
            for title, results in sections.items()
            if results
        ),
        notes=(f"{PARTIAL}.",) if failing else (),
        part=run.group,
    )


def _summaries(run: Run, results: Sequence[Result], columns: Sequence[Column]) -> list[Summary]:
    """Of the methods that any of the results is of, in the run's order."""
    mine = {method: [r for r in results if r.method == method] for method in run.methods}
    return [summarise(method, own, columns) for method, own in mine.items() if own]


def _method_rows(
    summaries: Sequence[Summary], columns: Sequence[Column], results: Sequence[Result], failing: bool
) -> tuple[tuple[Entry, ...], ...]:
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
    return f"{part}: {title[0].lower()}{title[1:]}" if part else title


def pair_tables(run: Run) -> list[Table]:
    """Every metric of every method, one table a (scene, rig), one section a pose (motion, seed)."""
    return [
        _pair_table(run, scene, rig, results)
        for rig, scene in product(run.rigs, run.scenes)
        if (results := run.select(scene=scene, rig=rig))
    ]


def _pair_table(run: Run, scene: str, rig: str, results: Sequence[Result]) -> Table:
    methods = [m for m in run.methods if any(r.method == m for r in results)]
    sections = []
    for motion, pose, seed in dict.fromkeys((r.motion, r.pose, r.seed) for r in results):
        cells = {r.method: r for r in run.select(results, motion=motion, pose=pose, seed=seed)}
        parts = [f"{pose} pose"]
        parts += [motion] if len(run.motions) > 1 else []
        parts += [f"seed {seed}"] if len({r.seed for r in run.results}) > 1 else []
        present = [cells.get(m) for m in methods]
        status = (Entry("status", "status"), *(_status_entry(r) for r in present))
        rows = [_metric_row(run.catalogue.column(key), present) for key in run.metrics]
        notes = dict.fromkeys(name for r in present if r is not None for name in r.notes)
        rows += [_note_row(name, present) for name in notes]
        sections.append(Section(", ".join(parts), (status, *rows)))
    return Table(
        kind="pair",
        part=run.group,
        name=named(run, "pair", scene, rig),
        title=f"{scene} seen by {rig}",
        caption="Every metric of every method; the best of each row is bold.",
        headings=(text_heading("metric"), *(Heading(method, method) for method in methods)),
        sections=tuple(sections),
    )


def _metric_row(shown_as: Column, present: Sequence[Result | None]) -> tuple[Entry, ...]:
    entries = [
        number(r.metrics.get(shown_as.key), shown_as) if r is not None and r.ok else Entry(MISSING)
        for r in present
    ]
    head = Entry(_head_text(shown_as), shown_as.key)
    return head, *with_best(entries, shown_as, [True] * len(entries))


def _note_row(name: str, present: Sequence[Result | None]) -> tuple[Entry, ...]:
    """What methods say of their own answers: focal lengths, energies, warnings."""
    values = [None if r is None else r.notes.get(name) for r in present]
    return Entry(f"note: {name.replace('_', ' ')}", f"note:{name}"), *map(_note_entry, values)


def _note_entry(value: Any) -> Entry:
    if isinstance(value, int | float) and math.isfinite(value):
        return Entry(three_digits(value), float(value))
    return Entry(MISSING) if value is None else Entry(str(value), str(value))


def _status_entry(result: Result | None) -> Entry:
    if result is None:
        return Entry(MISSING)
    return Entry(result.status, result.status, failed=not result.ok)


def heading(shown_as: Column) -> Heading:
    """What stands above a column, with an arrow towards the better values."""
    return Heading(_head_text(shown_as), shown_as.key, meaning=shown_as.meaning)


def _head_text(shown_as: Column) -> str:
    arrow = {"lower": "\u00a0↓", "higher": "\u00a0↑", None: ""}[shown_as.better]
    return shown_as.full_heading + arrow


def _ok_entry(summary: Summary) -> Entry:
    text = f"{summary.ok}/{summary.cells}"
    return Entry(text, text, failed=not summary.complete)


def _not_ok_entry(summary: Summary, results: Sequence[Result]) -> Entry:
    ended = [r.status for r in results if r.method == summary.method and not r.ok]
    text = ", ".join(f"{ended.count(status)} {status}" for status in dict.fromkeys(ended))
    return Entry(text or MISSING, text, failed=bool(text))


def _averaged_field(summaries: Sequence[Summary], shown_as: Column) -> list[Entry]:
    """One metric down the methods. Averages over fewer cells than planned compete for no prize."""
    entries = []
    for summary in summaries:
        averaged = summary.averages[shown_as.key]
        short = averaged.count < summary.ok
        entries.append(
            number(averaged.value, shown_as, f" ({averaged.count}/{summary.cells})" if short else "")
        )
    eligible = [s.complete and s.averages[shown_as.key].count == s.cells for s in summaries]
    return with_best(entries, shown_as, eligible)


def _pairs_text(results: Sequence[Result]) -> str:
    """How many pairs of which grid, times the seeds where each pair has them all."""
    pairs, places, seeds = (len({getattr(r, of) for r in results}) for of in ("pair", "place", "seed"))
    if seeds > 1 and pairs == places * seeds:
        return f"{counted(places, 'pair')} × {seeds} seeds ({_grid_text(results, ('motion',))})"
    return f"{counted(pairs, 'pair')} ({_grid_text(results, ('motion', 'seed'))})"


def _photographs_text(results: Sequence[Result]) -> str:
    """How many pairs of how many rigs."""
    pairs, rigs = (len({getattr(r, of) for r in results}) for of in ("pair", "rig"))
    return f"{counted(pairs, 'pair')} of photographs ({counted(rigs, 'rig')})"


def _grid_text(results: Sequence[Result], beside: Sequence[str]) -> str:
    counts = {name: len({getattr(r, name) for r in results}) for name in ("scene", "rig", *beside)}
    return ", ".join(counted(n, name) for name, n in counts.items() if n > 1 or name not in beside)


def counted(n: int, noun: str) -> str:
    return f"{n} {noun}{'' if n == 1 else 's'}"
