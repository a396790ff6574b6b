"""What is wrong with a file, in one line that prints."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from rectbench.errors import InvalidInput


@contextmanager
def errors_at(where: str) -> Iterator[None]:
    """Put `where`, file and key, before the message of an error that is raised within.

    Numbers so absurd that they overflow end in an error of their own, without a warning beside it.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except (ValueError, ArithmeticError) as error:
        raise InvalidInput(f"{where}: {one_line(error)}") from None


def shown(value: Any) -> str:
    """A value as an error shows it: one line, cut short."""
    return one_line(_SHORT.repr(value))


def one_line(message: Any) -> str:
    """A message with its line breaks, and whatever else does not print, made spaces."""
    return " ".join("".join(c if c.isprintable() else " " for c in str(message)).split())


class _Short(reprlib.Repr):
    repr_Entries = reprlib.Repr.repr_dict


_SHORT = _Short()
_SHORT.maxstring = _SHORT.maxother = 40
_SHORT.maxdict = 2
