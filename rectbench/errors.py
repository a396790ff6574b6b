"""The errors rectbench raises on purpose.

Every message is one line that names the thing, the value and what was expected, but where its class says
that it has several; the command line prints it as it stands and exits with code 2.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import ClassVar


class RectbenchError(Exception):
    """Base of all errors that rectbench raises on purpose.

    >>> issubclass(InvalidInput, RectbenchError)
    True
    """

    has_lines: ClassVar[bool] = False
    """Whether the message has several lines, to be printed as such."""


class InvalidInput(RectbenchError, ValueError):
    """An argument, file or option that cannot be used as given.

    >>> import rectbench as rb
    >>> rb.load_rig("t265").scaled(-1)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: ...
    """


class UnknownName(InvalidInput):
    """A scene, rig, method, option, report or parameter that nobody has registered.

    >>> print(UnknownName("rig", "t256", ["t265", "tumvi"]))
    unknown rig 't256'; did you mean t265?
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        choices = sorted(known)
        nearest = get_close_matches(name, choices, n=3, cutoff=0.4)
        hint = f"did you mean {' or '.join(nearest)}?" if nearest else f"known: {', '.join(choices)}"
        super().__init__(f"unknown {kind} '{name}'; {hint}")


class Unsupported(RectbenchError):
    """A rectifier that cannot serve this rig, with the geometric reason.

    >>> import rectbench as rb
    >>> wide = rb.Camera("equidistant", (400, 400), {"fx": 100, "fy": 100, "cx": 200, "cy": 200})
    >>> rb.rectify(rb.Rig(wide, wide, [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [-0.1, 0, 0]))
    Traceback (most recent call last):
    rectbench.errors.Unsupported: ...
    """


class PoseNotFound(Unsupported):
    """Images or matches that do not determine how the two cameras stand, with the reason.

    >>> import numpy as np
    >>> import rectbench as rb
    >>> rig = rb.load_rig("t265").scaled(0.25)
    >>> black = np.zeros((rig.left.height, rig.left.width), np.uint8)
    >>> rb.estimate_pose((black, black), rig)
    Traceback (most recent call last):
    rectbench.errors.PoseNotFound: ...
    """


class Unavailable(RectbenchError):
    """Something the machine lacks: a library, a variant, a data file.

    >>> from rectbench.writing import write_atomically
    >>> from pathlib import Path
    >>> write_atomically(Path("/dev/null/there"), "text")
    Traceback (most recent call last):
    rectbench.errors.Unavailable: ...
    """


class InvalidResult(RectbenchError):
    """A plugin whose answer has the wrong type, shape or values.

    >>> import rectbench as rb
    >>> rb.scene("nothing")(lambda seed: None)
    Traceback (most recent call last):
    rectbench.errors.InvalidInput: scene nothing has no docstring; expected one line that says what it shows
    """
