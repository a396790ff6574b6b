"""Files that are there whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from rectbench.errors import InvalidInput, Unavailable


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write beside the place, then move there. Text is UTF-8 with line feeds.

    Raises Unavailable where the disk takes no more.
    """
    data = content.encode() if isinstance(content, str) else content
    unfinished = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor, unfinished = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(data)
        Path(unfinished).chmod(0o644)  # mkstemp makes files for its user alone
        Path(unfinished).replace(path)
    except OSError as error:
        if unfinished:
            Path(unfinished).unlink(missing_ok=True)
        raise Unavailable(f"{path} cannot be written: {error.strerror or error}") from error


def check_writable(folder: Path) -> None:
    """Raise InvalidInput where a folder could not be written, before hours are spent on it."""
    existing = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK | os.X_OK):
        raise InvalidInput(f"{folder} cannot be written; expected a folder, or a place for one")
