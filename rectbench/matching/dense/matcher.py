"""What a dense matcher is: a named function of two rectified images and a range of disparities."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rectbench.errors import InvalidInput, UnknownName
from rectbench.registry import registry
from rectbench.registry.kind import Described, Kind

Image = NDArray[np.uint8]
Match = Callable[[Image, Image, int, int], ArrayLike]
"""(left, right, lowest, highest) -> disparities [H, W] in pixels of the left image, NaN where none.

The images are rectified, [H, W, 3] RGB, uint8. A disparity is u_left - u_right, of either sign, to be
sought from `lowest` to `highest`. A matcher is called twice, the second time with both images
mirrored and exchanged, for the left-right check.
"""

USUAL_MATCHER = "sgbm"


@dataclass(frozen=True)
class Matcher:
    """A named matcher; called as its function is."""

    name: str
    summary: str
    """The first line of the function's docstring."""
    match: Match
    is_reentrant: bool = False
    """Whether it may run in two threads at once."""

    def __call__(self, left: Image, right: Image, lowest: int, highest: int) -> ArrayLike:
        """Disparities [H, W] of rectified images, see `Match`."""
        return self.match(left, right, lowest, highest)


def matcher(name: str, *, is_reentrant: bool = False) -> Callable[[Match], Matcher]:
    """Decorate a function of two rectified images and a range, with a docstring; it becomes a `Matcher`.

    Parameters
    ----------
    name : what reports and `rectbench reconstruct` ask for.
    is_reentrant : whether it may run in two threads at once, as its two calls then do.

    The function is given uint8 RGB images [H, W, 3] and the least and the greatest disparity to be sought,
    u_left - u_right in pixels, and answers with those of the left image [H, W], NaN where it finds none.
    Raises InvalidInput where it has no name or no docstring.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> @rb.matcher("far-away")
    ... def far_away(left, right, lowest, highest):
    ...     'Takes everything to be at infinity.'
    ...     return np.zeros(left.shape[:2])
    >>> far_away.name, far_away.summary
    ('far-away', 'Takes everything to be at infinity.')
    """

    def decorate(match: Match) -> Matcher:
        if not name or name != name.strip():
            raise InvalidInput(f"matcher name is {name!r}; expected a name")
        lines = (inspect.getdoc(match) or "").splitlines()
        if not lines:
            raise InvalidInput(f"matcher {name} has no docstring; expected one line that says how it matches")
        return Matcher(name, lines[0], match, is_reentrant)

    return decorate


def matcher_named(asked: str | Path | Match) -> Matcher:
    """The matcher of a name or in a file; a bare function as one.

    Raises UnknownName, with the nearest names; InvalidInput for a file without a sound matcher.
    """
    if isinstance(asked, Matcher):
        return asked
    if callable(asked):
        return Matcher(getattr(asked, "__name__", "function"), "", asked)
    if not isinstance(asked, str | Path):
        raise UnknownName("matcher", str(asked), registry(MATCHERS).names())
    return registry(MATCHERS).get(asked).value


def _described(value: Any) -> Described[Matcher] | None:
    return Described(value.name, value.summary, value) if isinstance(value, Matcher) else None


MATCHERS: Kind[Matcher] = Kind(
    name="matchers",
    singular="matcher",
    expected="a function decorated with @rectbench.matcher(name)",
    packages=("rectbench.matching.dense.matchers",),
    described=_described,
    is_shared=True,
)
