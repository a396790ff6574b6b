"""What the design of a run can tell, and how many rigs, scenes and seeds would tell more."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import pandas as pd

from rectbench.errors import InvalidInput, UnknownName, argument
from rectbench.pairs.spec import NO_SCENE
from rectbench.plugins.metric import METRICS, Column
from rectbench.plugins.result import EXACT_POSE, distinct
from rectbench.registry import registry
from rectbench.runs.run import Run, read_run
from rectbench.runs.units import Place, by_place, floor_of
from rectbench.statistics.components import Spread
from rectbench.statistics.design import Needs
from rectbench.statistics.intervals import LEAST_UNITS, counted, ratio
from rectbench.statistics.paired import TIE
from rectbench.statistics.power import resolved

NESTED = ("motion", "scene", "seed")
"""The levels within a rig, as `Place` has them."""
OF_NOISY_POSES = ("Row error", "Reconstruction")
"""Topics that tell methods apart by how they carry an error of the pose."""
COLUMNS = [
    *("part", "pose", "a", "b", "rigs", "ratio", "low", "high", "resolves", "rigs_needed"),
    *(f"{level}s{what}" for level in NESTED for what in ("", "_needed", "_share")),
    "reason",
]


@dataclass(frozen=True)
class Design:
    """What a run's design tells apart, and what would tell a difference of `detect`.

    Parameters
    ----------
    column : whose values are compared, by their ratios on the same pair and seed.
    detect : the relative difference to be told, such as 0.02.
    table : a row for each pair of methods `a`, `b` of a part of the report under a pose: `rigs` that both
        have values on; the geometric mean over these of the `ratio` a / b, and the ends `low`, `high` of
        its 95 % interval; the ratio that the design `resolves` in four benches of five at Holm-corrected
        5 %; `rigs_needed` for `detect` with motions, scenes and seeds as they are; `scenes` (of a motion of
        a rig; 0 of pairs without one), `scenes_needed` with all else as it is, missing where no number of
        them is enough on so few rigs, and their `scenes_share` of the variance between rigs, NaN where none
        has a second one; likewise motions and seeds (0 where a seed draws nothing). `reason` says why a row
        has no numbers.
    """

    column: Column
    detect: float
    table: pd.DataFrame

    @property
    def planned(self) -> pd.DataFrame:
        """The rows that have numbers."""
        return self.table[self.table["reason"] == ""]


def design(folder: Path, detect: float, metric: str | None = None) -> Design:
    """The design of a run, for one of its columns; by default the one that methods are ranked by.

    Raises InvalidInput for a folder that holds no run, for a column with numbers below zero, of which there
    are no ratios, and where no two methods have it; UnknownName for one that there is not.
    """
    run = read_run(folder)
    column = run.catalogue.ranking if metric is None else _column(run, metric)
    rows = [
        row
        for part in run.parts
        for pose in _poses(part, column)
        for row in _rows(part, pose, column, detect)
    ]
    if not rows:
        raise InvalidInput(f"{folder} has {column.key} of {_how_many(run, column)}; expected two to compare")
    table = pd.DataFrame(rows, columns=COLUMNS)
    whole = {name: "Int64" for name in COLUMNS if name.endswith("needed") or name in ("rigs", *_COUNTS)}
    return Design(column, detect, table.astype(whole))


_COUNTS = tuple(f"{level}s" for level in NESTED)


def _column(run: Run, key: str) -> Column:
    """The run's column of this key; a metric's name is told its columns."""
    if key in run.metrics:
        return run.catalogue.column(key)
    metrics = registry(METRICS)
    if key in metrics.names():
        own = [column.key for column in metrics.get(key).value.columns if column.key in run.metrics]
        if own:
            raise InvalidInput(
                f"{argument('metric')} is {key}, of several numbers; expected one of {', '.join(own)}"
            )
    if any(column.key == key for column in run.catalogue.columns):
        whose = "`rectbench list metrics` tells which metric has it"
        raise InvalidInput(f"{run.folder} has no {key}, which its report does not measure; {whose}")
    raise UnknownName("metric", key, run.metrics)


def _how_many(run: Run, column: Column) -> str:
    return "one method alone" if column.key in run.metrics else "no method"


def _is_of_noise(part: Run, column: Column) -> bool:
    topic = next((name for name, columns in part.catalogue.topics.items() if column in columns), "")
    return topic in OF_NOISY_POSES


def _poses(part: Run, column: Column) -> tuple[str, ...]:
    """Under which poses the column tells methods apart."""
    return part.noisy_poses if _is_of_noise(part, column) else (part.geometric_pose,)


def _rows(part: Run, pose: str, column: Column, detect: float) -> Iterator[dict[str, Any]]:
    numbers = {m: own for m, own in by_place(part.select(pose=pose), column).items() if own}
    pairs = list(combinations(numbers, 2))
    draws_for_all = pose != EXACT_POSE or _is_of_noise(part, column)
    drawing = {result.method for result in part.select(pose=pose) if result.cell.matches}
    for a, b in pairs:
        logs = _log_ratios(numbers[a], numbers[b], column)
        row: dict[str, Any] = {"part": part.group, "pose": pose, "a": a, "b": b}
        rigs = len(distinct(place[0] for place in logs))
        if rigs < LEAST_UNITS:
            yield {**row, "rigs": rigs, "reason": f"{counted(rigs, 'rig')} in common: too few to plan from"}
            continue
        row |= {"rigs": rigs, "reason": "", **_planned(Spread.of(logs), math.log1p(detect), len(pairs))}
        if {scene for _, _, scene, _ in logs} == {NO_SCENE}:
            row |= {"scenes": 0, "scenes_needed": None, "scenes_share": 0.0}
        if row["seeds"] == 1 and not (draws_for_all or {a, b} & drawing):
            row |= {"seeds": 0, "seeds_needed": None, "seeds_share": 0.0}
        yield row


def _planned(spread: Spread, difference: float, tests: int) -> dict[str, Any]:
    needs = Needs.of(spread, difference, tests)
    row = {
        "ratio": ratio(spread.mean),
        "low": ratio(spread.interval.low),
        "high": ratio(spread.interval.high),
        "resolves": ratio(resolved(math.sqrt(spread.variance), spread.units, tests)),
        "rigs_needed": needs.units,
    }
    for name, level, needed in zip(_COUNTS, spread.levels, needs.levels, strict=True):
        share = level.added / spread.variance if spread.variance else 0.0
        row |= {name: level.count, f"{name}_needed": needed, f"{name}_share": min(share, 1.0)}
    return row


def _log_ratios(a: Mapping[Place, float], b: Mapping[Place, float], column: Column) -> dict[Place, float]:
    """Of the places where both have a finite number; what is below the column's floor counts as that."""
    floor, found = floor_of(column), {}
    for place in a.keys() & b.keys():
        if min(a[place], b[place]) < 0:
            least = min(a[place], b[place])
            raise InvalidInput(
                f"{column.key} is {least:g} somewhere; expected numbers from 0 on, that have ratios"
            )
        if math.isfinite(a[place]) and math.isfinite(b[place]):
            log = math.log(max(a[place], floor) / max(b[place], floor))
            found[place] = 0.0 if abs(log) <= TIE else log
    return dict(sorted(found.items()))
