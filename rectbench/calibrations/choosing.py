"""Which two of a file's cameras are left and right: those asked for, the only two, or a question.

The question lists the pairs that the file could make, those that see most in common first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from rectbench.calibrations.contract import Given
from rectbench.calibrations.documents import shown
from rectbench.cameras import Camera
from rectbench.errors import InvalidInput, argument
from rectbench.rigs.rig import Rig
from rectbench.types import FloatArray

MAX_NAMES = 20
"""Of a file's cameras, as many are named in an error."""

MAX_CAMERAS = 8
"""Of so many cameras the pairs are looked at."""

MAX_PAIRS = 6
"""As many of them are listed."""

GRID = 24
"""Columns and rows of the pixels that the overlap of two views is counted on."""

Pair = tuple[str, str]


class CamerasNotChosen(InvalidInput):
    """A file of more than two cameras of which nobody said which two; `names` are theirs, in its order.

    Its first line proposes the pair that sees the most in common; one a pair follows.
    """

    has_lines = True

    def __init__(self, message: str, names: Sequence[str]) -> None:
        super().__init__(message)
        self.names = tuple(names)


def chosen(
    names: Sequence[str], given: Given, file: str, rig_of: Callable[[Pair], Rig] | None = None
) -> Pair:
    """The left and the right of a file's cameras: those asked for, or else its only two.

    Raises InvalidInput for a camera that is not there; CamerasNotChosen, with the pairs that `rig_of` makes
    rigs of, where there are more than two and none are asked for.
    """
    for name in given.cameras or ():
        if name not in names:
            known = ", ".join(shown(name) for name in names[:MAX_NAMES])
            raise InvalidInput(f"{file}: has no camera {shown(name)}; expected two of {known}")
    if len(names) < 2:
        raise InvalidInput(f"{file}: holds {len(names)} cameras; expected two at least")
    if given.cameras is None and len(names) > 2:
        pairs = _pairs(names, rig_of) if rig_of else {}
        known = ", ".join(shown(name) for name in names[:MAX_NAMES])
        found = f"{file}: holds {len(names)} cameras"
        expected = f"`{argument('cameras')}` with two of them"
        best = next(
            (f", such as {','.join(pair)}, which see the most in common" for pair in pairs), f": {known}"
        )
        lines = [f"{','.join(pair)}: {told}" for pair, told in pairs.items()]
        raise CamerasNotChosen("\n".join([f"{found}; expected {expected}{best}", *lines]), names)
    return given.cameras or (names[0], names[1])


def _pairs(names: Sequence[str], rig_of: Callable[[Pair], Rig]) -> dict[Pair, str]:
    """The pairs that make rigs, those that see most in common first, each with its baseline and overlap."""
    found: list[tuple[float, Pair, str]] = []
    for left, right in combinations(names[:MAX_CAMERAS], 2):
        try:
            rig = rig_of((left, right))
        except InvalidInput:
            continue
        if rig.is_right_first:
            left, right = right, left
        share = overlap(rig)
        told = f"baseline {rig.baseline_m:.3g} m, {100 * share:.0f} % of the view in common"
        found.append((-share, (left, right), told))
    return {pair: told for _, pair, told in sorted(found)[:MAX_PAIRS]}


def overlap(rig: Rig) -> float:
    """The share of the smaller view that both cameras see, far away."""
    left_in_right = _share(rig.left, rig.right, rig.R_right_left)
    right_in_left = _share(rig.right, rig.left, rig.R_right_left.T)
    return max(left_in_right, right_in_left)


def _share(one: Camera, other: Camera, R_other_one: FloatArray) -> float:
    """The share of the pixels that a camera sees by whose rays the other sees something too."""
    u = np.linspace(0.0, one.width - 1.0, GRID)
    v = np.linspace(0.0, one.height - 1.0, GRID)
    rays, seen = one.unproject(np.stack(np.meshgrid(u, v), axis=-1))
    return float(other.sees(rays[seen] @ R_other_one.T).mean()) if seen.any() else 0.0
