"""The content-addressed store of rendered pairs and finished cells.

An object is a folder of files under its key, with a manifest of their digests. It is written beside
its place and moved there whole, so that a reader sees all of it or nothing, whenever the writer is
killed; it is checked when read, and dropped where it is damaged. Nobody waits for the disk: what a killed
process has written is the system's to keep, and where the machine itself goes down, the digests tell what
never reached the disk, which is then made again. No pickle: `.npz`, PNG and JSON.
"""

from __future__ import annotations

import json
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock
from platformdirs import user_cache_path

from rectbench.errors import Unavailable
from rectbench.store.keys import Inputs, digest, file_digest

STORE_VARIABLE = "RECTBENCH_STORE"
MANIFEST = "manifest.json"
ABANDONED_AFTER_S = 24 * 3600.0
"""Age from which an unfinished object is no running writer's any more."""

log = logging.getLogger("rectbench.store")


@dataclass(frozen=True)
class Entry:
    """One stored object."""

    path: Path
    size_bytes: int
    used: float
    """When it was last read or written, seconds since the epoch."""


@dataclass(frozen=True)
class Store:
    """Objects by kind and key under `root`."""

    root: Path

    @staticmethod
    def default() -> Store:
        """The store at RECTBENCH_STORE, else in the user's cache folder."""
        chosen = os.environ.get(STORE_VARIABLE)
        return Store(Path(chosen).expanduser().absolute() if chosen else user_cache_path("rectbench"))

    def place(self, kind: str, inputs: Inputs) -> Path:
        """The folder of the object made from `inputs`, whether it exists or not."""
        key = digest(inputs)
        return self.root / kind / key[:2] / key

    def has(self, kind: str, inputs: Inputs) -> bool:
        """Whether the object is there, its files unchecked."""
        return (self.place(kind, inputs) / MANIFEST).is_file()

    def read(self, kind: str, inputs: Inputs) -> Path | None:
        """The folder of a sound object; None where there is none, or where it was damaged and dropped."""
        place = self.place(kind, inputs)
        try:
            manifest = json.loads((place / MANIFEST).read_bytes())
            wrong = [name for name, known in manifest["files"].items() if file_digest(place / name) != known]
        except OSError as error:
            if not place.exists():
                return None
            wrong = [Path(error.filename or MANIFEST).name]
        except (ValueError, KeyError, TypeError, AttributeError):
            wrong = [MANIFEST]
        if wrong:
            log.warning("%s is damaged (%s); it is made again", place, ", ".join(wrong))
            self.drop(place)
            return None
        os.utime(place / MANIFEST)
        return place

    def write(self, kind: str, inputs: Inputs, fill: Callable[[Path], None]) -> Path:
        """Store the object whose files `fill(folder)` writes; an equal object already there stays.

        Raises Unavailable where the disk takes no more.
        """
        place = self.place(kind, inputs)
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            unfinished = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=place.parent))
            try:
                fill(unfinished)
                files = sorted(unfinished.iterdir())
                manifest = {
                    "files": {file.name: file_digest(file) for file in files},
                    "made_from": dict(inputs),
                }
                (unfinished / MANIFEST).write_text(json.dumps(manifest, indent=1), encoding="utf-8")
                _move(unfinished, place)
            finally:
                shutil.rmtree(unfinished, ignore_errors=True)
        except OSError as error:
            raise self._unwritable(error) from error
        return place

    def write_text(self, kind: str, inputs: Inputs, name: str, text: str) -> Path:
        """Store the object that is one text file of this name."""

        def fill(folder: Path) -> None:
            (folder / name).write_text(text, encoding="utf-8")

        return self.write(kind, inputs, fill)

    def drop(self, place: Path) -> None:
        """Remove an object; moved aside first, so that no reader meets half of it."""
        doomed = place.with_name(f".unfinished-{place.name[:12]}-{os.getpid()}-{time.monotonic_ns()}")
        try:
            place.rename(doomed)
        except FileNotFoundError:
            return
        shutil.rmtree(doomed, ignore_errors=True)

    @contextmanager
    def making(self, kind: str, inputs: Inputs) -> Iterator[None]:
        """Held by the one process that makes this object; others wait and find it made."""
        folder = self.root / "locks"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise self._unwritable(error) from error
        with FileLock(folder / f"{kind}-{digest(inputs)}.lock"):
            yield

    def _unwritable(self, error: OSError) -> Unavailable:
        return Unavailable(f"the store at {self.root} cannot be written: {error.strerror or error}")

    def entries(self) -> list[Entry]:
        """All whole objects, the one longest unused first."""
        found = [_entry(manifest.parent) for manifest in self.root.glob(f"*/??/*/{MANIFEST}")]
        return sorted((entry for entry in found if entry), key=lambda entry: entry.used)

    def collect(self, max_age_days: float | None = None, max_bytes: int | None = None) -> list[Entry]:
        """Remove what was unused for longer than `max_age_days`, then the oldest beyond `max_bytes`.

        Returns what was removed. What writers left behind when they were killed goes as well.
        """
        now = time.time()
        for unfinished in self.root.glob("*/??/.unfinished-*"):
            if now - unfinished.stat().st_mtime > ABANDONED_AFTER_S:
                shutil.rmtree(unfinished, ignore_errors=True)
        entries = self.entries()
        excess = sum(entry.size_bytes for entry in entries) - max_bytes if max_bytes is not None else 0
        removed = []
        for entry in entries:
            too_old = max_age_days is not None and now - entry.used > max_age_days * 86400
            if too_old or excess > 0:
                self.drop(entry.path)
                removed.append(entry)
                excess -= entry.size_bytes
        return removed


def _entry(place: Path) -> Entry | None:
    try:
        size = sum(file.stat().st_size for file in place.iterdir())
        return Entry(place, size, (place / MANIFEST).stat().st_mtime)
    except FileNotFoundError:  # another process removed it meanwhile
        return None


def _move(unfinished: Path, place: Path) -> None:
    try:
        unfinished.replace(place)
    except OSError:
        if not (place / MANIFEST).is_file():  # else another process made the same object first
            raise
