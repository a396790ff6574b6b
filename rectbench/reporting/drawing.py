"""Drawing the figures of a run: here, or in worker processes and from the store."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from rectbench.errors import Unavailable
from rectbench.experiments.execution.cells import DESK
from rectbench.experiments.execution.outcomes import Outcome
from rectbench.experiments.execution.pool import Job, Workers
from rectbench.pairs.rendering import give_memory_back
from rectbench.reporting.figures import (
    EXTENSIONS,
    Draw,
    PlacedDrawing,
    draw_files,
    placed_drawings,
    what_failed,
)
from rectbench.reporting.sources import sources_of
from rectbench.runs.record import PARQUET, RUN_FILE
from rectbench.runs.run import Run, read_run
from rectbench.store.keys import digest, file_digest
from rectbench.store.store import Store
from rectbench.writing import write_atomically

FIGURES = "figures"
"""What the store calls the files of a figure."""
TIMEOUT_S = 900.0
FEW = 2
"""So many figures are drawn sooner than a worker process starts."""


def draw_here(folder: Path) -> Draw:
    """Draw into the folder one after the other, in this process."""

    def draw(drawings: Sequence[PlacedDrawing]) -> Iterator[tuple[PlacedDrawing, str]]:
        for placed in drawings:
            yield placed, _attempt(folder, placed)

    return draw


def draw_in_workers(run: Run, workers: Workers) -> Draw:
    """Draw into the run's folder in worker processes; what the store has is copied from there."""

    def draw(drawings: Sequence[PlacedDrawing]) -> Iterator[tuple[PlacedDrawing, str]]:
        store, gallery = Store.default(), _Gallery.of(run)
        wanted = []
        for placed in drawings:
            if gallery.copy(placed, store):
                yield placed, ""
            else:
                wanted.append(placed)
        if len(wanted) <= FEW:
            for placed in wanted:
                yield placed, gallery.draw(placed, store)
            return
        wanted.sort(key=lambda placed: not placed.drawing.of)  # what takes long, a rig's pictures, first
        jobs = [_job(placed, gallery.folder, store) for placed in wanted]
        for position, outcome in workers.run(jobs):
            yield wanted[position], outcome.reason

    return draw


def _job(placed: PlacedDrawing, folder: Path, store: Store) -> Job:
    """A rig's pictures go to one worker, which then finds its pair and fits its methods once."""
    group = placed.drawing.of or placed.name
    return Job(draw_one, (folder, placed.name, placed.digest, store.root), TIMEOUT_S, (group,))


def draw_one(folder: Path, name: str, expected: str, store_root: Path) -> Outcome:
    """Draw the figure of that name of the run in a folder, in a worker process, and store its files."""
    gallery, drawings = _opened(folder, file_digest(folder / RUN_FILE))
    placed = drawings.get(name)
    if placed is None or placed.digest != expected:
        return Outcome("error", f"{name} differs from one process to another; expected the same data in all")
    error = gallery.draw(placed, Store(store_root))
    give_memory_back()
    return Outcome("error", error) if error else Outcome()


@lru_cache(maxsize=1)
def _opened(folder: Path, version: str) -> tuple[_Gallery, Mapping[str, PlacedDrawing]]:
    """The run in a folder and its drawings by name, opened once a worker; `version` tells two runs apart."""
    DESK.clear()  # the pair of the last cell is not needed any more
    run = read_run(folder)
    return _Gallery.of(run), {placed.name: placed for placed in placed_drawings(run, sources_of(run))}


@dataclass(frozen=True)
class _Gallery:
    """The figures of one run in its folder, and in the store for other folders with the same run."""

    folder: Path
    run: str
    """Digest of all that a figure may show: the rows, what they are a run of, what their columns mean."""

    @classmethod
    def of(cls, run: Run) -> _Gallery:
        stated = run.record.model_dump(mode="json", include={"spec", "columns", "cells"})
        return cls(run.folder.absolute(), digest([file_digest(run.folder / PARQUET), stated]))

    def copy(self, placed: PlacedDrawing, store: Store) -> bool:
        """Copy a figure's files from the store; False where it has none."""
        stored = store.read(FIGURES, self._inputs(placed))
        if stored is None:
            return False
        for extension in EXTENSIONS:
            write_atomically(
                self.folder / placed.path(extension), (stored / f"figure.{extension}").read_bytes()
            )
        return True

    def draw(self, placed: PlacedDrawing, store: Store) -> str:
        """Draw a figure and store its files; returns what went wrong, or nothing."""
        error = _attempt(self.folder, placed)
        if not error:
            with suppress(Unavailable):  # a full disk: the figure itself is there
                store.write(FIGURES, self._inputs(placed), lambda place: self._give(placed, place))
        return error

    def _give(self, placed: PlacedDrawing, place: Path) -> None:
        for extension in EXTENSIONS:
            drawn = (self.folder / placed.path(extension)).read_bytes()
            (place / f"figure.{extension}").write_bytes(drawn)

    def _inputs(self, placed: PlacedDrawing) -> dict[str, str]:
        return {"drawing": placed.digest, "run": self.run}


def _attempt(folder: Path, placed: PlacedDrawing) -> str:
    """Draw a figure into the folder; returns what went wrong, or nothing."""
    try:
        draw_files(folder, placed)
    except Exception as failure:  # a plugin may raise anything
        return what_failed(failure)
    return ""
