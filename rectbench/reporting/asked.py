"""What a run's report, or a part of it, asks to be shown, as run.json tells it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rectbench.errors import RectbenchError
from rectbench.plugins.figure import FIGURES, Figure, Part, usual_figures
from rectbench.registry import Plugin, registry
from rectbench.runs.run import Run


def wanted_figures(part: Run) -> dict[str, Plugin[Figure] | RectbenchError]:
    """The figures of a part by the names that ask for them, or why one cannot be loaded here."""
    asked = (_group_facts(part).get("figures"), part.facts.get("figures"))
    names = next((names for names in asked if isinstance(names, list | tuple)), usual_figures())
    return {str(name): _loaded(str(name)) for name in names}


def _loaded(name: str) -> Plugin[Figure] | RectbenchError:
    try:
        return registry(FIGURES).get(name)
    except RectbenchError as error:
        return error


def methods_part(part: Run) -> Run | None:
    """A part without the results that some figure of it sets apart: their methods are none to compare."""
    return without_set_apart(part, (p.value for p in wanted_figures(part).values() if isinstance(p, Plugin)))


def without_set_apart(part: Run, figures: Iterable[Figure]) -> Run | None:
    """A part without the results that any of these figures sets apart; None where nothing is left."""
    figures = tuple(figures)
    left = [r for r in part.results if not any(figure.sets_apart(r) for figure in figures)]
    return part.only(left) if left else None


def part_title(run: Run) -> str:
    """The heading of a part, else its name; nothing for a run without parts."""
    title = _group_facts(run).get("title")
    return title if title and isinstance(title, str) else run.group


def stated_seconds(run: Part) -> dict[str, float]:
    """Times that somebody else stated, by stage: `pose`, `fit`, `warp`."""
    stated = _spec(run).get("stated_seconds")
    return {str(k): float(v) for k, v in stated.items()} if isinstance(stated, Mapping) else {}


def stated_claims(run: Run) -> list[Mapping[str, Any]]:
    """The claims that the report puts to the test, as run.json holds them."""
    claims = _spec(run).get("claims")
    return list(claims) if isinstance(claims, list | tuple) else []


def _spec(run: Part) -> Mapping[str, Any]:
    spec = run.facts.get("spec")
    return spec if isinstance(spec, Mapping) else {}


def _group_facts(run: Part) -> Mapping[str, Any]:
    groups = _spec(run).get("groups") or ()
    return next((g for g in groups if run.group and g.get("name") == run.group), {})
