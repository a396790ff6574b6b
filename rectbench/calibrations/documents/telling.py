"""What was assumed of a calibration, told in lines of the log once the calibration has been read."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

log = logging.getLogger("rectbench.calibrations")

_held: ContextVar[list[str] | None] = ContextVar("held", default=None)


def tell(line: str) -> None:
    """Log a line as a warning; within `telling`, when it ends."""
    held = _held.get()
    if held is None:
        log.warning("%s", line)
    elif line not in held:
        held.append(line)


@contextmanager
def telling() -> Iterator[None]:
    """Hold back what is told within, each line once, and log it at the end; what fails tells nothing else."""
    with told_already() as lines:
        yield
    for line in lines:
        tell(line)


@contextmanager
def told_already() -> Iterator[list[str]]:
    """Log nothing of what is told within: it was, when the same files were read before. Gives the lines."""
    lines: list[str] = []
    token = _held.set(lines)
    try:
        yield lines
    finally:
        _held.reset(token)
