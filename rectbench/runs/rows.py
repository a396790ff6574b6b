"""The rows of a run: a cell each, how it ended, and what was measured."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from pydantic import ConfigDict, Field, Json, ValidationError, field_validator

from rectbench.errors import InvalidInput
from rectbench.experiments.execution.outcomes import Status
from rectbench.plugins.cell import IDENTITY, Cell
from rectbench.plugins.matches import marked
from rectbench.plugins.result import Result, distinct
from rectbench.runs.record import first_fault

_ALIKE = {"scene", "rig", "motion", "pose", "seed", "status", "reason", "group", "notes"}
"""What a result has as the table holds it."""


class _StoredRow(Cell):
    """A row as a table holds it: every column that is not named here is a metric."""

    model_config = ConfigDict(frozen=True, extra="allow")
    __pydantic_extra__: dict[str, float]

    status: Status
    reason: str = ""
    group: str = ""
    notes: Json[dict[str, Any]] = Field(default_factory=dict)

    @field_validator("options")
    @classmethod
    def _is_an_object(cls, options: str) -> str:
        if not isinstance(json.loads(options), dict):
            raise ValueError("expected a JSON object")
        return options

    @property
    def cell(self) -> Cell:
        return Cell(**{name: getattr(self, name) for name in IDENTITY})


def read_rows(table: Iterable[Mapping[Any, Any]], path: Path) -> tuple[Result, ...]:
    """The rows of a table in the file `path`; raises InvalidInput for one that is none, with its first fault.

    Empty entries, NaN among them, count as left out.
    """
    stored = []
    for number, values in enumerate(table, 1):
        given = {str(name): value for name, value in values.items() if not _is_empty(value)}
        try:
            stored.append(_StoredRow.model_validate(given))
        except ValidationError as error:
            raise InvalidInput(f"{path}: row {number}: {first_fault(error)}") from None
    labels = {
        group: _method_labels([row for row in stored if row.group == group])
        for group in distinct(row.group for row in stored)
    }
    return tuple(
        Result(
            cell=row.cell,
            method=labels[row.group][_variant(row)],
            options=json.loads(row.options),
            metrics=row.model_extra or {},
            **row.model_dump(include=_ALIKE),
        )
        for row in stored
    )


def _is_empty(value: Any) -> bool:
    return bool(pd.api.types.is_scalar(value) and pd.isna(value))


_Variant = tuple[str, str, str]
"""Method, options, matches."""


def _variant(row: Cell) -> _Variant:
    return row.method, row.options, row.matches


def _method_labels(rows: Iterable[Cell]) -> dict[_Variant, str]:
    """A name for each variant: the method's own, with its options if these differ, true matches always."""
    variants = distinct(map(_variant, rows))
    count = Counter(method for method, _ in distinct(variant[:2] for variant in variants))
    return {
        (method, options, level): marked(method, level, *[_options_text(options)] * (count[method] > 1))
        for method, options, level in variants
    }


def _options_text(options: str) -> str:
    given = json.loads(options)
    return ", ".join(f"{name}={value}" for name, value in sorted(given.items())) or "default"
