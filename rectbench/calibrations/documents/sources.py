"""The files of a calibration: read once, parsed when a format asks, named in every error."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from rectbench.calibrations.documents.documents import (
    MAX_BYTES,
    Section,
    as_text,
    parse_document,
    read_bytes,
    shown,
)
from rectbench.errors import InvalidInput

SUFFIXES = {
    *(".yaml", ".yml", ".xml", ".json", ".toml", ".txt", ".bin", ".cameramodel", ".cfg", ".conf", ".ini", ""),
}
"""What calibrations are called; in a folder, other files are not looked at."""

MAX_NAME = 200
"""Characters of a file name that a file may hold."""

MAX_FILES = 200
"""Files of a folder that are looked at."""


@dataclass(frozen=True, eq=False)
class Source:
    """One file: its path as the user gave it, and its first bytes.

    `content` ends a byte beyond `MAX_BYTES` (4 MiB); a format whose files are larger reads `path`.
    """

    path: str
    content: bytes

    @staticmethod
    def read(path: str | os.PathLike[str]) -> Source:
        """The file at `path`; raises InvalidInput where there is none."""
        return Source(os.fspath(path), read_bytes(path, MAX_BYTES + 1))

    @cached_property
    def text(self) -> str:
        """The content as text; raises InvalidInput where it is none."""
        return as_text(self.content, self.path)

    @cached_property
    def head(self) -> str:
        """The first 4096 bytes as text, by which kinds are told that are no YAML, JSON or XML."""
        return self.content[:4096].decode("utf-8-sig", errors="replace")

    @cached_property
    def document(self) -> Section:
        """The YAML, JSON or XML that the file holds; raises InvalidInput where it holds none."""
        return parse_document(self.text, self.path)

    @cached_property
    def keys(self) -> frozenset[str]:
        """The top keys of the document; none where there is no document."""
        try:
            return frozenset(self.document.values)
        except InvalidInput:
            return frozenset()

    @property
    def name(self) -> str:
        """The file's name without its suffix."""
        return Path(self.path).stem

    def beside(self, name: str) -> Source:
        """The file of that name in the same folder, or in a folder inside it."""
        relative = Path(name)
        if relative.is_absolute() or ".." in relative.parts or len(name) > MAX_NAME or not name.isprintable():
            raise InvalidInput(
                f"{self.path}: names the file {shown(name)}; expected one in its own folder or inside it"
            )
        return Source.read(Path(self.path).parent / relative)


def is_folder(path: str | os.PathLike[str]) -> bool:
    """Whether there is a folder at the path."""
    try:
        return os.fspath(path) != "" and Path(path).is_dir()
    except ValueError:  # a NUL in the path
        return False


def sources_in(folder: Path) -> Iterator[Source]:
    """The files in a folder and one level down that may be calibrations, by name."""
    try:
        files = sorted(
            path
            for pattern in ("*", "*/*")
            for path in folder.glob(pattern)
            if path.suffix.lower() in SUFFIXES and path.is_file()
        )
    except OSError as error:
        raise InvalidInput(f"{folder}: cannot be read ({error.strerror}); expected a folder") from None
    if len(files) > MAX_FILES:
        raise InvalidInput(
            f"{folder}: holds over {MAX_FILES} files that may be calibrations; expected a folder of one rig"
        )
    yield from map(Source.read, files)
