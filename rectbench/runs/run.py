"""What a run left behind, read once and made easy to ask."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from rectbench.errors import InvalidInput
from rectbench.experiments.pair_sources import PairSource, StatedPart
from rectbench.metrics.catalogue import Catalogue, known
from rectbench.runs.record import LEADING, PARQUET, RunRecord, read_record
from rectbench.runs.rows import Row, distinct, read_rows

EXACT_POSE = "exact"


@dataclass(frozen=True, eq=False)
class Run:
    """A run's folder: `record` is run.json; `results` are the rows of results.parquet, whose `table` it is.

    A part of a report is a Run too: the same record and table, the results of one `group`.
    """

    folder: Path
    record: RunRecord
    table: pd.DataFrame
    results: tuple[Row, ...]
    group: str = ""

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """Methods in the run's order."""
        return distinct(r.method for r in self.results)

    @cached_property
    def scenes(self) -> tuple[str, ...]:
        """Scenes in the run's order."""
        return distinct(r.scene for r in self.results)

    @cached_property
    def rigs(self) -> tuple[str, ...]:
        """Rigs in the run's order."""
        return distinct(r.rig for r in self.results)

    @cached_property
    def motions(self) -> tuple[str, ...]:
        """Motions in the run's order."""
        return distinct(r.motion for r in self.results)

    @cached_property
    def poses(self) -> tuple[str, ...]:
        """Levels of pose error in the run's order."""
        return distinct(r.pose for r in self.results)

    @cached_property
    def metrics(self) -> tuple[str, ...]:
        """Metrics measured in at least one cell, in the order of display."""
        return tuple(self.catalogue.in_display_order({key for r in self.results for key in r.metrics}))

    @cached_property
    def catalogue(self) -> Catalogue:
        """What is known of its columns: by the metrics of this machine, else by run.json."""
        return known().joined(self.record.columns)

    @cached_property
    def pair_source(self) -> PairSource:
        """Where its pairs come from."""
        return self.record.spec.pair_source

    @property
    def has_truth(self) -> bool:
        """Whether anybody knows the truth about its pairs, as nobody does about photographs."""
        return self.pair_source.has_truth

    @property
    def stated_part(self) -> StatedPart | None:
        """What the report states of this part; None of a whole run of several, and of a part that is new."""
        return next((part for part in self.pair_source.parts if part.name == self.group), None)

    @property
    def geometric_pose(self) -> str:
        """The pose under which distortion is shown: exact where the run has it."""
        return EXACT_POSE if EXACT_POSE in self.poses else self.poses[0]

    @property
    def noisy_poses(self) -> tuple[str, ...]:
        """The poses whose row errors tell methods apart; the exact one if there is no other."""
        return tuple(pose for pose in self.poses if pose != EXACT_POSE) or self.poses

    @property
    def stated_seconds(self) -> Mapping[str, float]:
        """Times that somebody else stated, by stage: `pose`, `fit`, `warp`."""
        return {str(stage): seconds for stage, seconds in self.record.spec.stated_seconds.items()}

    @property
    def failures(self) -> tuple[Row, ...]:
        """The cells without a measurement."""
        return tuple(r for r in self.results if not r.ok)

    @property
    def parts(self) -> tuple[Run, ...]:
        """The parts of the report in its order; the run itself where it has none."""
        groups = distinct(r.group for r in self.results)
        return (self,) if groups == ("",) else tuple(map(self.part, groups))

    def part(self, group: str) -> Run:
        """The results of one group."""
        return replace(self, results=self.select(group=group), group=group)

    def only(self, results: Iterable[Row]) -> Run:
        """The same with some of its results."""
        return replace(self, results=tuple(results))

    def select(self, results: Sequence[Row] | None = None, **wanted: Any) -> tuple[Row, ...]:
        """The results whose attributes equal `wanted`, e.g. `run.select(rig="t265", pose="exact")`."""
        pool = self.results if results is None else results
        return tuple(r for r in pool if all(getattr(r, name) == value for name, value in wanted.items()))


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
    return Run(folder, record, table, read_rows(table.to_dict("records"), path))
