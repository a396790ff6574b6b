"""Whether a run is as good as the numbers accepted for its report.

A gate that measured nothing does not pass, a cell that failed is not skipped, and a run that left
cells out is incomplete rather than good. Times differ from machine to machine and are not compared.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from rectbench.errors import InvalidInput, UnknownName, argument
from rectbench.experiments.spec import REPORTS
from rectbench.pairs.spec import ESTIMATED
from rectbench.plugins.cell import IDENTITY, Cell
from rectbench.plugins.matches import marked
from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.registry import registry
from rectbench.runs.record import read_record
from rectbench.runs.rows import read_rows
from rectbench.runs.run import read_run
from rectbench.writing import write_atomically

KEY = [name for name in IDENTITY if name != "report"]

GOOD, REGRESSION, INCOMPLETE = 0, 1, 3


ESTIMATED_SLACK = 10.0
"""How many times as far off a column may be where the pose was found in the images: a feature more or less,
and all that follows from the pose moves a little."""


@dataclass
class Gating:
    """What a gate found, a line each."""

    compared: int = 0
    """Cells that were measured and have accepted numbers."""
    regressions: list[str] = field(default_factory=list)
    incomplete: list[str] = field(default_factory=list)
    improvements: list[str] = field(default_factory=list)
    new: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        """0 good, 1 a regression, 3 incomplete or nothing measured."""
        if self.regressions:
            return REGRESSION
        return INCOMPLETE if self.incomplete or not self.compared else GOOD


def accepted_path(run_dir: Path) -> Path:
    """Where the accepted numbers of the run's report lie: beside the report's file."""
    record = read_record(run_dir)
    if record.photographs is not None:
        raise InvalidInput(
            f"{run_dir} is a run of photographs, whose numbers are not the report's; expected a file of "
            f"their own, {argument('accepted')}"
        )
    try:
        report = registry(REPORTS).get(record.report).path
    except UnknownName:
        if record.report_file is None:
            raise
        report = Path(record.report_file)
    return report.with_suffix(".accepted.csv")


def accept(run_dir: Path, path: Path) -> int:
    """Make the run's numbers the accepted ones; returns how many cells they hold.

    Raises InvalidInput for a run that measured nothing or was no whole run of its report.
    """
    run = read_run(run_dir)
    if not any(row.ok for row in run.results):
        raise InvalidInput(f"{run_dir} measured nothing; there is nothing to accept")
    if not run.record.is_whole:
        raise InvalidInput(f"{run_dir} is a part of its report; expected a run without a selection")
    gated = [column.key for column in run.catalogue.gated]
    columns = [name for name in gated if name in run.table and run.table[name].notna().any()]
    table = run.table[[*KEY, "status", *columns]]
    write_atomically(path, table.to_csv(index=False, float_format="%.9g"))
    return len(table)


def gate(run_dir: Path, path: Path) -> Gating:
    """Compare a run with the accepted numbers in the file `path`.

    Raises InvalidInput where either cannot be read.
    """
    run, accepted = read_run(run_dir), _read_accepted(path)
    columns = [column for column in run.catalogue.gated if column.key in accepted]
    now = _by_cell(run.results)
    known = _by_cell(read_rows(accepted.to_dict("records"), path))
    gating = Gating()
    unknown = set(map(str, accepted)) - {*IDENTITY, "status", *(column.key for column in columns)}
    gating.incomplete += [f"{name}: no metric of the run has this column" for name in sorted(unknown)]
    for cell, row in known.items():
        if cell in now:
            _compare(row, now[cell], columns, gating)
        else:
            missing = gating.regressions if run.record.is_whole else gating.incomplete
            missing.append(f"{_name(row)}: the cell is missing")
    gating.new += [f"{_name(row)}: no accepted numbers" for cell, row in now.items() if cell not in known]
    return gating


def _compare(known: Result, now: Result, columns: Sequence[Column], gating: Gating) -> None:
    if known.status != now.status:
        kind = gating.improvements if now.ok else gating.regressions
        because = f" ({now.reason})" if now.reason else ""
        kind.append(f"{_name(known)}: status {known.status} -> {now.status}{because}")
        return
    if not now.ok:
        return
    gating.compared += 1
    slack = ESTIMATED_SLACK if known.pose == ESTIMATED else 1.0
    for column in columns:
        accepted, value = (row.metrics.get(column.key, math.nan) for row in (known, now))
        change = column.change(accepted, value, slack)
        if change != "same":
            kind = gating.improvements if change == "better" else gating.regressions
            kind.append(f"{_name(known)}: {column.key} {accepted:.6g} -> {value:.6g}")


def _read_accepted(path: Path) -> pd.DataFrame:
    if not path.is_file():
        raise InvalidInput(
            f"there are no accepted numbers at {path}; `rectbench gate RUN --accept` makes them"
        )
    texts = dict.fromkeys([*KEY, "status"], str)
    try:
        table = pd.read_csv(path, dtype=texts, keep_default_na=False, na_values=[""])
    except (OSError, ValueError) as error:
        raise InvalidInput(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    if missing := [name for name in texts if name not in table]:
        raise InvalidInput(
            f"{path} lacks the column {missing[0]}; `rectbench gate RUN --accept` makes it anew"
        )
    return table.assign(report="")


def _by_cell(rows: Iterable[Result]) -> dict[Cell, Result]:
    """The rows by what they are of, whichever report they stand in."""
    return {row.cell.model_copy(update={"report": ""}): row for row in rows}


def _name(row: Result) -> str:
    variant = [f"{name}={value}" for name, value in row.options.items()]
    place = f"{row.scene}/{row.rig}/{row.motion}/{row.pose}/seed {row.seed}"
    return f"{marked(row.cell.method, row.cell.matches, *variant)} on {place}"
