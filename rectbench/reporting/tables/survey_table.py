"""The survey of a report: methods against classes of lenses, and what each takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.reporting.names import named
from rectbench.reporting.shares import measure
from rectbench.reporting.survey import (
    NAME,
    Reached,
    Surveyed,
    excess_column,
    lens_classes,
    surveyed,
    surveyed_columns,
)
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
    classes = lens_classes(part)
    if not classes or not surveyed_columns(part):
        return None
    beside = {method: _beside(run, part, part.select(method=method)) for method in part.methods}
    heads = (
        text_heading("method"),
        text_heading("works from"),
        *(Heading(f"{c.title} ({len(c.rigs)})", f"class_{place}") for place, c in enumerate(classes, 1)),
        *(_heading(part, key) for key in (ROWS, *SPEED)),
    )
    return Table(
        kind="main",
        part=part.group,
        name=named(part, NAME),
        title=titled(part, "All methods, all lenses"),
        caption=(
            f"{capitalised(measure(part.catalogue.ranking))} by class of lenses, by the horizontal field of "
            "view that both images show, in brackets how many rigs: geometric means over the rigs of a "
            f"class, arithmetic ones of the excess, {part.geometric_pose} pose; or why some pair of the "
            "class has none. What serves more "
            "classes stands higher, then what distorts less. Row errors are under the "
            f"{' and '.join(part.noisy_poses)} pose, over all lenses that the method serves."
        ),
        headings=heads,
        sections=tuple(
            Section(title, _rows(surveyed(part, classes, column), column, beside))
            for title, column in _titled(part).items()
        ),
    )


def _titled(part: Run) -> dict[str, Column]:
    """What the sections show, by their titles."""
    columns, excess = surveyed_columns(part), excess_column(part)
    share = next(iter(columns))
    above = {f"{excess.full_heading}, {share} % of the view": excess} if excess else {}
    return above | {f"{measure(column)}, {share} % of the view": column for share, column in columns.items()}


def _rows(
    methods: Sequence[Surveyed], column: Column, beside: Mapping[str, Sequence[Entry]]
) -> tuple[tuple[Entry, ...], ...]:
    fields = [_class_field(reached, column) for reached in zip(*(m.reached for m in methods), strict=True)]
    return tuple(
        (words(one.label), words(one.works_from), *(field[place] for field in fields), *beside[one.method])
        for place, one in enumerate(methods)
    )


def _heading(part: Run, key: str) -> Heading:
    column = part.catalogue.column(key)
    return Heading(head_text(column), key, meaning=column.meaning)


def _class_field(reached: Sequence[Reached | None], column: Column) -> list[Entry]:
    entries = [
        Entry(MISSING) if one is None else Entry(one.why) if one.why else number(one.average, column)
        for one in reached
    ]
    return with_best(entries, column, [entry.value is not None for entry in entries])


def _beside(run: Run, part: Run, results: Sequence[Result]) -> list[Entry]:
    """A method's rows under noisy poses, and its times, wherever in the run they were measured."""
    alike = {(r.cell.method, r.cell.options) for r in results}
    noisy = [r for r in results if r.pose in part.noisy_poses]
    timed = [r for r in run.results if (r.cell.method, r.cell.options) in alike]
    columns = [(run.catalogue.column(ROWS), noisy), *((run.catalogue.column(key), timed) for key in SPEED)]
    return [number(averaged(column, own).value, column) for column, own in columns]
