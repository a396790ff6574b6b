"""Progress bars with the time left, on a terminal's stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Advance = Callable[[], None]


class Progress:
    """Where a run tells how far it is; this one tells nobody."""

    @contextmanager
    def stage(self, title: str, total: int) -> Iterator[Advance]:
        """A stretch of `total` steps; call what it gives after each."""
        yield lambda: None


class Bars(Progress):
    """One bar a stage, with the time left."""

    @contextmanager
    def stage(self, title: str, total: int) -> Iterator[Advance]:
        from rich import progress
        from rich.console import Console

        columns = (
            progress.TextColumn("{task.description:<9}"),
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            progress.TimeElapsedColumn(),
            progress.TextColumn("left"),
            progress.TimeRemainingColumn(),
        )
        with progress.Progress(*columns, console=Console(stderr=True)) as bars:
            bar = bars.add_task(title, total=total)
            yield lambda: bars.advance(bar)


def progress_for(wanted: bool | None) -> Progress:
    """Bars if wanted, none if not; where nothing is said, bars on a terminal alone."""
    shown = sys.stderr.isatty() if wanted is None else wanted
    return Bars() if shown else Progress()
