"""What the page says about the run itself, picked from run.json."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rectbench.runs.run import Run

_LABELS = {
    "command": "Command",
    "data": "Photographs of",
    "wall_s": "Took",
    "git_revision": "Git revision",
    "cpu": "CPU",
    "cores": "Cores",
    "jobs": "Jobs",
    "llvm": "LLVM",
    "python": "Python",
    "platform": "Platform",
    "seeds": "Seeds",
}


@dataclass(frozen=True)
class Fact:
    """One line of the run's facts."""

    label: str
    text: str


def run_facts(run: Run) -> list[Fact]:
    """The facts worth a line, then the versions of libraries; run.json itself is shown beside them."""
    told = {**vars(run.record), "wall_s": f"{run.record.wall_s:.1f} s"}
    shown = {label: told[name] for name, label in _LABELS.items() if told[name] not in (None, ())}
    facts = [Fact(label, _text(value)) for label, value in shown.items()]
    present = [f"{name} {version}" for name, version in run.record.versions.items() if version is not None]
    return [*facts, Fact("Versions", ", ".join(present))]


USUAL_KINDS = ("bars", "scatter", "pairs", "maps")
"""The kinds of figures of a report that asks for none: what every method and every report has."""


def wanted_kinds(run: Run) -> tuple[str, ...]:
    """The kinds of figures that the report, or this part of it, asks for."""
    part, spec = run.stated_part, run.record.spec
    wanted = spec.figures if part is None else part.figures
    return USUAL_KINDS if wanted is None else wanted


def part_title(run: Run) -> str:
    """The heading of a part, else its name; nothing for a run without parts."""
    return (run.stated_part and run.stated_part.title) or run.group


def stated_seconds(run: Run) -> dict[str, float]:
    """Times that somebody else stated, by stage: `pose`, `fit`, `warp`."""
    return {str(stage): seconds for stage, seconds in run.record.spec.stated_seconds.items()}


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {item}" for name, item in value.items() if item is not None)
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
