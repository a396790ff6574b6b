"""The tables of a run as a whole: its photographs, what failed."""

from __future__ import annotations

from collections.abc import Iterator

from rectbench.reporting.failures import failures_of
from rectbench.reporting.names import one_line, pair_labels
from rectbench.reporting.tables.captions import counted
from rectbench.reporting.tables.numbers import MISSING
from rectbench.reporting.tables.table import (
    Entry,
    Heading,
    Section,
    Table,
    number,
    text_heading,
    words,
)
from rectbench.reporting.tables.tabulation import heading, measured
from rectbench.runs.record import FoundPhotographs
from rectbench.runs.run import Run

COUNTED = ("pose_inliers", "row_error_features_matches", "row_error_board_points")

TROUBLE = ("contradiction", "no_features")
"""What the cells of a pair note about its images and calibration."""


def photograph_tables(run: Run) -> Iterator[Table]:
    """The pairs with their files, then the files of the folder that no pair has; none for rendered pairs."""
    found = run.record.photographs
    if found is None:
        return
    yield _pairs_table(run, found)
    if found.left_out:
        yield _left_out_table(found)


def _pairs_table(run: Run, found: FoundPhotographs) -> Table:
    files = {(pair.name, pair.rig): pair for pair in found.pairs}
    columns = measured(run, map(run.catalogue.column, COUNTED))
    rows = []
    for place, label in pair_labels(run).items():
        results = run.select(place=place)
        told = {name: str(text) for r in results for name, text in r.notes.items()}
        # A method that shows less of the view has fewer of them to be measured by.
        counts = [
            max((r.metrics[column.key] for r in results if column.key in r.metrics), default=None)
            for column in columns
        ]
        pair = files[place[0], place[1]]
        said = [*(told[name] for name in TROUBLE if name in told), *found.remarks.get(place[1], ())]
        rows.append(
            (
                words(one_line(label)),
                words(pair.left),
                words(pair.right),
                *map(number, counts, columns),
                words(told.get("board", MISSING)),
                words("; ".join(said)),
            )
        )
    return Table(
        kind="photographs",
        name="photographs",
        title="Photographs",
        caption="What is under the numbers: the images, what was found in them to measure with, and what was "
        "assumed about their calibration.",
        headings=(
            text_heading("pair"),
            text_heading("left"),
            text_heading("right"),
            *map(heading, columns),
            text_heading("board"),
            text_heading("remarks", wraps=True),
        ),
        sections=(Section("", tuple(rows)),),
    )


def _left_out_table(found: FoundPhotographs) -> Table:
    rows = tuple((words(out.path), words(out.reason)) for out in found.left_out)
    return Table(
        kind="left-out",
        name="left-out",
        title="Left out",
        caption="Images and calibrations in the folder that no pair of the report has.",
        headings=(text_heading("file"), text_heading("why", wraps=True)),
        sections=(Section("", rows),),
    )


def failures_table(run: Run) -> Table:
    """The cells without a measurement, their status, and the reason: once where several share it."""
    names: tuple[str, ...] = ("scene", "rig", "motion", "pose", "method", "seed", "status", "reason")
    if any(r.group for r in run.results):
        names = ("group", *names)
    rows = tuple(
        tuple(
            Entry(value or MISSING, value, failed=name == "status")
            for name, value in ((name, getattr(failure, name)) for name in names)
        )
        for failure in failures_of(run)
    )
    return Table(
        kind="failures",
        name="failures",
        title="Cells without a measurement",
        caption=f"{len(run.failures)} of {counted(len(run.results), 'cell')}.",
        headings=tuple(Heading(n, n, wraps=n in ("method", "reason")) for n in names),
        sections=(Section("", rows),),
    )
