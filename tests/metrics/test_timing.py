"""What is timed: warm calls, the best of some; a slow call once. The clock is the test's own."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from rectbench.metrics import timing
from rectbench.metrics.timing import timed, warm_seconds


@pytest.fixture
def lasting(monkeypatch: pytest.MonkeyPatch) -> Callable[[Iterator[float]], Callable[[], str]]:
    """A call that takes as many seconds as told each time."""
    now = [0.0]
    monkeypatch.setattr(timing.time, "perf_counter", lambda: now[0])

    def made(seconds: Iterator[float]) -> Callable[[], str]:
        def call() -> str:
            now[0] += next(seconds)
            return "done"

        return call

    return made


def test_times_are_warm_and_the_best_of_three(lasting: Callable[..., Callable[[], str]]) -> None:
    naps = iter([0.2, 0.003, 0.001, 0.005])
    assert warm_seconds(lasting(naps)) == pytest.approx(0.001)
    assert next(naps, None) is None


def test_a_first_call_that_was_made_is_not_made_again(lasting: Callable[..., Callable[[], str]]) -> None:
    naps = iter([0.003, 0.001, 0.005])
    assert warm_seconds(lasting(naps), first_s=0.2) == pytest.approx(0.001)


def test_no_further_call_is_made_once_they_took_long_enough(
    lasting: Callable[..., Callable[[], str]],
) -> None:
    naps = iter([0.5, 0.02, 0.025, 0.01])
    assert warm_seconds(lasting(naps)) == pytest.approx(0.02)
    assert list(naps) == [0.01]


def test_a_slow_call_is_made_once(lasting: Callable[..., Callable[[], str]]) -> None:
    assert warm_seconds(lasting(iter([1.05]))) == pytest.approx(1.05)
    assert warm_seconds(lasting(iter([])), first_s=1.05) == 1.05


def test_a_timed_call_gives_its_result(lasting: Callable[..., Callable[[], str]]) -> None:
    assert timed(lasting(iter([0.5]))) == ("done", pytest.approx(0.5))
