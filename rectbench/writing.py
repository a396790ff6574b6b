"""Files that are there whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from rectbench.errors import Unavailable


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
