"""What is said of files that no format recognises: what they look like, what the nearest formats would need.

The nearest are found by asking: each format reads the files as if they were its own, and how many of their
keys it has found, before it misses one, is how near it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rectbench.calibrations.contract import CameraFormat, Given, RigFormat
from rectbench.calibrations.documents import Source, one_line
from rectbench.calibrations.documents.entries import Entries
from rectbench.errors import InvalidInput

MAX_KEYS = 8
"""Of a file's keys, as many are named."""

LONGEST_NEED = 160
"""Characters of what a format would need."""

NO_CAMERA = "holds 0 cameras"
"""What a format needs that has found none: it is not near, whatever mappings it has looked into for one."""

NEAREST = 2
LISTED = "all formats, and how a rig of one's own is written: rectbench list formats"


class UnknownFormat(InvalidInput):
    """Files that are no calibration of a known format, in three lines."""

    has_lines = True


def unknown_format(
    sources: Sequence[Source], formats: Sequence[RigFormat | CameraFormat], given: Given
) -> UnknownFormat:
    """The error; raises InvalidInput instead where a file is damaged."""
    keys = [key for source in sources for key in source.document.values]
    if not keys:
        raise InvalidInput(f"{sources[0].path}: is no calibration known here but empty; expected `key: ...`")
    named = ", ".join(one_line(key)[:40] for key in keys[:MAX_KEYS])
    more = f" and {len(keys) - MAX_KEYS} more" if len(keys) > MAX_KEYS else ""
    near = [f"{name}: {need}" for _, name, need in sorted(_tried(sources, formats, given))[:NEAREST]]
    return UnknownFormat(
        f"{sources[0].path}: is no calibration known here but has the keys {named}{more}\n"
        f"nearest: {'; '.join(near) if near else 'none, no format has keys like these'}\n"
        f"{LISTED}"
    )


def _tried(
    sources: Sequence[Source], formats: Sequence[RigFormat | CameraFormat], given: Given
) -> list[tuple[int, str, str]]:
    """Of each format that finds any key: how many, negative; its name; and what it misses."""
    tried = []
    for format in formats:
        for source in sources:
            source.forget()
        need = _need(format, sources, given)
        found = sum(_found(source.document.values) for source in sources)
        if found and need and not need.startswith(NO_CAMERA):
            tried.append((-found, format.name, need))
    return tried


def _need(format: RigFormat | CameraFormat, sources: Sequence[Source], given: Given) -> str:
    """What a format's reader misses first; empty where it does not say so."""
    given = given if isinstance(format, CameraFormat) or format.has_many else Given(given.size, given.unit)
    try:
        if isinstance(format, CameraFormat):
            format.read(sources[0], given)
        else:
            format.read(sources, given)
    except InvalidInput as error:
        return one_line(error).replace(f"{sources[0].path}: ", "").replace("\n", " ")[:LONGEST_NEED]
    except (LookupError, TypeError, ValueError, ArithmeticError, StopIteration, RuntimeError):
        return ""  # of a file that it does not recognise a reader need not know what is wrong
    return "its mark, by which it is recognised"


def _found(value: Any) -> int:
    """How many of the keys there are were asked for, at any depth."""
    if isinstance(value, Entries):
        return len(value.asked & value.keys()) + sum(map(_found, value.values()))
    if isinstance(value, dict | list):
        return sum(map(_found, value.values() if isinstance(value, dict) else value))
    return 0
