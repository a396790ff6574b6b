"""A calibration file with one of its keys renamed or moved, as another version of the tool might write it."""

from __future__ import annotations

import copy
import io
import json
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from rectbench.calibrations.documents.parsing import Malformed, parse

Path = tuple[str | int, ...]

RENAMED = {
    "suffixed": lambda key: f"{key}_v2",
    "prefixed": lambda key: f"my_{key}",
    "recased": lambda key: key.upper() if key.lower() == key else key.lower(),
    "respelled": lambda key: re.sub(r"_(\w)", lambda m: m[1].upper(), key) if "_" in key else f"{key}_",
    "unheard of": lambda key: "zzz",
}
"""Other names for a key."""

LINE_KEY = re.compile(r"(?m)^[ \t]*['\"]?([A-Za-z_][\w ]*?)['\"]?[ \t]*(?:[:=]|$)")
"""A key, or a label alone in its line, in a text that is no document: INI, tables, Python's dictionaries."""


def changes(content: str | bytes) -> Iterator[tuple[str, bytes]]:
    """What was done to a key of a file, and the file after it; of bytes, an archive of NumPy's."""
    if isinstance(content, bytes):
        yield from changed_archives(content)
        return
    changed = changed_texts(content) if content_of(content) is None else changed_documents(content)
    yield from ((what, text.encode()) for what, text in changed)


def content_of(text: str) -> Any:
    """The mapping, or list of such, in a YAML, JSON, XML or TOML text, or None where it holds none."""
    try:
        content = parse(text)
    except Malformed:
        return None
    is_table = isinstance(content, list) and all(isinstance(record, dict) for record in content)
    return content if is_table or isinstance(content, dict) else None


def keys_in(content: Any, path: Path = ()) -> Iterator[Path]:
    """The paths of all keys in a mapping, those of matrices (rows, cols, data) left out."""
    if isinstance(content, dict) and "data" not in content:
        for key, value in content.items():
            yield (*path, key)
            yield from keys_in(value, (*path, key))
    elif isinstance(content, list):
        for place, value in enumerate(content):
            if isinstance(value, dict | list):
                yield from keys_in(value, (*path, place))


def changed_documents(text: str) -> Iterator[tuple[str, str]]:
    """What was done to a document's key, and the document after it, as JSON."""
    content = content_of(text)
    for path in keys_in(content):
        for how, rename in RENAMED.items():
            yield f"{how} {path}", json.dumps(with_key(content, path, rename(str(path[-1]))))
        yield f"moved inwards {path}", json.dumps(with_key(content, path, "moved", inwards=True))
        if len(path) > 1 and isinstance(content, dict):
            yield f"moved to the top {path}", json.dumps(with_key(content, path, str(path[-1]), to_top=True))


def changed_texts(text: str) -> Iterator[tuple[str, str]]:
    """The same of a text that is no document, whose keys are renamed and not moved."""
    for found in LINE_KEY.finditer(text):
        for how, rename in RENAMED.items():
            start, end = found.span(1)
            yield f"{how} {found[1]} at {start}", text[:start] + rename(found[1]) + text[end:]


def changed_archives(content: bytes) -> Iterator[tuple[str, bytes]]:
    """The same of an archive, whose arrays are renamed, or moved into a folder of it."""
    with np.load(io.BytesIO(content)) as archive:
        arrays = dict(archive)
    inwards = {"moved inwards": "moved/{}".format}
    for name in arrays:
        for how, rename in (RENAMED | inwards).items():
            stream = io.BytesIO()
            np.savez(stream, **{rename(key) if key == name else key: arrays[key] for key in arrays})
            yield f"{how} {name}", stream.getvalue()


def with_key(content: Any, path: Path, name: str, inwards: bool = False, to_top: bool = False) -> Any:
    """A copy in which a key has another name, or stands in a mapping of that name, or at the top."""
    changed = copy.deepcopy(content)
    holder = changed
    for step in path[:-1]:
        holder = holder[step]
    last = path[-1]
    items = list(holder.items())
    holder.clear()
    for key, value in items:
        if key != last:
            holder[key] = value
        elif inwards:
            holder[name] = {key: value}
        elif to_top:
            changed[name] = value
        else:
            holder[name] = value
    return changed
