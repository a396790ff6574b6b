"""What readers of files with several cameras share: names, quaternions, units that a file leaves open."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from scipy.spatial.transform import Rotation

from rectbench.calibrations.assembling import Pair, chosen, rig_of_posed
from rectbench.calibrations.contract import Given, PosedCamera
from rectbench.calibrations.documents import Section, Source, tell
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

Entry = TypeVar("Entry")

QUATERNION_TOLERANCE = 1e-3
"""How far from 1 a quaternion's length may be; what is farther is another thing than a rotation."""

Y_UP_Z_BACK = np.diag([1.0, -1.0, -1.0, 1.0])
"""Turns a camera of x right, y down, z forward into one of x right, y up, z back, and the other way."""


def rig_of_named(
    source: Source,
    cameras: Mapping[str, Entry],
    read: Callable[[Entry], PosedCamera],
    given: Given,
    unit: str | None = None,
    pairs: Iterable[Pair] = (),
) -> Rig:
    """The rig of two of a file's cameras: those asked for, by their names or the last parts of these.

    Where none are asked for, the first of `pairs` that the file has is left and right, if there is any.
    """

    def rig_of(names: Pair) -> Rig:
        return rig_of_posed([read(cameras[name]) for name in names], given, source.name, unit)

    return rig_of(pair_of(list(cameras), pairs, _full_names(given, list(cameras)), source.path, rig_of))


def pair_of(
    names: Sequence[str], pairs: Iterable[Pair], given: Given, file: str, rig_of: Callable[[Pair], Rig]
) -> Pair:
    """The cameras asked for; or else the first of `pairs` that is there, which says itself what is left."""
    there = next((pair for pair in pairs if set(pair) <= set(names)), None)
    return there if there and given.cameras is None else chosen(names, given, file, rig_of)


def by_name(entries: Iterable[tuple[str, Entry]]) -> dict[str, Entry]:
    """Entries by their names; one whose name others have too is called `name#2` and so on."""
    found: dict[str, Entry] = {}
    for name, entry in entries:
        place, unique = 1, name
        while unique in found:
            place += 1
            unique = f"{name}#{place}"
        found[unique] = entry
    return found


def _full_names(given: Given, names: Sequence[str]) -> Given:
    """What is asked for, with the last part of one path alone put in full."""
    if given.cameras is None:
        return given
    left, right = (_full_name(name, names) for name in given.cameras)
    return replace(given, cameras=(left, right))


def _full_name(name: str, names: Sequence[str]) -> str:
    ending = [full for full in names if full.replace("\\", "/").endswith(f"/{name}")]
    return ending[0] if name not in names and len(ending) == 1 else name


def quaternion_rotation(where: str, wxyz: Sequence[float]) -> FloatArray:
    """The rotation [3, 3] of a unit quaternion (w, x, y, z); InvalidInput, at `where`, for another."""
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(wxyz))
    if not abs(length - 1) < QUATERNION_TOLERANCE:
        raise InvalidInput(f"{where} is a quaternion of length {length:g}; expected 1")
    w, x, y, z = wxyz
    return Rotation.from_quat([x, y, z, w]).as_matrix()


def tell_missing(section: Section, keys: Iterable[str], taken: str) -> None:
    """Tell which of these keys a section has not, and what they are taken to be."""
    missing = [key for key in keys if key not in section]
    if missing:
        tell(f"{section.at(', '.join(missing))}: missing; taken to be {taken}")


def told_scale(where: str, given: Given) -> str:
    """The unit of a reconstruction, whose scale nothing need have fixed: that given, or else metres, told."""
    if given.unit is None:
        tell(f"{where}: its scale is arbitrary unless something fixed it; taken to be in metres")
    return given.unit or "m"


def told_unit(where: str, baseline: float, longest: float, unit: str, given: Given) -> str:
    """The unit of a file that leaves it open: that given, or metres; for a longer baseline `unit`, told."""
    if given.unit is not None or not baseline > longest:
        return given.unit or "m"
    tell(
        f"{where}: the baseline is {baseline:.4g}, too long for metres; taken to be in {unit} "
        f"(`{argument('unit')}` says otherwise)"
    )
    return unit
