"""What is to be done, as plain values that travel to other processes: a cell, and what it takes to run."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict

from rectbench.pairs.spec import PairSpec


class Cell(BaseModel):
    """Which cell of which report: what its row and its random numbers are named after."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    report: str
    scene: str
    rig: str
    motion: str
    pose: str
    method: str
    options: str
    """The options given, as canonical JSON; "{}" where all are the method's own."""
    seed: int


IDENTITY = tuple(Cell.model_fields)
"""The columns that say which cell a row is; `status` and `reason` follow, then the metrics."""


class CellTask(BaseModel):
    """All that a process needs to know to run one cell."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    cell: Cell
    pair: PairSpec
    method_source: str
    """The method's name, or the absolute path of its file."""
    options: dict[str, Any]
    metrics: tuple[str, ...]
    match_count: int
    match_noise_px: float
    group: str = ""
    """The part of the report it belongs to."""
    alone: bool = False
    """Whether it runs with the machine to itself."""
