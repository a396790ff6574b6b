"""The files of a calibration: read once, parsed when a format asks, named in every error."""

from __future__ import annotations

import errno
import io
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from rectbench.calibrations.documents.archives import MARK, parse_archive
from rectbench.calibrations.documents.entries import Entries, as_entries, forget
from rectbench.calibrations.documents.faults import one_line, shown
from rectbench.calibrations.documents.parsing import Malformed, parse
from rectbench.calibrations.documents.sections import Section, parse_document
from rectbench.errors import InvalidInput

MAX_BYTES = 1 << 22
"""Calibrations take kilobytes, some with every image point a few hundred; what is larger is another file."""

SUFFIXES = {
    *(".yaml", ".yml", ".xml", ".json", ".toml", ".txt", ".bin", ".cameramodel", ".cfg", ".conf", ".ini", ""),
    *(".npz",),
}
"""What calibrations are called; in a folder, other files are not looked at."""

RECORDS = "records"
"""What errors call the list that a table is."""

MAX_NAME = 200
"""Characters of a file name that a file may hold."""

MAX_FILES = 200
"""Files of a folder that are looked at."""


def read_bytes(path: str | os.PathLike[str], limit: int) -> bytes:
    """The first `limit` bytes of a file; raises InvalidInput where there are none to be had."""
    try:
        if Path(path).is_fifo():  # opening it would wait for a writer
            raise OSError(errno.ESPIPE, "a pipe")
        with Path(path).open("rb") as stream:
            return stream.read(limit)
    except OSError as error:
        raise InvalidInput(
            f"{path}: cannot be read ({error.strerror}); expected a calibration file"
        ) from None
    except ValueError as error:  # a NUL in the path
        raise InvalidInput(f"{str(path)!r}: cannot be read ({error}); expected a path") from None


def as_text(content: bytes, path: str) -> str:
    """The text that `content`, read up to a byte beyond `MAX_BYTES`, is; InvalidInput where it is none."""
    if len(content) > MAX_BYTES:
        raise InvalidInput(f"{path}: is larger than {MAX_BYTES >> 20} MiB; expected a calibration file")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InvalidInput(f"{path}: is not text (byte {error.start}); expected a calibration file") from None
    if "\0" in text:
        raise InvalidInput(f"{path}: is binary (byte {text.index(chr(0))}); expected a calibration file")
    if not text.strip():
        raise InvalidInput(f"{path}: is empty; expected a calibration file")
    return text


@dataclass(frozen=True, eq=False)
class Source:
    """One file: its path as the user gave it, and its first bytes.

    `content` ends a byte beyond `MAX_BYTES` (4 MiB); a format whose files are larger reads `path`. What was
    made of it stands in `sections`, and files that were reached from it in `companions`, so that what a
    reader left unread can be told.
    """

    path: str
    content: bytes
    sections: dict[str, Section] = field(default_factory=dict, init=False, repr=False)
    companions: list[Source] = field(default_factory=list, init=False, repr=False)

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
        """The first 4096 bytes as text, by which formats are recognised that are no YAML, JSON or XML."""
        return self.content[:4096].decode("utf-8-sig", errors="replace")

    @cached_property
    def document(self) -> Section:
        """The YAML, JSON, XML or .npz that the file holds; raises InvalidInput where it holds none."""
        is_archive = self.content.startswith(MARK)
        self.sections["document"] = self._archive() if is_archive else parse_document(self.text, self.path)
        return self.sections["document"]

    def section(self, values: Mapping[str, Any], key: str = "") -> Section:
        """Content that a format has parsed itself, under a key that errors name before its own."""
        self.sections[f"parsed {key}"] = Section(self.path, key, as_entries(values))
        return self.sections[f"parsed {key}"]

    def forget(self) -> None:
        """Count nothing of the file as read."""
        self.companions.clear()
        for section in self.sections.values():
            forget(section.values)
            if RECORDS in section.values:
                section.values.get(RECORDS)  # cut up once, when the file was opened

    def _archive(self) -> Section:
        try:
            if len(self.content) <= MAX_BYTES:
                return Section(self.path, "", Entries(parse_archive(io.BytesIO(self.content))))
            with Path(self.path).open("rb") as stream:  # whose maps and images are not read
                return Section(self.path, "", Entries(parse_archive(stream)))
        except (Malformed, OSError) as error:
            raise InvalidInput(f"{self.path}: {one_line(error)}; expected NumPy's K1, D1, ...") from None

    @cached_property
    def records(self) -> tuple[Section, ...]:
        """The mappings of a file that is a list of them, as tables are written in JSON; none of another."""
        if not self.head.lstrip().startswith("["):
            return ()
        try:
            content = parse(self.text)
        except (Malformed, InvalidInput):
            return ()
        if not isinstance(content, list) or not all(isinstance(record, dict) for record in content):
            return ()
        whole = self.section({RECORDS: content})
        records = whole.section_of_list(RECORDS)
        return tuple(records.section(place, "a record") for place in records.values)

    def table(self, mark: str) -> Section:
        """The lines `key mark words` by key: a word, or a list of several, without brackets and commas."""
        lines = (line.partition(mark) for line in self.text.splitlines())
        entries = {key.strip(): re.sub(r"[\[\];,]", " ", words).split() for key, _, words in lines}
        values = {key: words[0] if len(words) == 1 else words for key, words in entries.items()}
        return self.section(values)

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
        source = Source.read(Path(self.path).parent / relative)
        self.companions.append(source)
        return source


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
