"""Files that are there whole or not at all: written beside their place, then moved there."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from rectbench.errors import InvalidInput, RectbenchError, Unavailable


def write_atomically(path: Path, content: str | bytes) -> None:
    """One file that could be made again, such as a figure; its folder is made where there is none.

    Text is UTF-8 with line feeds. Raises Unavailable, naming the path, where the disk takes no more.
    """
    make_folder(path.parent)
    with _blaming(path, Unavailable), _written_beside(path, content) as unfinished:
        unfinished.replace(path)


def replace_files(contents: Mapping[Path, str | bytes], error: type[RectbenchError] = Unavailable) -> None:
    """All of these files or none, in folders that are there, moved into place in the order given.

    What was there stays until the disk holds all that is new. Text is UTF-8 with line feeds. Raises
    `error`, naming the path: InvalidInput suits a place that the user chose.
    """
    with ExitStack() as stack:
        unfinished = {}
        for path, content in contents.items():
            with _blaming(path, error):
                unfinished[path] = stack.enter_context(_written_beside(path, content))
                flush(unfinished[path])
        for path, written in unfinished.items():
            with _blaming(path, error):
                written.replace(path)


def make_folder(folder: Path, error: type[RectbenchError] = Unavailable) -> None:
    """The folder, and those it lies in; raises `error`, naming it, where there can be none."""
    with _blaming(folder, error):
        folder.mkdir(parents=True, exist_ok=True)


def check_writable(folder: Path) -> None:
    """Raise InvalidInput where a folder could not be written, before hours are spent on it."""
    existing = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InvalidInput(f"{folder} cannot be written; expected a folder, or a place for one")


def flush(path: Path) -> None:
    """Have the disk hold a file or folder, before anything is said to be there."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def _written_beside(path: Path, content: str | bytes) -> Iterator[Path]:
    """A file with that content in the same folder, gone afterwards if nobody moved it."""
    if path.is_dir() or not path.name:
        raise IsADirectoryError(None, "a folder is there")
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    unfinished = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content.encode() if isinstance(content, str) else content)
        unfinished.chmod(0o644)  # mkstemp makes files for its user alone
        yield unfinished
    finally:
        unfinished.unlink(missing_ok=True)


@contextmanager
def _blaming(path: Path, error: type[RectbenchError]) -> Iterator[None]:
    try:
        yield
    except OSError as reason:
        raise error(f"{path}: cannot be written ({reason.strerror or reason})") from reason
