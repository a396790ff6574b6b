"""What a worker process does before its first task: leash, limits, threads, silence, warm libraries."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import sys
import warnings
from dataclasses import dataclass

ADDING_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What says how many threads BLAS and OpenMP add up with, to those that are loaded later."""
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class Limits:
    """What one worker may use."""

    threads: int
    """Of OpenCV and Dr.Jit, whose results do not depend on it."""
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
    _add_up_alike()
    silence_warnings()
    _warm_up(limits.threads)


def silence_warnings() -> None:
    """Keep Python's warnings from the user's terminal, unless Python was asked to show them (-W)."""
    if not sys.warnoptions:
        warnings.simplefilter("ignore")


def _add_up_alike() -> None:
    """Hold BLAS and OpenMP to one thread: several split sums by their number, and rows would depend on it."""
    for variable in ADDING_THREADS:
        os.environ[variable] = "1"
    import threadpoolctl  # not above: the variables are to be set before anything loads a BLAS

    threadpoolctl.threadpool_limits(limits=1)


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
    import cv2

    from rectbench import llvm

    cv2.setNumThreads(threads)
    if llvm.available():
        import drjit

        drjit.set_thread_count(threads)
