"""What a run left behind, read once and made easy to ask."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from rectbench.errors import InvalidInput
from rectbench.experiments.pair_sources import PairSource, StatedPart
from rectbench.plugins.catalogue import known
from rectbench.plugins.result import Part, Result, distinct
from rectbench.runs.record import LEADING, PARQUET, RunRecord, read_record
from rectbench.runs.rows import read_rows


@dataclass(frozen=True, eq=False, kw_only=True)
class Run(Part):
    """A run's folder: `record` is run.json; `results` are the rows of results.parquet, whose `table` it is.

    A part of a report is a Run too: the same record and table, the results of one `group`.
    """

    folder: Path
    record: RunRecord
    table: pd.DataFrame

    @property
    def pair_source(self) -> PairSource | None:
        """Where the pairs of this part come from; None of a run of several, and of a part that is new."""
        return next((one for one in self.record.spec.sources if one.part.name == self.group), None)

    @property
    def stated_part(self) -> StatedPart | None:
        """What the report states of this part; None as above."""
        return None if self.pair_source is None else self.pair_source.part

    @property
    def parts(self) -> tuple[Run, ...]:
        """The parts of the report in its order; the run itself where it has none."""
        groups = distinct(r.group for r in self.results)
        return (self,) if groups == ("",) else tuple(map(self.part, groups))

    def part(self, group: str) -> Run:
        """The results of one group."""
        return replace(self, results=self.select(group=group), group=group)

    def only(self, results: Iterable[Result]) -> Run:
        """The same with some of its results."""
        return replace(self, results=tuple(results))


def read_run(folder: Path) -> Run:
    """Read run.json and results.parquet of a run's folder.

    Raises InvalidInput, in a line, for a folder without them and for files that are not what a run writes.
    """
    record, path = read_record(folder), folder / PARQUET
    if not path.is_file():
        raise InvalidInput(f"{folder} is no run's folder: {PARQUET} is missing")
    try:
        table = pd.read_parquet(path)
    except Exception as error:  # a damaged file may make Arrow raise anything
        fault = " ".join(str(error).split())
        raise InvalidInput(f"{path} cannot be read: {fault}; expected Parquet") from None
    if missing := [name for name in LEADING if name not in table]:
        raise InvalidInput(f"{path} lacks the column {missing[0]}")
    if table.empty:
        raise InvalidInput(f"{path} has no rows; expected one a cell")
    spec = record.spec
    return Run(
        folder=folder,
        record=record,
        table=table,
        results=read_rows(table.to_dict("records"), path),
        catalogue=known().joined(record.columns),
        has_truth=all(source.has_truth for source in spec.sources),
        stated_seconds={str(stage): seconds for stage, seconds in spec.stated_seconds.items()},
    )
