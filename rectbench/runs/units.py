"""Results by unit: what is nested in a rig is averaged, so that rigs can be compared with each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from rectbench.plugins.metric import Column
from rectbench.plugins.result import Result
from rectbench.statistics.intervals import nested_means, ratio
from rectbench.statistics.paired import FLOOR

Place = tuple[str, str, str, int]
"""Rig, motion, scene, seed: from what is drawn independently to what is nested in it."""
GEOMETRIC: str = "geometric"


def place_of(result: Result) -> Place:
    """Where a result is from."""
    return result.rig, result.motion, result.scene, result.seed


def by_place(results: Iterable[Result], column: Column) -> dict[str, dict[Place, float]]:
    """The measured numbers of a column, by method and place; of results of one pose."""
    found: dict[str, dict[Place, float]] = {}
    for result in results:
        numbers = found.setdefault(result.method, {})
        if result.ok and column.key in result.metrics:
            numbers[place_of(result)] = result.metrics[column.key]
    return found


def by_rig(results: Iterable[Result], column: Column) -> dict[str, dict[str, float]]:
    """The value of a column on each rig, by method: the mean over motions, of means over scenes, over seeds.

    A method has one on the rigs where it was measured wherever any method was: a mean over the pairs on
    which it works is none of the rig. The mean is geometric where the column's average is.
    """
    numbers = by_place(results, column)
    wanted: dict[str, set[Place]] = {}
    for place in (place for own in numbers.values() for place in own):
        wanted.setdefault(place[0], set()).add(place)
    return {
        method: {
            rig: _mean({place: own[place] for place in places}, column)
            for rig, places in wanted.items()
            if places <= own.keys()
        }
        for method, own in numbers.items()
    }


def floor_of(column: Column) -> float:
    """Below this a stored number is rounding."""
    return max(column.floor / column.scale, FLOOR)


def _mean(numbers: Mapping[Place, float], column: Column) -> float:
    if column.average != GEOMETRIC:
        return next(iter(nested_means(numbers).values()))
    floor = floor_of(column)
    logs = {place: math.log(max(value, floor)) for place, value in numbers.items()}
    return ratio(next(iter(nested_means(logs).values())))
