"""Finds the LLVM library that Dr.Jit compiles with, before Dr.Jit is imported.

Dr.Jit loads libLLVM at run time. Versions below 17 pass its own check and then abort the whole
process at the first kernel (``Cannot select: fminimum``), which no ``except`` can catch; so the
version is checked here, before the first kernel. The wheel ``karellen-llvm-core`` puts a good one
at ``sys.prefix/lib``; a user's own ``DRJIT_LIBLLVM_PATH`` is left alone.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import sys
from functools import cache
from pathlib import Path

from rectbench import atomic
from rectbench.errors import Unavailable

PATH_VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST_VERSION = 17
WHEEL = "karellen-llvm-core"


def _shipped_library() -> Path | None:
    """The libLLVM installed by the wheel, wherever pip put it (venv, user or target folder)."""
    try:
        files = importlib.metadata.files(WHEEL) or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    libraries = (Path(str(file.locate())).resolve() for file in files if file.name.startswith("libLLVM"))
    folders = [Path(sys.prefix) / "lib", *(library.parent for library in libraries)]
    for folder in folders:
        # The unversioned links appear only after the first interpreter start: match all of them.
        found = sorted(folder.glob("libLLVM*.so*"))
        if found:
            return found[0]
    return None


def choose_library() -> None:
    """Provide the libatomic, and unless the user chose one the libLLVM, that Dr.Jit loads at import."""
    atomic.provide()
    if PATH_VARIABLE in os.environ or "drjit" in sys.modules:
        return
    library = _shipped_library()
    if library is not None:
        os.environ[PATH_VARIABLE] = str(library)


@cache
def problem() -> str | None:
    """Why Dr.Jit's LLVM backend cannot be used here, or None where it can."""
    if importlib.util.find_spec("drjit") is None:
        return "the package drjit is not installed"
    choose_library()
    try:
        import drjit
    except (ImportError, NameError) as error:  # its own handler trips where a library is missing
        return f"drjit cannot be imported: {error.__context__ or error}"
    if not drjit.has_backend(drjit.JitBackend.LLVM):
        return (
            f"no libLLVM found; install {WHEEL}, or point {PATH_VARIABLE} at LLVM {OLDEST_VERSION} or newer"
        )
    version: tuple[int, ...] = drjit.detail.llvm_version()
    if version[0] < OLDEST_VERSION:
        found = ".".join(map(str, version))
        return f"libLLVM {found} is too old; point {PATH_VARIABLE} at LLVM {OLDEST_VERSION} or newer"
    return None


def available() -> bool:
    """True where kernels can be compiled on this machine."""
    return problem() is None


def require() -> None:
    """Raise `Unavailable`, with the mend, where kernels cannot be compiled on this machine."""
    reason = problem()
    if reason is not None:
        raise Unavailable(f"rendering needs Dr.Jit's LLVM backend: {reason}")
