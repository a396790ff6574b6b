"""The survey of a report: methods against classes of lenses, and what each takes."""

from __future__ import annotations

from collections.abc import Sequence

from rectbench.plugins.result import Result
from rectbench.reporting.curves import ranked_by
from rectbench.reporting.names import named
from rectbench.reporting.survey import NAME, Surveyed, lens_classes, surveyed
from rectbench.reporting.tables.captions import capitalised
from rectbench.reporting.tables.numbers import MISSING
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
from rectbench.reporting.tables.tabulation import head_text, titled
from rectbench.runs.run import Run

ROWS, SPEED = "row_error_source_median_px", ("fit_s", "maps_s")
"""Columns beside the distortion: of rows in source pixels, which no scale of the output changes."""


def survey_table(run: Run, part: Run) -> Table | None:
    """That of a part that asks for a survey; times are taken from wherever the run has them.

    None where no field of view is known.
    """
    classes, ranking = lens_classes(part), part.catalogue.ranking
    if not classes:
        return None
    methods = surveyed(part, ranking, part.geometric_pose)
    fields = [_class_field(methods, place, part) for place in range(len(classes))]
    rows = [_row_error(part.select(method=one.method), part) for one in methods]
    times = [_times(run, part.select(method=one.method)) for one in methods]
    return Table(
        kind="main",
        part=part.group,
        name=named(part, NAME),
        title=titled(part, "All methods, all lenses"),
        caption=(
            f"{capitalised(ranked_by(part.catalogue))} by class of lenses, by the horizontal field of view "
            "that both images show: geometric means over the rigs of a class, exact pose; or why some pair "
            f"of the class has none. Row errors are under the {' and '.join(part.noisy_poses)} pose, over "
            "all lenses that the method serves; times are single calls on one core."
        ),
        headings=(
            text_heading("method"),
            text_heading("works from"),
            *(Heading(f"{c.title} ({len(c.rigs)})", f"{ranking.key}_{i}") for i, c in enumerate(classes, 1)),
            *(_heading(part, key) for key in (ROWS, *SPEED)),
        ),
        sections=(
            Section(
                "",
                tuple(
                    (
                        words(one.method),
                        words(one.works_from),
                        *(field[i] for field in fields),
                        rows[i],
                        *times[i],
                    )
                    for i, one in enumerate(methods)
                ),
            ),
        ),
    )


def _heading(part: Run, key: str) -> Heading:
    column = part.catalogue.column(key)
    return Heading(head_text(column), key, meaning=column.meaning)


def _class_field(methods: Sequence[Surveyed], place: int, part: Run) -> list[Entry]:
    ranking, entries, whole = part.catalogue.ranking, [], []
    for one in methods:
        reached = one.reached[place]
        if reached is None:
            entries.append(Entry(MISSING))
        elif reached.why:
            entries.append(Entry(reached.why))
        else:
            entries.append(number(reached.average, ranking))
        whole.append(entries[-1].value is not None)
    return with_best(entries, ranking, whole)


def _row_error(results: Sequence[Result], part: Run) -> Entry:
    column = part.catalogue.column(ROWS)
    return number(averaged(column, [r for r in results if r.pose in part.noisy_poses]).value, column)


def _times(run: Run, results: Sequence[Result]) -> list[Entry]:
    """Of the method under its options, wherever in the run they were measured."""
    alike = {(r.cell.method, r.cell.options) for r in results}
    own = [r for r in run.results if (r.cell.method, r.cell.options) in alike]
    columns = map(run.catalogue.column, SPEED)
    return [number(averaged(column, own).value, column) for column in columns]
