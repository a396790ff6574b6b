"""How long a call takes when it is warm."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

REPEATS = 3
SLOW_CALL_S = 1.0

Result = TypeVar("Result")


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """The result of `call` and the seconds it takes warm: the best of 3 calls after a first one.

    A call of more than a second is timed as it is: it hardly feels that the caches were cold.
    """
    start = time.perf_counter()
    result = call()
    first_s = time.perf_counter() - start
    return result, warm_seconds(call, first_s)


def warm_seconds(call: Callable[[], object], first_s: float) -> float:
    """The seconds that `call` takes warm, after a first call that took `first_s`; see `timed`."""
    if first_s > SLOW_CALL_S:
        return first_s
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return min(seconds)
