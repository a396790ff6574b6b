"""Averages over cells that say how many cells they stand on, and the ranks made from them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rectbench.metrics.catalogue import RANKING_KEY, column
from rectbench.plugins.metric import Column
from rectbench.runs.run import Result


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


def summarise(method: str, results: Sequence[Result], keys: Iterable[str]) -> Summary:
    """Average the `keys` over the ok cells of `results`, each key as its column says."""
    ok = [r for r in results if r.ok]
    averages = {key: _average(column(key), [r.metrics[key] for r in ok if key in r.metrics]) for key in keys}
    return Summary(method, len(results), len(ok), averages)


def ranked(summaries: Iterable[Summary], key: str = RANKING_KEY) -> list[Summary]:
    """Best first by `key`. A failed cell counts before any average: fewer failures rank higher."""
    return sorted(summaries, key=lambda s: (s.failed, _or_infinity(s.averages.get(key)), s.method))


def _or_infinity(averaged: Averaged | None) -> float:
    return math.inf if averaged is None or averaged.value is None else averaged.value


def _average(shown_as: Column, values: Sequence[float]) -> Averaged:
    if not values:
        return Averaged(None, 0)
    array = np.asarray(values, dtype=np.float64)
    if shown_as.average == "max":
        value = array.max()
    elif shown_as.average == "min":
        value = array.min()
    elif shown_as.average == "rms":
        value = np.sqrt(np.mean(array**2))
    else:
        value = np.mean(array)
    return Averaged(float(value), len(values))
