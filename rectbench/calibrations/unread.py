"""What of a calibration's files looks like part of a lens or a pose, and was not read.

Readers do nothing for it: a file's mappings know which keys were asked for (`documents.entries`). A camera of
many that nobody asked for is no such part: it was read no further than to tell it from its sibling, and has
all that was read of that one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from rectbench.calibrations.documents import Source, finite_number, one_line, tell
from rectbench.calibrations.documents.entries import Entries
from rectbench.calibrations.vocabulary import (
    COEFFICIENT,
    DISTORTION,
    LENS,
    LENS_WORDS,
    LETTERS,
    OTHERS,
    POSE,
    SHORT,
    TYPES,
    WORD,
    bare,
    words_of,
)
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

MAX_KEYS = 6
"""Of a file's unread keys, as many are named."""


def tell_unread(sources: Sequence[Source], rig: Rig) -> None:
    """Tell what looks like part of a lens or a pose in the files that a rig was read from, and was not read.

    Raises InvalidInput where that is a distortion, and no lens of the rig has one.
    """
    for source in _with_companions(sources):
        for section in source.sections.values():
            if not isinstance(section.values, Entries) or not section.values.asked:
                continue
            unread = list(_unread(section.values, section.key))
            if not unread:
                continue
            names = ", ".join(one_line(name) for name, _ in unread[:MAX_KEYS])
            more = f" and {len(unread) - MAX_KEYS} more" if len(unread) > MAX_KEYS else ""
            if any(is_distortion for _, is_distortion in unread) and _has_no_distortion(rig):
                raise InvalidInput(
                    f"{source.path}: {names}{more}: looks like a distortion, which is not understood here; "
                    "expected it where the format has it, without which these are perfect pinholes"
                )
            what = "looks like part of a lens or a pose, but is not read; left out"
            tell(f"{source.path}: {names}{more}: {what}")


def _with_companions(sources: Sequence[Source]) -> Iterator[Source]:
    for source in sources:
        yield source
        yield from _with_companions(source.companions)


def _has_no_distortion(rig: Rig) -> bool:
    return all(
        camera.model == "pinhole"
        and not any(value for name, value in camera.params.items() if name not in ("fx", "fy", "cx", "cy"))
        for camera in (rig.left, rig.right)
    )


def _unread(entries: Entries, path: str) -> Iterator[tuple[str, bool]]:
    """The paths of unread keys of lens or pose below a mapping, and whether each is a distortion."""
    children = [value for key, value in entries.items() if _is_held(key) and not _is_matrix(value)]
    for key, value in entries.items():
        is_read_leaf = key in entries.asked and not isinstance(value, dict | list)
        if is_read_leaf or not _is_held(key) or _is_blank(value):
            continue
        if key in entries.asked and not _is_untouched(value):
            yield from _below(value, f"{path}{key}")
        elif _is_matrix(value) or not _is_other_camera(value, children):
            yield from _lens_or_pose(key, value, path)


def _below(value: Any, path: str) -> Iterator[tuple[str, bool]]:
    """The same of a key's value that was asked for."""
    if isinstance(value, Entries):
        yield from _unread(value, f"{path}.")
    elif isinstance(value, list) and _holds_mapping(value):
        for place, item in enumerate(value):
            if isinstance(item, Entries | list) and not _is_other_camera(item, value):
                yield from _below(item, f"{path}.{place}")


def _lens_or_pose(key: str, value: Any, path: str) -> Iterator[tuple[str, bool]]:
    """What of an unread key, or below it, is of a lens or a pose."""
    words = words_of(key)
    if isinstance(value, Entries) and not _is_matrix(value):
        inner = [one for name, item in value.items() if not _is_blank(item) and _is_held(name)
                 for one in _lens_or_pose(name, item, f"{path}{key}.")]  # fmt: skip
        is_part = bool(DISTORTION.intersection(words)) or any(is_distortion for _, is_distortion in inner)
        if inner:
            yield f"{path}{key}", is_part
    elif isinstance(value, list) and any(isinstance(item, Entries) for item in value):
        for place, item in enumerate(value):
            if isinstance(item, Entries):
                yield from _lens_or_pose(str(place), item, f"{path}{key}.")
    elif _names_lens_or_pose(key, value, words):
        yield f"{path}{key}", _is_distortion(key, value, words)


def _names_lens_or_pose(key: str, value: Any, words: frozenset[str]) -> bool:
    if isinstance(value, str) and finite_number(value) is None and LENS_WORDS.search(value):
        return True
    if TYPES.intersection(words):
        return finite_number(value) is not None
    if (LENS | POSE).intersection(words) or any(letter in LETTERS for letter in WORD.findall(key)):
        return True
    return bool(SHORT.fullmatch(bare(key)))


def _is_distortion(key: str, value: Any, words: frozenset[str]) -> bool:
    """Whether a key is one of coefficients: not zero, and no word."""
    is_number = finite_number(value) is not None or isinstance(value, dict | list)
    is_coefficient = COEFFICIENT.fullmatch(bare(key)) or "D" in WORD.findall(key)
    return is_number and bool(DISTORTION.intersection(words) or is_coefficient)


def _holds_mapping(value: list[Any]) -> bool:
    """Whether there are mappings in a list, or in a list inside it."""
    return any(isinstance(v, dict) or (isinstance(v, list) and _holds_mapping(v)) for v in value)


def _is_matrix(value: Any) -> bool:
    """Whether a value is a matrix as OpenCV and ROS write one."""
    return isinstance(value, dict) and "data" in value


def _is_held(key: str) -> bool:
    """Whether a key is about cameras; those of other sensors, of errors and boards are not looked into."""
    return OTHERS.isdisjoint(words_of(key))


def _is_blank(value: Any) -> bool:
    """Whether a value says nothing: none, or zeros alone."""
    if isinstance(value, dict):
        data = dict.get(value, "data", value)
        return _is_blank(data) if data is not value else all(map(_is_blank, value.values()))
    if isinstance(value, list):
        return all(map(_is_blank, value))  # ends at the first that says something
    return value in ("", None, "null", "~", False) or finite_number(value) == 0


def _is_untouched(value: Any) -> bool:
    """Whether a mapping was asked for, and none of its keys."""
    return isinstance(value, Entries) and bool(value) and not _asked(value)


def _asked(value: Any) -> int:
    """How many keys of a value were asked for, at any depth."""
    if isinstance(value, Entries):
        return len(value.asked) + sum(map(_asked, value.values()))
    return sum(map(_asked, value)) if isinstance(value, list) and _holds_mapping(value) else 0


def _is_other_camera(value: Any, siblings: Sequence[Any]) -> bool:
    """Whether a mapping was read less far than a sibling, all of whose read keys it has."""
    count = _asked(value)
    return isinstance(value, dict | list) and any(
        sibling is not value and count < _asked(sibling) and _has_what_was_read(value, sibling)
        for sibling in siblings
        if isinstance(sibling, dict | list)
    )


def _has_what_was_read(value: Any, sibling: Any) -> bool:
    if isinstance(value, Entries) and isinstance(sibling, Entries):
        read = sibling.asked & sibling.keys()
        return read <= value.keys() and all(
            _has_what_was_read(dict.get(value, key), dict.get(sibling, key)) for key in read
        )
    if isinstance(value, list) and isinstance(sibling, list) and _asked(sibling):
        return len(value) >= len(sibling) and all(map(_has_what_was_read, value, sibling))
    return not isinstance(sibling, Entries)
