"""A stand-in for GCC's libatomic, which Dr.Jit needs and a bare Debian or Ubuntu lacks. Imports nothing."""

from __future__ import annotations

import ctypes
import platform
import sys
from contextlib import suppress
from pathlib import Path

SONAME = "libatomic.so.1"


def provide() -> None:
    """Have a libatomic in this process before Dr.Jit is loaded: the system's own, else ours.

    The loader takes a library that is there already for one of the same soname, so Dr.Jit finds what
    is loaded here. Ours is for Linux on x86-64; elsewhere Dr.Jit's import says what is missing.
    """
    if sys.platform != "linux" or platform.machine() != "x86_64":
        return
    try:
        ctypes.CDLL(SONAME)
    except OSError:
        with suppress(OSError):
            ctypes.CDLL(str(Path(__file__).with_name(SONAME)), mode=ctypes.RTLD_GLOBAL)
