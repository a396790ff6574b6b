"""What a run left behind: its cells and its facts, read once and made easy to ask."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from rectbench.errors import InvalidInput
from rectbench.metrics.catalogue import Catalogue, catalogue_of

IDENTITY = ("report", "scene", "rig", "motion", "pose", "method", "options", "seed", "status", "reason")
"""The columns that say which cell a row is and how it ended; all other numbers are metrics."""

EXACT_POSE = "exact"

Item = TypeVar("Item")


@dataclass(frozen=True)
class Result:
    """One cell of the run: a method on a pair, with its metrics (only finite or infinite ones)."""

    scene: str
    rig: str
    motion: str
    pose: str
    method: str
    seed: int
    status: str
    reason: str
    metrics: Mapping[str, float]
    notes: Mapping[str, Any]
    """What the method has to say of its answer."""
    options: Mapping[str, Any]
    """What the method was told."""
    group: str
    """The part of the report it belongs to; nothing in a report without parts."""
    row: Mapping[str, Any] = field(repr=False)

    @property
    def ok(self) -> bool:
        """Whether the cell holds a measurement."""
        return self.status == "ok"

    @property
    def pair(self) -> tuple[str, str, str, int]:
        """The images the cell is about: scene, rig, motion, seed."""
        return self.scene, self.rig, self.motion, self.seed

    @property
    def place(self) -> tuple[str, str, str]:
        """The pair without its seed: scene, rig, motion."""
        return self.scene, self.rig, self.motion

    @property
    def is_random_start(self) -> bool:
        """Whether it belongs to a study of random starts, and is no method of its own."""
        return self.options.get("start") == "random"


@dataclass(frozen=True)
class Run:
    """A run's folder: `facts` is run.json, `results` one entry a row of results.parquet.

    A part of a report is a Run too: the same facts, the results of one `group`.
    """

    folder: Path
    facts: Mapping[str, Any]
    results: tuple[Result, ...]
    group: str = ""

    @cached_property
    def methods(self) -> tuple[str, ...]:
        """Methods in the run's order."""
        return _distinct(r.method for r in self.results)

    @cached_property
    def scenes(self) -> tuple[str, ...]:
        """Scenes in the run's order."""
        return _distinct(r.scene for r in self.results)

    @cached_property
    def rigs(self) -> tuple[str, ...]:
        """Rigs in the run's order."""
        return _distinct(r.rig for r in self.results)

    @cached_property
    def motions(self) -> tuple[str, ...]:
        """Motions in the run's order."""
        return _distinct(r.motion for r in self.results)

    @cached_property
    def poses(self) -> tuple[str, ...]:
        """Levels of pose error in the run's order."""
        return _distinct(r.pose for r in self.results)

    @cached_property
    def metrics(self) -> tuple[str, ...]:
        """Metrics measured in at least one cell, in the order of display."""
        return tuple(self.catalogue.in_display_order({key for r in self.results for key in r.metrics}))

    @cached_property
    def catalogue(self) -> Catalogue:
        """What is known of its columns: by the metrics of this machine, else by run.json."""
        return catalogue_of(self.facts.get("columns"))

    @property
    def is_of_photographs(self) -> bool:
        """Whether its pairs are photographs, about which nobody knows the truth."""
        spec = self.facts.get("spec")
        return bool(spec.get("photographs")) if isinstance(spec, Mapping) else False

    @property
    def geometric_pose(self) -> str:
        """The pose under which distortion is shown: exact where the run has it."""
        return EXACT_POSE if EXACT_POSE in self.poses else self.poses[0]

    @property
    def noisy_poses(self) -> tuple[str, ...]:
        """The poses whose row errors say something; the exact one if there is no other."""
        return tuple(pose for pose in self.poses if pose != EXACT_POSE) or self.poses

    @property
    def failures(self) -> tuple[Result, ...]:
        """The cells without a measurement."""
        return tuple(r for r in self.results if not r.ok)

    @property
    def report(self) -> str:
        """The report's name."""
        names = _distinct(str(r.row["report"]) for r in self.results if r.row.get("report"))
        return names[0] if names else str(self.facts.get("report", self.folder.name))

    @property
    def parts(self) -> tuple[Run, ...]:
        """The parts of the report in its order; the run itself where it has none."""
        groups = _distinct(r.group for r in self.results)
        return (self,) if groups == ("",) else tuple(map(self.part, groups))

    def part(self, group: str) -> Run:
        """The results of one group."""
        return replace(self, results=self.select(group=group), group=group)

    def only(self, results: Iterable[Result]) -> Run:
        """The same with some of its results."""
        return replace(self, results=tuple(results))

    def select(self, results: Sequence[Result] | None = None, **wanted: Any) -> tuple[Result, ...]:
        """The results whose attributes equal `wanted`, e.g. `run.select(rig="t265", pose="exact")`."""
        pool = self.results if results is None else results
        return tuple(r for r in pool if all(getattr(r, name) == value for name, value in wanted.items()))


def read_run(folder: Path) -> Run:
    """Read run.json and results.parquet of a run's folder.

    Raises InvalidInput for a folder without them, or with rows that lack the identity columns.
    """
    facts_path, rows_path = folder / "run.json", folder / "results.parquet"
    for path in (facts_path, rows_path):
        if not path.is_file():
            raise InvalidInput(f"{folder} is no run's folder: {path.name} is missing")
    try:
        facts = json.loads(facts_path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise InvalidInput(f"{facts_path} is no JSON: {error}") from None
    if not isinstance(facts, dict):
        raise InvalidInput(f"{facts_path} holds a {type(facts).__name__}; expected an object")
    rows = _read_rows(rows_path)
    if not rows:
        raise InvalidInput(f"{rows_path} has no rows; there is nothing to report")
    return Run(folder, facts, tuple(_results(rows, rows_path)))


def _read_rows(path: Path) -> list[dict[str, Any]]:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        rows: list[dict[str, Any]] = pq.read_table(path).to_pylist()
    except (OSError, pa.ArrowException) as error:
        raise InvalidInput(f"{path} cannot be read as Parquet: {str(error).splitlines()[0]}") from None
    return rows


def _results(rows: list[dict[str, Any]], path: Path) -> Iterable[Result]:
    groups = _distinct(map(_group, rows))
    labels = {group: _method_labels([row for row in rows if _group(row) == group]) for group in groups}
    for row in rows:
        missing = [name for name in ("scene", "rig", "method", "status") if row.get(name) is None]
        if missing:
            raise InvalidInput(f"{path} has a row without {missing[0]}; expected one row a cell")
        yield Result(
            scene=str(row["scene"]),
            rig=str(row["rig"]),
            motion=str(row.get("motion") or "as-calibrated"),
            pose=str(row.get("pose") or EXACT_POSE),
            method=labels[_group(row)][_variant(row)],
            seed=int(row.get("seed") or 0),
            status=str(row["status"]),
            reason=str(row.get("reason") or ""),
            metrics={name: float(value) for name, value in row.items() if _is_metric(name, value)},
            notes=_json_object(row.get("notes")),
            options=_json_object(row.get("options")),
            group=_group(row),
            row=row,
        )


def _is_metric(name: str, value: Any) -> bool:
    if name in IDENTITY or isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return not math.isnan(value)


def _group(row: Mapping[str, Any]) -> str:
    return str(row.get("group") or "")


def _variant(row: Mapping[str, Any]) -> tuple[str, str]:
    return str(row["method"]), str(row.get("options") or "")


def _method_labels(rows: list[dict[str, Any]]) -> dict[tuple[str, str], str]:
    """A name for each (method, options): the method's own unless the run has several variants of it."""
    variants = _distinct(_variant(row) for row in rows if row.get("method") is not None)
    count: dict[str, int] = {}
    for method, _ in variants:
        count[method] = count.get(method, 0) + 1
    return {
        (method, options): method if count[method] == 1 else f"{method} {_options_text(options)}".strip()
        for method, options in variants
    }


def _options_text(options: str) -> str:
    given = _json_object(options)
    return "(" + (", ".join(f"{name}={value}" for name, value in sorted(given.items())) or "default") + ")"


def _json_object(text: Any) -> dict[str, Any]:
    """The object in a text column, empty where there is none."""
    try:
        value = json.loads(text or "{}")
    except (TypeError, ValueError):
        return {}
    return value if isinstance(value, dict) else {}


def _distinct(items: Iterable[Item]) -> tuple[Item, ...]:
    return tuple(dict.fromkeys(items))
