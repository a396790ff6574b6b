"""How long a method takes: to fit, to make its lookup tables, to warp a pair."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from rectbench.plugins.metric import Case, Column, Metric

REPEATS, ENOUGH_S = 3, 0.03
"""Calls that are timed; no further one begins once they have taken so long."""
SLOW_CALL_S = 1.0

Result = TypeVar("Result")


def timed(call: Callable[[], Result]) -> tuple[Result, float]:
    """The result of `call` and the seconds it takes, once."""
    start = time.perf_counter()
    result = call()
    return result, time.perf_counter() - start


def warm_seconds(call: Callable[[], Any], first_s: float | None = None) -> float:
    """Seconds that `call` takes warm: the best of up to 3 calls after a first one, which took `first_s`.

    The longer a call takes the less its time scatters: no further one is made after 0.03 s of them, and one
    of more than a second is timed as it is, as it hardly feels that the caches were cold.

    >>> warm_seconds(lambda: None, first_s=1.5)
    1.5
    """
    if first_s is None:
        first_s = timed(call)[1]
    if first_s > SLOW_CALL_S:
        return first_s
    taken: list[float] = []
    while len(taken) < REPEATS and sum(taken) < ENOUGH_S:
        taken.append(timed(call)[1])
    return min(taken)


def _milliseconds(key: str, heading: str, meaning: str, **more: Any) -> Column:
    return Column(key, heading, "ms", "lower", meaning, scale=1000.0, **more)


class Timing(Metric):
    """Times of the stages from two images to a rectified pair."""

    name, topic = "timing", "Time"
    columns = (
        _milliseconds("pose_s", "pose", "Time from the two images to their relative pose.", panel="pose"),
        _milliseconds(
            "fit_s", "fit", "Time to fit the rectification.", shown="summary", promised=True, panel="fit"
        ),
        _milliseconds("maps_s", "maps", "Time to make both lookup tables.", promised=True),
        _milliseconds(
            "warp_s", "warp", "Time to warp both images, their tables included.", promised=True, panel="warp"
        ),
        _milliseconds(
            "total_s",
            "total",
            "Time from the two images to the rectified pair: pose, fit and warp.",
            panel="total",
        ),
    )

    def compute(self, case: Case) -> dict[str, float]:
        """Warm seconds; those of the pose, and the total, only where the images had to tell it."""
        rect = case.rect
        left, right = (
            np.full((camera.height, camera.width, 3), 127, dtype=np.uint8)
            for camera in (rect.left.source, rect.right.source)
        )
        seconds = {
            "maps_s": warm_seconds(lambda: (rect.maps("left"), rect.maps("right"))),
            "warp_s": warm_seconds(lambda: rect.remap(left, right)),
        }
        if case.fit is not None:
            seconds["fit_s"] = warm_seconds(case.fit, case.first_fit_s)
            if case.pose_is_estimated:
                seconds["pose_s"] = case.pair.pose_seconds()
                seconds["total_s"] = seconds["pose_s"] + seconds["fit_s"] + seconds["warp_s"]
        return seconds
