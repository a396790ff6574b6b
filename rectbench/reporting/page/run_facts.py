"""What the page says about the run itself, picked from run.json."""

from __future__ import annotations

import json
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
    facts = [
        Fact(label, _text(run.facts[name], seconds=name.endswith("_s")))
        for name, label in _LABELS.items()
        if run.facts.get(name) not in (None, "", [])
    ]
    versions = run.facts.get("versions")
    if isinstance(versions, Mapping):
        present = [f"{name} {version}" for name, version in versions.items() if isinstance(version, str)]
        facts.append(Fact("Versions", ", ".join(present)))
    return facts


def title(run: Run) -> str:
    """The report's title, else its name."""
    return _words(run.facts.get("title")) or run.report


def description(run: Run) -> str:
    """The report's paragraph about itself, if it has one."""
    return _words(run.facts.get("description"))


def reproduce_command(run: Run) -> str:
    """The command line that makes this run again."""
    return _words(run.facts.get("command")) or f"rectbench run {run.report}"


def full_json(run: Run) -> str:
    """run.json, indented, without its list of cells: the tables show those."""
    facts = {name: value for name, value in run.facts.items() if name != "cells"}
    return json.dumps(facts, indent=2, ensure_ascii=False)


def _words(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _text(value: Any, seconds: bool = False) -> str:
    if seconds and isinstance(value, int | float):
        return f"{value:.1f} s"
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items() if item is not None)
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value))
    return str(value)
