"""Progress bars with the time left, on a terminal's stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Advance = Callable[[], None]


class Progress:
    """Where a run tells how far it is; this one tells nobody."""

    @contextmanager
    def stage(self, title: str, total: int) -> Iterator[Advance]:
        """A stretch of `total` steps; call what it gives after each."""
        yield lambda: None


class Bars(Progress):
    """One bar a stage, with the time left; stages may run at once."""

    def __init__(self) -> None:
        self._shown: Any = None
        """rich's display, while a stage runs: a terminal has room for one."""

    @contextmanager
    def stage(self, title: str, total: int) -> Iterator[Advance]:
        if not total:
            yield lambda: None
            return
        with self._display() as bars:
            bar = bars.add_task(title, total=total)
            yield lambda: bars.advance(bar)

    @contextmanager
    def _display(self) -> Iterator[Any]:
        """The display of the stages that run, or a new one."""
        from rich import progress
        from rich.console import Console

        if self._shown is not None:
            yield self._shown
            return
        columns = (
            progress.TextColumn("{task.description:<9}"),
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            progress.TimeElapsedColumn(),
            progress.TextColumn("left"),
            progress.TimeRemainingColumn(),
        )
        with progress.Progress(*columns, console=Console(stderr=True)) as self._shown:
            try:
                yield self._shown
            finally:
                self._shown = None


def progress_for(wanted: bool | None) -> Progress:
    """Bars if wanted, none if not; where nothing is said, bars on a terminal alone."""
    shown = sys.stderr.isatty() if wanted is None else wanted
    return Bars() if shown else Progress()
