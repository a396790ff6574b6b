"""Cells without a measurement, a reason that several of them share told once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from rectbench.plugins.result import Part, Result
from rectbench.statistics.intervals import counted

EVERY_METHOD = "every method"
NAMED_PLACES = 3
"""Of the pairs and poses of one reason, so many are named on the terminal."""


@dataclass(frozen=True)
class Failure:
    """One status and reason of a pair under a pose, and whose it is."""

    group: str
    """The part of the report; empty in a report without parts."""
    scene: str
    rig: str
    motion: str
    pose: str
    method: str
    """The methods that it was given for, or that it was for all."""
    seed: str
    """Their seeds."""
    status: str
    reason: str

    @property
    def place(self) -> str:
        """The pair and the pose."""
        return f"{self.scene}/{self.rig}/{self.motion}/{self.pose}"


def failures_of(run: Part) -> list[Failure]:
    """What failed, by pair and pose in the order of the cells; a reason that several share is one."""
    methods = defaultdict[tuple[str, ...], set[str]](set)
    cells = defaultdict[tuple[str, ...], list[Result]](list)
    for result in run.results:
        place = (result.group, *result.place, result.pose)
        methods[place].add(result.method)
        if not result.ok:
            cells[(*place, result.status, result.reason)].append(result)
    return [_failure(key, its, methods[key[:5]]) for key, its in cells.items()]


def _failure(key: tuple[str, ...], cells: list[Result], all_methods: set[str]) -> Failure:
    *place, status, reason = key
    failing = list(dict.fromkeys(cell.method for cell in cells))
    whose = EVERY_METHOD if len(all_methods) > 1 and set(failing) == all_methods else ", ".join(failing)
    seeds = ", ".join(map(str, sorted({cell.seed for cell in cells})))
    group, scene, rig, motion, pose = place
    return Failure(group, scene, rig, motion, pose, whose, seeds, status, reason)


def told_failures(run: Part) -> Iterator[str]:
    """A line for each reason: the status, whose it is and where, and why."""
    places = defaultdict[tuple[str, str, str], dict[str, None]](dict)
    for failure in failures_of(run):
        places[failure.status, failure.method, failure.reason][failure.place] = None
    for (status, method, reason), where in places.items():
        named = ", ".join(list(where)[:NAMED_PLACES])
        if (more := len(where) - NAMED_PLACES) > 0:
            named += f" and {counted(more, 'more place')}"
        yield f"{status}: {method} on {named}: {reason}"
