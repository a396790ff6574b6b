"""How a cell or a pair ended, and which error means what."""

from __future__ import annotations

import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import cv2

from rectbench.errors import InvalidInput, InvalidResult, Unavailable, Unsupported

Status = Literal["ok", "unsupported", "unavailable", "invalid", "error", "crash", "timeout", "oom"]

LASTING: frozenset[Status] = frozenset({"ok", "unsupported", "invalid"})
"""What the same inputs give again. The others may be the machine's doing, and are tried anew."""


@dataclass(frozen=True)
class Outcome:
    """The status of a cell or pair, why it has it, and what was measured."""

    status: Status = "ok"
    reason: str = ""
    """One line; empty where the status is ok."""
    metrics: Mapping[str, float] = field(default_factory=dict)
    notes: Mapping[str, float | str] = field(default_factory=dict)
    """What the method has to say of its answer."""

    @property
    def ok(self) -> bool:
        """Whether it holds a measurement."""
        return self.status == "ok"


def outcome_of(error: BaseException) -> Outcome:
    """The outcome that an exception in a cell stands for."""
    reason = " ".join(str(error).encode("utf-8", "replace").decode("utf-8").split())
    match error:
        case Unsupported():
            return Outcome("unsupported", reason)
        case Unavailable():
            return Outcome("unavailable", reason)
        case InvalidResult() | InvalidInput():  # a plugin that builds its answer from bad numbers
            return Outcome("invalid", reason)
        case MemoryError():
            return Outcome("oom", reason or "out of memory")
        case cv2.error() if error.code == cv2.Error.StsNoMem:
            return Outcome("oom", reason)
        case _:
            return Outcome("error", f"{type(error).__name__}: {reason}{_place(error)}")


def _place(error: BaseException) -> str:
    """Where an unforeseen error was raised, so that its line can be found without a traceback."""
    frames = traceback.extract_tb(error.__traceback__)
    return f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
