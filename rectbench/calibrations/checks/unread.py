"""What of a calibration's files looks like part of a lens or a pose, and was not read.

Readers do nothing for it: a file's mappings know which keys were asked for (`documents.entries`). A camera of
many that nobody asked for is no such part: it was hardly read, to tell it from its sibling or for where that
one stands, and has all that was read of that one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from heapq import nlargest
from operator import itemgetter
from typing import Any

import numpy as np

from rectbench.calibrations.checks.vocabulary import (
    COEFFICIENT,
    DISTORTION,
    FLAGS,
    LENS,
    LENS_WORDS,
    LETTERS,
    NAMED_COEFFICIENT,
    OTHERS,
    POSE,
    SEPARATOR,
    SHORT,
    TYPES,
    WORD,
    bare,
    words_of,
)
from rectbench.calibrations.contract import UNITS
from rectbench.calibrations.documents import Source, finite_number, one_line, tell
from rectbench.calibrations.documents.entries import Entries
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

MAX_KEYS = 6
"""Of a file's unread keys, as many are named."""

MOST_COMPARED = 4
"""Siblings of which most was read, that a mapping is compared with."""

AGREEMENT = 0.05
"""By how much, relative, a length or angle that a file says again may differ; some are nominal."""


@dataclass(frozen=True)
class Part:
    """An unread key that looks like part of a lens or a pose: its path in the file, and what stands there."""

    path: str
    value: Any
    is_distortion: bool


@np.errstate(all="ignore")
def tell_unread(sources: Sequence[Source], rig: Rig) -> None:
    """Tell what looks like part of a lens or a pose in the files that a rig was read from, and was not read.

    What only says again what the rig is, such as its baseline, is compared with it instead. Raises
    InvalidInput for a distortion that was not read where no lens of the rig has one.
    """
    for source in _with_companions(sources):
        held = [(v, one.key) for one in source.sections.values() if isinstance(v := one.values, Entries)]
        read = [(values, key) for values, key in held if _asked(values)]
        for values, key in read or held:
            parts = list(_unread(values, key))
            _tell_parts(
                source.path, [part for part in parts if not _is_repetition(source.path, part, rig)], rig
            )


def _tell_parts(file: str, parts: Sequence[Part], rig: Rig) -> None:
    if not parts:
        return
    names = ", ".join(one_line(part.path) for part in parts[:MAX_KEYS])
    more = f" and {len(parts) - MAX_KEYS} more" if len(parts) > MAX_KEYS else ""
    if any(part.is_distortion for part in parts) and _has_no_distortion(rig):
        raise InvalidInput(
            f"{file}: {names}{more}: looks like a distortion, which is not understood here; "
            "expected it where the format has it, without which these are perfect pinholes"
        )
    tell(f"{file}: {names}{more}: looks like part of a lens or a pose, but is not read; left out")


def _is_repetition(file: str, part: Part, rig: Rig) -> bool:
    """Whether a part says again what follows from the rig; that it says otherwise is told."""
    number = finite_number(part.value)
    words = words_of(part.path.rpartition(".")[2])
    if number is None:
        return False
    if "baseline" in words:
        said = min((abs(number) * metres for metres in UNITS.values()), key=lambda m: abs(m - rig.baseline_m))
        what, stated = f"{rig.baseline_m:.6g} m by the pose", rig.baseline_m
    elif "hfov" in words:
        stated = _across_deg(rig)
        said = min((abs(number), math.degrees(abs(number))), key=lambda angle: abs(angle - stated))
        what = f"{stated:.4g}° by the lens"
    else:
        return False
    if not abs(said - stated) <= AGREEMENT * stated:
        tell(f"{file}: {one_line(part.path)} is {number:.6g}, but it is {what}, which is kept to")
    return True


def _across_deg(rig: Rig) -> float:
    """The left camera's field of view across its image, degrees; NaN where it does not see its sides."""
    camera = rig.left
    middle = 0.5 * (camera.height - 1)
    rays, _ = camera.unproject([[-0.5, middle], [camera.width - 0.5, middle]])
    return math.degrees(math.acos(float(np.clip(rays[0] @ rays[1], -1.0, 1.0))))


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


def _unread(entries: Entries, path: str) -> Iterator[Part]:
    """The unread keys of lens or pose below a mapping."""
    siblings = _most_read(value for key, value in entries.items() if not _is_matrix(value) and _is_held(key))
    for key, value in entries.items():
        is_read_leaf = key in entries.asked and not isinstance(value, dict | list)
        if is_read_leaf or not _is_held(key) or _is_blank(value):
            continue
        if not _is_matrix(value) and _is_other_camera(value, siblings):
            continue
        if key in entries.asked and not _is_untouched(value):
            yield from _below(value, f"{path}{key}")
        else:
            yield from _lens_or_pose(key, value, path)


def _below(value: Any, path: str) -> Iterator[Part]:
    """The same of a key's value that was asked for."""
    if isinstance(value, Entries):
        yield from _unread(value, f"{path}.")
    elif isinstance(value, list) and _holds_mapping(value):
        siblings = _most_read(value)
        for place, item in enumerate(value):
            if isinstance(item, Entries | list) and not _is_other_camera(item, siblings):
                yield from _below(item, f"{path}.{place}")


def _lens_or_pose(key: str, value: Any, path: str) -> Iterator[Part]:
    """What of an unread key, or below it, is of a lens or a pose."""
    words = words_of(key)
    if isinstance(value, Entries) and not _is_matrix(value):
        inner = [one for name, item in value.items() if not _is_blank(item) and _is_held(name)
                 for one in _lens_or_pose(name, item, f"{path}{key}.")]  # fmt: skip
        is_distortion = bool(DISTORTION.intersection(words)) or any(part.is_distortion for part in inner)
        if inner or (LENS | POSE).intersection(words):
            yield Part(f"{path}{key}", value, is_distortion)
    elif isinstance(value, list) and any(isinstance(item, Entries) for item in value):
        for place, item in enumerate(value):
            if isinstance(item, Entries):
                yield from _lens_or_pose(str(place), item, f"{path}{key}.")
    elif _names_lens_or_pose(key, value, words):
        yield Part(f"{path}{key}", value, _is_distortion(key, value, words))


def _names_lens_or_pose(key: str, value: Any, words: frozenset[str]) -> bool:
    if isinstance(value, str) and finite_number(value) is None and LENS_WORDS.search(value):
        return True
    if str(value).lower() in FLAGS:
        return bool(DISTORTION.intersection(words))
    if TYPES.intersection(words):
        return finite_number(value) is not None
    if (LENS | POSE).intersection(words) or any(letter in LETTERS for letter in WORD.findall(key)):
        return True
    return bool(SHORT.fullmatch(bare(key))) or _has_coefficient(key)


def _has_coefficient(key: str) -> bool:
    """Whether a key has a coefficient's name among others, as `lens_k1` has."""
    return any(NAMED_COEFFICIENT.fullmatch(part) for part in SEPARATOR.split(key))


def _is_distortion(key: str, value: Any, words: frozenset[str]) -> bool:
    """Whether a key is one of coefficients: not zero, and no word."""
    is_number = finite_number(value) is not None or isinstance(value, dict | list)
    is_coefficient = COEFFICIENT.fullmatch(bare(key)) or "D" in WORD.findall(key) or _has_coefficient(key)
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


def _most_read(values: Iterable[Any]) -> list[tuple[int, Any]]:
    """Of the mappings and lists among the values those of which most was read, and how many keys that is."""
    counted = [(_asked(value), value) for value in values if isinstance(value, dict | list)]
    return nlargest(MOST_COMPARED, (one for one in counted if one[0]), key=itemgetter(0))


def _is_other_camera(value: Any, most_read: Sequence[tuple[int, Any]]) -> bool:
    """Whether a mapping was read at most half as far as a sibling, all of whose read keys it has."""
    if not isinstance(value, dict | list) or not most_read:
        return False
    count = _asked(value)
    return any(
        sibling is not value and 2 * count <= read and _has_what_was_read(value, sibling)
        for read, sibling in most_read
    )


def _has_what_was_read(value: Any, sibling: Any) -> bool:
    if isinstance(value, Entries) and isinstance(sibling, Entries):
        read = sibling.asked & sibling.keys()
        return read <= value.keys() and all(
            _has_what_was_read(dict.get(value, key), dict.get(sibling, key)) for key in read
        )
    if isinstance(value, list) and isinstance(sibling, list) and _asked(sibling):
        return len(value) >= len(sibling) and all(map(_has_what_was_read, value, sibling))
    return not isinstance(sibling, Entries) and not _asked(sibling)
