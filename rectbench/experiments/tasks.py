"""What is to be done, as plain values that travel to other processes: a cell, and what it takes to run."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict

from rectbench.matching import USUAL_MATCHER
from rectbench.pairs.spec import PairSpec
from rectbench.plugins.cell import Cell


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
    """How many true matches the method is given, where it is given such."""
    matcher: str = USUAL_MATCHER
    """The dense matcher's name, or the absolute path of its file."""
    group: str = ""
    """The part of the report it belongs to."""
    alone: bool = False
    """Whether it runs with the machine to itself."""
