"""Worker processes that may crash, hang or run out of memory without harming one another.

Each slot is a pebble pool of one process. So a job's time-out begins when the job does, a dead
worker takes down its own job alone, and jobs that share a pair or a scene go to the slot that has it
at hand.
"""

from __future__ import annotations

import os
import signal
import sys
import time
import types
from collections.abc import Callable, Hashable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from typing import Any

from pebble import ProcessExpired, ProcessPool

from rectbench.errors import RectbenchError, Unavailable
from rectbench.experiments.execution import worker
from rectbench.experiments.execution.outcomes import Outcome, outcome_of

GRACE_S = 30.0
"""Past its time-out, a job whose worker pebble could not stop is given up with its whole slot."""
STARTS = 2
"""How often a job is given to a worker that dies before it begins."""


@dataclass(frozen=True)
class Job:
    """A call for a worker.

    `groups` name what it shares with others, the most telling first; `after` is the place of the job that
    has to end well before it begins.
    """

    call: Callable[..., Outcome]
    arguments: tuple[Any, ...]
    timeout_s: float
    groups: tuple[Hashable, ...] = ()
    after: int | None = None


@dataclass
class _Slot:
    """One worker process and what it is doing."""

    limits: worker.Limits
    pool: ProcessPool = field(init=False)
    groups: tuple[Hashable, ...] = ()
    job: int = -1
    future: Future[Outcome] | None = None
    deadline: float = 0.0

    def __post_init__(self) -> None:
        self.open()

    def open(self) -> None:
        """A new worker process."""
        self.pool = ProcessPool(
            max_workers=1,
            initializer=worker.start,
            initargs=(self.limits, os.getpid()),
            context=_SpawnWithoutMain(),
        )

    def begin(self, index: int, job: Job) -> None:
        """Hand the job to the worker."""
        if not self.pool.active:  # the worker died while it had nothing to do
            self.replace()
        self.job, self.groups = index, job.groups
        self.deadline = time.monotonic() + job.timeout_s + GRACE_S
        self.future = self.pool.schedule(job.call, job.arguments, timeout=job.timeout_s)

    def close(self) -> None:
        """Stop the worker, whatever it is at."""
        self.pool.stop()
        self.pool.join()

    def replace(self) -> None:
        """Stop the worker and start another."""
        self.close()
        self.open()


class Workers:
    """Up to `count` processes, started when there is work; a context manager that leaves none behind."""

    def __init__(self, count: int, limits: worker.Limits) -> None:
        self.count, self.limits = count, limits
        self._slots: list[_Slot] = []

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        for slot in self._slots:
            slot.pool.stop()  # all at once: each join waits for its own
        for slot in self._slots:
            slot.close()

    def run(self, jobs: Sequence[Job]) -> Iterator[tuple[int, Outcome]]:
        """The outcome of each job with its index, as they end; what waits for one that fails is dropped."""
        waiting = list(range(len(jobs)))
        ended_well: set[int | None] = {None}
        starts = [0] * len(jobs)
        while len(self._slots) < min(self.count, len(jobs)):
            self._slots.append(_Slot(self.limits))
        kills = _kernel_kills()
        while waiting or any(slot.future for slot in self._slots):
            for slot in self._slots:
                ready = [index for index in waiting if jobs[index].after in ended_well]
                if slot.future is None and ready:
                    index = self._next(slot, ready, jobs)
                    waiting.remove(index)
                    starts[index] += 1
                    slot.begin(index, jobs[index])
            for slot in self._ended():
                job, outcome = slot.job, self._outcome(slot, kills)
                slot.future = None
                kills = _kernel_kills()
                if outcome is not None:
                    if outcome.ok:
                        ended_well.add(job)
                    else:
                        waiting = [index for index in waiting if jobs[index].after != job]
                    yield job, outcome
                elif starts[job] < STARTS:
                    waiting.insert(0, job)
                else:
                    raise Unavailable("worker processes end before they begin; see the messages above")

    def _next(self, slot: _Slot, ready: list[int], jobs: Sequence[Job]) -> int:
        """The job that shares most with the slot's last one, and next least with those of other slots."""
        others = {group for other in self._slots if other is not slot for group in other.groups}

        def switching_cost(index: int) -> tuple[list[bool], int, int]:
            groups = jobs[index].groups
            return (
                [group not in slot.groups for group in groups],
                sum(group in others for group in groups),
                index,
            )

        return min(ready, key=switching_cost)

    def _ended(self) -> list[_Slot]:
        futures = [slot.future for slot in self._slots if slot.future]
        wait(futures, timeout=1.0, return_when=FIRST_COMPLETED)
        now = time.monotonic()
        return [slot for slot in self._slots if slot.future and (slot.future.done() or now > slot.deadline)]

    def _outcome(self, slot: _Slot, kills_before: int) -> Outcome | None:
        """How the slot's job ended; None where the worker died before it took the job."""
        assert slot.future is not None
        if not slot.future.done():
            slot.replace()
            return Outcome("timeout", "the worker could not be stopped in time and was given up")
        try:
            return slot.future.result()
        except TimeoutError as error:
            return Outcome("timeout", f"stopped after {error.args[-1]:g} s")
        except ProcessExpired as expired:
            # The kernel kills with the same signal as anybody else; only its own count tells.
            if expired.exitcode == -signal.SIGKILL and _kernel_kills() > kills_before:
                return Outcome("oom", "killed by the kernel: the machine ran out of memory")
            return Outcome("crash", f"the worker process {_death(expired.exitcode)}")
        except BrokenExecutor:
            slot.replace()
            return None
        except RectbenchError:  # the bench's own trouble, such as a store that cannot be written
            raise
        except Exception as error:  # a full disk, an answer that does not travel: this job's, not the run's
            return outcome_of(error)


def _death(exit_code: int) -> str:
    if exit_code >= 0:
        return f"ended with exit code {exit_code}"
    try:
        return f"was killed by {signal.Signals(-exit_code).name}"
    except ValueError:
        return f"was killed by signal {-exit_code}"


def _kernel_kills() -> int:
    """How many processes this kernel has killed for want of memory since it started (Linux)."""
    counters = Path("/proc/vmstat")
    if not counters.exists():
        return 0
    lines = counters.read_text().splitlines()
    return next((int(line.split()[1]) for line in lines if line.startswith("oom_kill ")), 0)


class _ProcessWithoutMain(SpawnProcess):
    """A spawned process that does not run the caller's script again.

    Workers import all they need by name, so a script may call `rectbench.run` at its top level,
    without the `if __name__ == "__main__"` that multiprocessing asks for otherwise.
    """

    def start(self) -> None:
        with _main_hidden():
            super().start()


class _SpawnWithoutMain(SpawnContext):
    Process = _ProcessWithoutMain


@contextmanager
def _main_hidden() -> Iterator[None]:
    main = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
