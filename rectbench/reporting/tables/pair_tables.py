"""The tables of single pairs: every metric of every method."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import Any

from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.names import named
from rectbench.reporting.tables.numbers import MISSING, three_digits
from rectbench.reporting.tables.table import Entry, Heading, Section, Table, number, text_heading, with_best
from rectbench.reporting.tables.tabulation import head_text
from rectbench.runs.run import Run


def pair_tables(run: Run) -> list[Table]:
    """Every metric of every method, one table a (scene, rig), one section a pose (motion, seed).

    Pairs without a scene have none: they are many, and the tables by rig hold what there is of them.
    """
    return [
        _pair_table(run, scene, rig, results)
        for rig, scene in product(run.rigs, run.scenes)
        if scene != NO_SCENE and (results := run.select(scene=scene, rig=rig))
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
        columns = [c for c in map(run.catalogue.column, run.metrics) if c.shown != "rows"]
        rows = [_metric_row(column, present) for column in columns]
        notes = dict.fromkeys(name for r in present if r is not None for name in r.notes)
        rows += [_note_row(name, present) for name in notes]
        sections.append(Section(", ".join(parts), (status, *rows)))
    return Table(
        kind="pair",
        part=run.group,
        name=named(run, "pair", scene, rig),
        title=f"{scene} seen by {rig}",
        caption="Every metric of every method; the best is bold where all are measured on the same pixels.",
        headings=(text_heading("metric"), *(Heading(method, method) for method in methods)),
        sections=tuple(sections),
    )


def _metric_row(shown_as: Column, present: Sequence[Result | None]) -> tuple[Entry, ...]:
    entries = [
        number(r.metrics.get(shown_as.key), shown_as) if r is not None and r.ok else Entry(MISSING)
        for r in present
    ]
    head = Entry(head_text(shown_as), shown_as.key)
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
