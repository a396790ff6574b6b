"""What a run's report, or a part of it, asks to be shown, as run.json tells it."""

from __future__ import annotations

from collections.abc import Iterable

from rectbench.errors import RectbenchError
from rectbench.plugins.figure import FIGURES, Figure, usual_figures
from rectbench.registry import Plugin, registry
from rectbench.runs.run import Run


def wanted_figures(part: Run) -> dict[str, Plugin[Figure] | RectbenchError]:
    """The figures of a part by the names that ask for them, or why one cannot be loaded here."""
    stated, spec = part.stated_part, part.record.spec
    asked = spec.figures if stated is None else stated.figures
    usual = usual_figures() if part.pair_source is None else usual_figures(part.pair_source.offers)
    return {name: _loaded(name) for name in (usual if asked is None else asked)}


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
    return (run.stated_part and run.stated_part.title) or run.group
