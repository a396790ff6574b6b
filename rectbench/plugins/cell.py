"""Which cell a row is of: the columns that every row has."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Cell(BaseModel):
    """Which cell of which report: what its row and its random numbers are named after."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    report: str
    scene: str
    rig: str
    motion: str
    pose: str
    matches: str = ""
    """The level of the matches that the method works from; empty where it needs none."""
    method: str
    options: str
    """The options given, as canonical JSON; "{}" where all are the method's own."""
    seed: int


IDENTITY = tuple(Cell.model_fields)
"""The columns that say which cell a row is; `status` and `reason` follow, then the metrics."""
