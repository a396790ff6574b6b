"""The tables of a run: one a pose, one a pair of scene and rig, one by protocol, one of failures."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

from rectbench.reporting.columns import DISTORTION_KEYS, MAIN_KEYS, RANKING_KEY, Column, column
from rectbench.reporting.numbers import MISSING, three_digits
from rectbench.reporting.run_folder import Result, Run
from rectbench.reporting.summaries import Summary, ranked, summarise
from rectbench.reporting.tables import Entry, Heading, Section, Table, number, with_best

OK_HEADING = Heading("ok", "ok", meaning="Cells measured of cells planned.")
NOT_OK_HEADING = Heading("not ok", "not_ok", numeric=False, meaning="How the other cells ended.")

PARTIAL = (
    "A method with failed cells is averaged over its measured cells alone. These are other pairs than its "
    "neighbours', so that its averages win no column"
)


def slug(*parts: str) -> str:
    """A file's stem from names: lower case, hyphens, nothing a shell or LaTeX minds."""
    return "-".join(filter(None, (re.sub(r"[^a-z0-9]+", "-", part.lower()).strip("-") for part in parts)))


def all_tables(run: Run) -> Iterator[Table]:
    """Every table of the run, the main ones first."""
    yield from main_tables(run)
    yield distortion_table(run)
    yield from pair_tables(run)
    if run.failures:
        yield failures_table(run)


def main_tables(run: Run) -> list[Table]:
    """Methods by key metrics, averaged over every pair of the run; one table a pose."""
    return [_main_table(run, pose) for pose in run.poses]


def _main_table(run: Run, pose: str) -> Table:
    results = run.select(pose=pose)
    keys = [key for key in MAIN_KEYS if key in run.metrics]
    methods = [m for m in run.methods if any(r.method == m for r in results)]
    summaries = ranked(summarise(m, [r for r in results if r.method == m], keys) for m in methods)
    failing = any(not s.complete for s in summaries)
    headings = [
        Heading("rank", "rank", meaning=f"By {column(RANKING_KEY).heading}; failures count before it.")
    ]
    headings += [Heading("method", "method", numeric=False), OK_HEADING]
    headings += [_heading(key) for key in keys] + [NOT_OK_HEADING] * failing
    ranks = [
        Entry(str(i), i) if s.averages.get(RANKING_KEY) and s.ok else Entry(MISSING)
        for i, s in enumerate(summaries, 1)
    ]
    fields = [_averaged_field(summaries, key) for key in keys]
    rows = tuple(
        (
            ranks[i],
            Entry(s.method, s.method),
            _ok_entry(s),
            *(f[i] for f in fields),
            *[_not_ok_entry(s, results)] * failing,
        )
        for i, s in enumerate(summaries)
    )
    pairs = len({r.pair for r in results})
    caption = f"Averages over {_count(pairs, 'pair')} ({_grid_text(results)}), ranked by log distortion."
    return Table(
        name=slug("main", pose),
        title=f"Methods under the {pose} pose",
        caption=caption,
        headings=tuple(headings),
        sections=(Section("", rows),),
        notes=(f"{PARTIAL}, and it ranks last.",) if failing else (),
    )


def distortion_table(run: Run) -> Table:
    """Distortion under each protocol, a section a rig, averaged over that rig's pairs."""
    keys = [key for key in DISTORTION_KEYS if key in run.metrics]
    pose_results = run.select(pose=run.geometric_pose)
    failing = any(not r.ok for r in pose_results)
    sections = []
    for rig, motion in product(run.rigs, run.motions):
        results = run.select(pose_results, rig=rig, motion=motion)
        if not results:
            continue
        summaries = [
            summarise(m, [r for r in results if r.method == m], keys)
            for m in run.methods
            if any(r.method == m for r in results)
        ]
        fields = [_averaged_field(summaries, key) for key in keys]
        rows = tuple(
            (
                Entry(s.method, s.method),
                _ok_entry(s),
                *(f[i] for f in fields),
                *[_not_ok_entry(s, results)] * failing,
            )
            for i, s in enumerate(summaries)
        )
        sections.append(Section(f"{rig}, {motion}" if len(run.motions) > 1 else rig, rows))
    return Table(
        name="distortion",
        title="Distortion by protocol",
        caption=(
            f"Averages over the pairs of each rig, {run.geometric_pose} pose. Native: each method's own "
            "scale; rescaled: the one scale best for L; stretched: the best scales of width and height."
        ),
        headings=(
            Heading("method", "method", numeric=False),
            OK_HEADING,
            *(_heading(key) for key in keys),
            *[NOT_OK_HEADING] * failing,
        ),
        sections=tuple(sections),
        notes=(f"{PARTIAL}.",) if failing else (),
    )


def pair_tables(run: Run) -> list[Table]:
    """Every metric of every method, one table a (scene, rig), one section a pose (motion, seed)."""
    tables = []
    for rig, scene in product(run.rigs, run.scenes):
        results = run.select(scene=scene, rig=rig)
        if results:
            tables.append(_pair_table(run, scene, rig, results))
    return tables


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
        rows = [_metric_row(column(key), present) for key in run.metrics]
        notes = dict.fromkeys(name for r in present if r is not None for name in r.notes)
        rows += [_note_row(name, present) for name in notes]
        sections.append(Section(", ".join(parts), (status, *rows)))
    return Table(
        name=slug("pair", scene, rig),
        title=f"{scene} seen by {rig}",
        caption="Every metric of every method; the best of each row is bold.",
        headings=(
            Heading("metric", "metric", numeric=False),
            *(Heading(method, method) for method in methods),
        ),
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


def failures_table(run: Run) -> Table:
    """Every cell without a measurement, its status and the reason given."""
    names = ("scene", "rig", "motion", "pose", "method", "seed", "status", "reason")
    rows = tuple(
        tuple(
            Entry(str(value) or MISSING, value, failed=name == "status")
            for name, value in ((name, getattr(r, name)) for name in names)
        )
        for r in run.failures
    )
    return Table(
        name="failures",
        title="Cells without a measurement",
        caption=f"{len(rows)} of {_count(len(run.results), 'cell')}.",
        headings=tuple(Heading(name, name, numeric=name == "seed") for name in names),
        sections=(Section("", rows),),
    )


def _heading(key: str) -> Heading:
    shown_as = column(key)
    return Heading(_head_text(shown_as), key, meaning=shown_as.meaning)


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


def _averaged_field(summaries: Sequence[Summary], key: str) -> list[Entry]:
    """One metric down the methods. Averages over fewer cells than planned compete for no prize."""
    shown_as = column(key)
    entries = []
    for summary in summaries:
        averaged = summary.averages[key]
        short = averaged.count < summary.ok
        entries.append(
            number(averaged.value, shown_as, f" ({averaged.count}/{summary.cells})" if short else "")
        )
    eligible = [s.complete and s.averages[key].count == s.cells for s in summaries]
    return with_best(entries, shown_as, eligible)


def _grid_text(results: Sequence[Result]) -> str:
    parts = [
        _count(len({r.scene for r in results}), "scene"),
        _count(len({r.rig for r in results}), "rig"),
    ]
    for name, values in (("motion", {r.motion for r in results}), ("seed", {r.seed for r in results})):
        if len(values) > 1:
            parts.append(_count(len(values), name))
    return ", ".join(parts)


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}{'' if n == 1 else 's'}"
