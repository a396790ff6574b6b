"""Averages over cells that say how many cells they stand on, and the ranks made from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rectbench.plugins.metric import Average, Column
from rectbench.plugins.result import Result
from rectbench.types import FloatArray


@dataclass(frozen=True)
class Averaged:
    """A metric over some cells: the average over the `count` of them that have a value."""

    value: float | None
    count: int


@dataclass(frozen=True)
class Summary:
    """A method over `cells` cells, of which `ok` were measured; averages are over those alone."""

    method: str
    cells: int
    ok: int
    averages: Mapping[str, Averaged]

    @property
    def failed(self) -> int:
        """How many cells hold no measurement."""
        return self.cells - self.ok

    @property
    def complete(self) -> bool:
        """Whether every cell was measured, so that averages compare with those of other methods."""
        return self.failed == 0


def summarise(method: str, results: Sequence[Result], columns: Iterable[Column]) -> Summary:
    """Average the `columns` over the ok cells of `results`, each as it says."""
    ok = [r for r in results if r.ok]
    averages = {c.key: _average(c, [r.metrics[c.key] for r in ok if c.key in r.metrics]) for c in columns}
    return Summary(method, len(results), len(ok), averages)


def ranked(summaries: Iterable[Summary], key: str) -> list[Summary]:
    """Best first by the column `key`. A failed cell counts before any average: fewer failures rank higher."""
    return sorted(summaries, key=lambda s: (s.failed, _or_infinity(s.averages.get(key)), s.method))


def _or_infinity(averaged: Averaged | None) -> float:
    return math.inf if averaged is None or averaged.value is None else averaged.value


def _average(shown_as: Column, values: Sequence[float]) -> Averaged:
    if not values:
        return Averaged(None, 0)
    array = np.asarray(values, dtype=np.float64)
    return Averaged(float(_AVERAGES[shown_as.average](array)), len(values))


_AVERAGES: dict[Average, Callable[[FloatArray], float]] = {
    "mean": np.mean,
    "geometric": lambda values: np.exp(np.mean(np.log(values))),
    "rms": lambda values: np.sqrt(np.mean(values**2)),
    "max": np.max,
    "min": np.min,
}
