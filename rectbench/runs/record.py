"""A run's folder: run.json, results.parquet and results.csv, each there whole or not at all."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import pandas as pd
from pydantic import BaseModel, ConfigDict, ValidationError

from rectbench.errors import InvalidInput
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.running import Execution
from rectbench.experiments.planning import Plan
from rectbench.experiments.selecting import Selection
from rectbench.experiments.spec import Report
from rectbench.experiments.tasks import CellTask
from rectbench.metrics.scoring import metrics_of
from rectbench.pairs.finding.photographs import UNREADABLE, Photographs
from rectbench.plugins.catalogue import Catalogue, known
from rectbench.plugins.cell import IDENTITY
from rectbench.plugins.metric import Column
from rectbench.registry import is_path
from rectbench.runs.machine import Machine
from rectbench.store.keys import canonical_json
from rectbench.writing import write_atomically

RUN_FILE, PARQUET, CSV = "run.json", "results.parquet", "results.csv"
VERSION: Literal[3] = 3
"""Of the layout of run.json."""
LEADING = (*IDENTITY, "status", "reason")
TEXTS = ("group", "notes")
"""Columns that are neither identity nor metric: the part of the report, what the method says of itself."""
SHOWN_CHARACTERS = 60


class _Frozen(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class FoundPair(_Frozen):
    """Two photographs and the files of their calibration, as seen from the folder they were found in."""

    name: str
    rig: str
    left: str
    right: str
    calibration: tuple[str, ...]


class LeftOutFile(_Frozen):
    """A file of that folder which no pair has, and why."""

    path: str
    reason: str


class FoundPhotographs(_Frozen):
    """What a run of photographs was made from."""

    pairs: tuple[FoundPair, ...]
    remarks: Mapping[str, tuple[str, ...]]
    """By rig: what was assumed of its calibration."""
    left_out: tuple[LeftOutFile, ...]

    @classmethod
    def of(cls, found: Photographs) -> FoundPhotographs:
        """The same in plain words."""
        below = found.below
        pairs = tuple(
            FoundPair(
                name=pair.name,
                rig=pair.calibration.name,
                left=below(pair.left),
                right=below(pair.right),
                calibration=tuple(map(below, pair.calibration.files)),
            )
            for pair in found.pairs
        )
        return cls(
            pairs=pairs,
            remarks={one.name: one.remarks for one in found.calibrations if one.remarks},
            left_out=tuple(LeftOutFile(path=below(out.path), reason=out.reason) for out in found.left_out),
        )


class RunRecord(Machine):
    """All that run.json says: what was to be run, what it ran on, and what it took."""

    version: Literal[3]
    report: str
    report_file: str | None
    """The absolute path of the report's file, where it was given as one."""
    command: str
    """The command line that makes this run again."""
    seeds: tuple[int, ...]
    selection: Selection
    is_whole: bool
    """Whether every cell of the report is among its cells, under the report's own options."""
    wall_s: float
    jobs: int
    threads_per_job: int
    dask: str | None
    spec: Report
    data: str | None
    """The folder of the photographs."""
    photographs: FoundPhotographs | None
    columns: Mapping[str, tuple[Column, ...]]
    """By topic: those of metrics that were given by their files, which may be gone when the run is read."""
    cells: tuple[CellTask, ...]
    """As they were planned; a row each."""

    @classmethod
    def of(cls, execution: Execution, wall_s: float, report_file: str | None = None) -> RunRecord:
        """The record of a plan that was executed on this machine."""
        plan, found = execution.plan, execution.plan.photographs
        return cls(
            version=VERSION,
            report=plan.report.name,
            report_file=report_file,
            command=_command(plan),
            seeds=tuple(sorted({task.cell.seed for task in plan.tasks})),
            selection=plan.selection,
            is_whole=plan.is_whole,
            wall_s=round(wall_s, 2),
            jobs=execution.jobs,
            threads_per_job=execution.threads_per_job,
            dask=execution.dask,
            spec=plan.report,
            data=None if found is None else str(found.folder),
            photographs=None if found is None else FoundPhotographs.of(found),
            columns=_foreign_columns(plan),
            cells=plan.tasks,
            **Machine.here().model_dump(),
        )

    def to_json(self, *without: str) -> str:
        """Its JSON, indented, the fields `without` left out."""
        return json.dumps(self.model_dump(mode="json", exclude=set(without)), indent=1, ensure_ascii=False)


def _foreign_columns(plan: Plan) -> Mapping[str, tuple[Column, ...]]:
    asked = dict.fromkeys(name for task in plan.tasks for name in task.metrics if is_path(name))
    return Catalogue.of(plugin.value for plugin in metrics_of(asked).values()).topics


def table_of(plan: Plan, outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """One row a cell, in the plan's order: identity, status, reason, metrics, notes."""
    rows = []
    for task, outcome in zip(plan.tasks, outcomes, strict=True):
        ended = {"status": outcome.status, "reason": outcome.reason}
        notes = json.dumps(dict(outcome.notes), sort_keys=True, default=str)
        rows.append(
            {**task.cell.model_dump(), **ended, "group": task.group, **outcome.metrics, "notes": notes}
        )
    catalogue = known().joined(_foreign_columns(plan))
    measured = {name for outcome in outcomes for name in outcome.metrics}
    metrics = catalogue.in_display_order(measured.union(catalogue.promised))
    table = pd.DataFrame(rows, columns=[*LEADING, "group", *metrics, "notes"])
    return table.astype({**dict.fromkeys(metrics, "float64"), "seed": "int64"})


def write_run(folder: Path, table: pd.DataFrame, record: RunRecord) -> None:
    """Write the three files; run.json last, so that it speaks of the results beside it.

    Raises Unavailable where the folder cannot be written.
    """
    write_atomically(folder / PARQUET, table.to_parquet(index=False))
    write_atomically(folder / CSV, table.to_csv(index=False))
    write_atomically(folder / RUN_FILE, record.to_json() + "\n")


def read_record(folder: Path) -> RunRecord:
    """run.json of a run's folder; raises InvalidInput where it cannot be read, with its first fault."""
    path = folder / RUN_FILE
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except NotADirectoryError:
        raise InvalidInput(f"{folder} is a file; expected a run's folder") from None
    except FileNotFoundError:
        raise InvalidInput(f"{folder} is no run's folder: {RUN_FILE} is missing") from None
    except (OSError, ValueError, RecursionError) as error:
        raise InvalidInput(f"{path} cannot be read: {error}; expected JSON") from None
    if not isinstance(found, dict):
        raise InvalidInput(f"{path} holds {_shown(found)}; expected an object")
    if found.get("version") != VERSION:
        version = _shown(found["version"]) if "version" in found else "nothing, as before there were versions"
        raise InvalidInput(
            f"{path}: version is {version}; expected {VERSION}, from a run made by this rectbench"
        )
    try:
        return RunRecord.model_validate(found)
    except ValidationError as error:
        raise InvalidInput(f"{path}: {first_fault(error)}") from None


def first_fault(error: ValidationError) -> str:
    """The first thing wrong with a file's values, in a line: key, value, what was expected."""
    fault = error.errors(include_url=False)[0]
    key = ".".join(map(str, fault["loc"]))
    if fault["type"] == "missing":
        return f"{key} is missing"
    said = " ".join(fault["msg"].removeprefix("Value error, ").split())
    expected = said.removeprefix("Input should be ")
    return f"{key} is {_shown(fault['input'])}; " + (f"expected {expected}" if expected != said else said)


def _shown(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= SHOWN_CHARACTERS else f"{text[:SHOWN_CHARACTERS]}..."


def unreadable_images(folder: Path) -> list[str]:
    """The images of a run of photographs that could not be read; none of other runs."""
    found = read_record(folder).photographs
    return [] if found is None else [out.path for out in found.left_out if out.reason == UNREADABLE]


def _command(plan: Plan) -> str:
    words = ["rectbench", "run", plan.report.name]
    if plan.photographs is not None:
        words += ["--data", shlex.quote(str(plan.photographs.folder))]
    for name in ("methods", "scenes", "rigs", "seeds"):
        chosen = getattr(plan.selection, name)
        if chosen is not None:
            words += [f"--{name}", ",".join(map(str, chosen))]
    if plan.selection.margin_deg is not None:
        words += ["--margin-deg", f"{plan.selection.margin_deg:g}"]
    for method, options in plan.selection.options.items():
        words += [f"--option {method}.{name}={canonical_json(value)}" for name, value in options.items()]
    return " ".join(words)
