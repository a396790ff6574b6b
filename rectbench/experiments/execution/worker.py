"""What a worker process does before its first task: leash, limits, threads, warm libraries."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import sys
from dataclasses import dataclass

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class Limits:
    """What one worker may use."""

    threads: int
    memory_bytes: int


def start(limits: Limits, parent: int) -> None:
    """Make this process a worker of the process `parent`."""
    _die_with(parent)
    os.dup2(2, 1)  # what a plugin prints is not the command's output
    restrict(limits)


def restrict(limits: Limits) -> None:
    """Hold this process to its limits, and load what every cell needs under them."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _limit_memory(limits.memory_bytes)
    for variable in THREAD_VARIABLES:
        os.environ[variable] = str(limits.threads)
    _warm_up(limits.threads)


def _die_with(parent: int) -> None:
    """A killed run leaves no worker behind, not even one in an endless loop (Linux)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it was gone before the leash was on
        os._exit(1)


def _limit_memory(size: int) -> None:
    """Allocations beyond `size` bytes fail with MemoryError instead of driving the machine into swap.

    Counts private writable memory; the address space that LLVM and thread stacks merely reserve is free.
    """
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    ceiling = size if hard == resource.RLIM_INFINITY else min(size, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (ceiling, hard))


def _warm_up(threads: int) -> None:
    """Import now what every cell needs, so that no cell's time-out pays for it."""
    # Imported here and not above: NumPy's BLAS reads the thread variables when it is loaded.
    import cv2

    from rectbench import llvm

    cv2.setNumThreads(threads)
    if llvm.available():
        import drjit

        drjit.set_thread_count(threads)
