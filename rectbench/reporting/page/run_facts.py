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


KINDS = ("bars", "scatter", "pairs", "maps", "energy", "starts", "squares", "clouds", "timing")
"""The kinds of figures; a report, or a part of one, may ask for some of them."""
USUAL_KINDS = ("bars", "scatter", "pairs", "maps")
"""Those of a report that asks for none: what every method and every report has."""


def wanted_kinds(run: Run) -> tuple[str, ...]:
    """The kinds of figures that the report, or this part of it, asks for."""
    for wanted in (_group_facts(run).get("figures"), run.facts.get("figures")):
        if isinstance(wanted, list | tuple):
            return tuple(map(str, wanted))
    return USUAL_KINDS


def part_title(run: Run) -> str:
    """The heading of a part, else its name; nothing for a run without parts."""
    return _words(_group_facts(run).get("title")) or run.group


def stated_seconds(run: Run) -> dict[str, float]:
    """Times that somebody else stated, by stage: `pose`, `fit`, `warp`."""
    stated = _spec(run).get("stated_seconds")
    return {str(k): float(v) for k, v in stated.items()} if isinstance(stated, Mapping) else {}


def stated_claims(run: Run) -> list[Mapping[str, Any]]:
    """The claims that the report puts to the test, as run.json holds them."""
    claims = _spec(run).get("claims")
    return list(claims) if isinstance(claims, list | tuple) else []


def _spec(run: Run) -> Mapping[str, Any]:
    spec = run.facts.get("spec")
    return spec if isinstance(spec, Mapping) else {}


def _group_facts(run: Run) -> Mapping[str, Any]:
    groups = _spec(run).get("groups") or ()
    return next((g for g in groups if run.group and g.get("name") == run.group), {})


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
