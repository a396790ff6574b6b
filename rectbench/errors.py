"""The errors rectbench raises on purpose.

Every message is one line that names the thing, the value and what was expected; the command line
prints it as it stands and exits with code 2.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class RectbenchError(Exception):
    """Base of all errors that rectbench raises on purpose."""


class InvalidInput(RectbenchError, ValueError):
    """An argument, file or option that cannot be used as given."""


class UnknownName(InvalidInput):
    """A scene, rig, method, option, report or parameter that nobody has registered."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        choices = sorted(known)
        nearest = get_close_matches(name, choices, n=3, cutoff=0.4)
        hint = f"did you mean {' or '.join(nearest)}?" if nearest else f"known: {', '.join(choices)}"
        super().__init__(f"unknown {kind} '{name}'; {hint}")


class Unsupported(RectbenchError):
    """A rectifier that cannot serve this rig, with the geometric reason."""


class PoseNotFound(Unsupported):
    """Images or matches that do not determine how the two cameras stand, with the reason."""


class Unavailable(RectbenchError):
    """Something the machine lacks: a library, a variant, a data file."""


class InvalidResult(RectbenchError):
    """A plugin whose answer has the wrong type, shape or values."""
